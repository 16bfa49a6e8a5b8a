// Merging inputs, numbering actions, choosing the picture's size.
#include "server/gateway/players/player_session.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

/// Inputs that only turn the head are passed on at most this often: once for each drawn picture.
constexpr std::int64_t merge_us = 14'000;

wire::CommandKind kind_of(PlayerAction action) {
  switch (action) {
    case PlayerAction::throw_body:
      return wire::CommandKind::throw_body;
    case PlayerAction::grab:
      return wire::CommandKind::grab;
    case PlayerAction::blast:
      return wire::CommandKind::blast;
    case PlayerAction::respawn:
      return wire::CommandKind::respawn;
  }
  return wire::CommandKind::input;
}

int scaled(int edge, double scale, int min) {
  return std::max(static_cast<int>(std::lround(edge * scale / 2)) * 2, min);
}

}  // namespace

PlayerSession::PlayerSession(const Options& options)
    : player_(options.stream.player),
      token_(options.token),
      name_(options.name),
      view_(options.view),
      look_(options.look),
      commands_(options.stream) {}

Status PlayerSession::accept_seq(std::uint32_t seq) {
  if (seq <= last_seq_) return Error::format("\"seq\" must grow: {} came after {}", seq, last_seq_);
  last_seq_ = seq;
  return Ok{};
}

Status PlayerSession::push(const CommandIntent& intent) {
  if (commands_.push(intent)) return Ok{};
  return Error{"The world cannot keep up with your commands; please connect again"};
}

Status PlayerSession::input(const InputMessage& message, std::int64_t now_us) {
  if (auto seq = accept_seq(message.seq); !seq) return seq;
  look_ = message.look;
  // A key that is pressed and let go between two pictures must not get lost in a merge.
  if (held_ && held_->keys != message.keys)
    if (auto flushed = flush(now_us); !flushed) return flushed;
  held_ = message;
  if (message.keys == keys_ && now_us - last_input_us_ < merge_us) return Ok{};
  return flush(now_us);
}

Status PlayerSession::flush(std::int64_t now_us) {
  if (!held_) return Ok{};
  const InputMessage input = *held_;
  held_.reset();
  keys_ = input.keys;
  last_input_us_ = now_us;
  return push({.kind = wire::CommandKind::input,
               .keys = input.keys,
               .yaw = input.look.yaw,
               .pitch = input.look.pitch,
               .browser_seq = input.seq});
}

Status PlayerSession::action(const ActionMessage& message, BodyId target, std::int64_t now_us) {
  if (auto seq = accept_seq(message.seq); !seq) return seq;
  look_ = message.look;
  if (auto flushed = flush(now_us); !flushed) return flushed;
  return push({.kind = kind_of(message.action),
               .keys = keys_,
               .item = static_cast<std::uint8_t>(message.item - 1),  // from 0 between servers
               .target = target,
               .yaw = message.look.yaw,
               .pitch = message.look.pitch,
               .browser_seq = message.seq});
}

Status PlayerSession::tick(std::int64_t now_us) {
  pacing_.tick(now_us);
  if (!held_ || now_us - last_input_us_ < merge_us) return Ok{};
  return flush(now_us);
}

void PlayerSession::depart(bool lost) {
  departed_ = true;
  held_.reset();
  (void)commands_.push({.kind = lost ? wire::CommandKind::lost : wire::CommandKind::leave});
}

int PlayerSession::picture_width() const {
  return scaled(view_.width, pacing_.scale(), min_picture_width);
}

int PlayerSession::picture_height() const {
  return scaled(view_.height, pacing_.scale(), min_picture_height);
}

bool PlayerSession::will_carry(bool carrying_now) const {
  const auto grab = commands_.latest_unapplied(wire::CommandKind::grab);
  return grab ? grab->target.value != 0 : carrying_now;
}

}  // namespace aureole
