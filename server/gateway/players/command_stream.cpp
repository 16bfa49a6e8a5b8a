// Retransmission, exactly-once bookkeeping and the map from commands to the browser's numbers.
#include "server/gateway/players/command_stream.h"

#include <algorithm>

#include "server/base/check.h"

namespace aureole {
namespace {

constexpr std::size_t history_length = 64;

}  // namespace

CommandStream::CommandStream(const CommandStreamOptions& options) : options_(options) {
  append({.kind = wire::CommandKind::join});
}

void CommandStream::append(const CommandIntent& intent) {
  unapplied_.push_back({next_sequence_++, intent});
}

bool CommandStream::push(const CommandIntent& intent) {
  if (!unapplied_.empty() && intent.kind == wire::CommandKind::input) {
    Waiting& last = unapplied_.back();
    if (!last.sent && last.intent.kind == wire::CommandKind::input &&
        last.intent.keys == intent.keys) {
      last.intent = intent;
      return true;
    }
  }
  if (unapplied_.size() >= max_unapplied) return false;
  append(intent);
  return true;
}

void CommandStream::confirm(std::uint32_t session, std::uint32_t applied, Tick tick,
                            std::int64_t now_us) {
  if (session != options_.session) {
    // An older session: the join is still on its way. A newer one: the player is elsewhere now.
    superseded_ |= session > options_.session;
    return;
  }
  const std::uint32_t first_waiting =
      next_sequence_ - static_cast<std::uint32_t>(unapplied_.size());
  if (applied + 1 < first_waiting) {
    if (!rewound_since_us_) rewound_since_us_ = now_us;
    return;
  }
  rewound_since_us_.reset();
  // A region cannot have applied what was never sent; a number that says so is not trusted.
  if (applied >= next_sequence_) return;
  while (!unapplied_.empty() && unapplied_.front().sequence <= applied) {
    const CommandIntent& intent = unapplied_.front().intent;
    if (intent.browser_seq != 0) applied_browser_seq_ = intent.browser_seq;
    unapplied_.pop_front();
    last_sent_us_ = now_us;  // it moves on: the rest gets its full time
  }
  const std::int64_t world_us = tick.value * tick_us;
  if (history_.empty() ||
      (applied_browser_seq_ != history_.back().browser_seq && world_us >= history_.back().world_us))
    history_.push_back({world_us, applied_browser_seq_});
  if (history_.size() > history_length) history_.pop_front();
}

std::vector<wire::Command> CommandStream::due(RegionId owner, std::int64_t now_us) {
  std::vector<wire::Command> commands;
  if (unapplied_.empty()) {
    last_owner_ = owner;
    return commands;
  }
  const bool all = last_owner_ != owner || now_us - last_sent_us_ >= resend_us;
  for (Waiting& waiting : unapplied_) {
    if (!all && waiting.sent) continue;
    waiting.sent = true;
    commands.push_back(on_wire(waiting));
  }
  // New commands do not push the repetition of the older ones away for ever.
  if (all || commands.size() == unapplied_.size()) last_sent_us_ = now_us;
  last_owner_ = owner;
  return commands;
}

wire::Command CommandStream::on_wire(const Waiting& waiting) const {
  const CommandIntent& intent = waiting.intent;
  const bool resumes = intent.kind == wire::CommandKind::join && avatar_exists_;
  const BodyId target = resumes ? BodyId::avatar(options_.player) : intent.target;
  return wire::Command(options_.player.value, options_.session, waiting.sequence, intent.kind,
                       intent.keys, intent.item, options_.gateway, target.value, intent.yaw,
                       intent.pitch, options_.spawn);
}

bool CommandStream::must_restart(std::int64_t now_us) const {
  return rewound_since_us_ && now_us - *rewound_since_us_ >= rewind_patience_us;
}

void CommandStream::restart(std::uint32_t session) {
  AUREOLE_CHECK(session > options_.session, "sessions of a player grow");
  options_.session = session;
  std::deque<Waiting> rest;
  rest.swap(unapplied_);
  next_sequence_ = 1;
  append({.kind = wire::CommandKind::join});
  for (const Waiting& waiting : rest)
    if (waiting.intent.kind != wire::CommandKind::join) append(waiting.intent);
  last_owner_.reset();
  rewound_since_us_.reset();
}

std::optional<CommandIntent> CommandStream::latest_unapplied(wire::CommandKind kind) const {
  const auto at = std::find_if(unapplied_.rbegin(), unapplied_.rend(),
                               [&](const Waiting& w) { return w.intent.kind == kind; });
  if (at == unapplied_.rend()) return std::nullopt;
  return at->intent;
}

std::uint32_t CommandStream::contained_input(std::int64_t world_us) const {
  std::uint32_t newest = 0;
  for (const Confirmation& c : history_)
    if (c.world_us <= world_us) newest = c.browser_seq;
  return newest;
}

}  // namespace aureole
