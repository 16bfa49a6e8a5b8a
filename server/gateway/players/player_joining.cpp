// Joining and resuming: who may come in, when, and under which session.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "protocol/wire.h"
#include "server/gateway/players/player_hub.h"
#include "server/gateway/players/player_token.h"
#include "server/gateway/players/seat.h"

namespace aureole {
namespace {

/// So long a player waits for regions that are not there (µs); then the page is told that they are
/// missing, and the connection is closed.
constexpr std::int64_t regions_patience_us = 600'000'000;
/// One who waits is told what for this often (µs): a page that hears nothing takes the connection
/// for lost after some seconds.
constexpr std::int64_t waiting_word_us = 2'000'000;

std::int64_t unix_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Result<std::uint32_t> PlayerHub::new_session(PlayerId player, std::uint32_t after) {
  newest_session_ = next_session(unix_ms(), newest_session_);
  // What others have used for this player counts for this player alone: whoever makes up a number
  // near the end does not use up everybody's.
  const auto known = regions_.store().player(player);
  const std::uint32_t taken = std::max(after, known ? known->session : 0);
  if (taken >= session_max)
    return Error{
        "This avatar has been taken over too often to be taken over again; please join without a "
        "token"};
  return std::max(newest_session_, taken + 1);
}

/// Those who have gone without a word, and whom their regions keep for a while.
std::size_t PlayerHub::abandoned_avatars() const {
  std::size_t count = 0;
  for (const ReplicaPlayer& player : regions_.store().players()) count += player.connected ? 0 : 1;
  for (const Departing& departing : departing_) {
    const auto known = regions_.store().player(departing.session->player());
    count += !known || known->connected ? 1 : 0;  // Its region has not heard of it yet.
  }
  return count;
}

void PlayerHub::on_join(Seat& seat, JoinMessage message, std::int64_t now_us) {
  if (seat.session || seat.asked) return refuse(seat, "\"join\" may come only once");
  seat.new_player = message.token.empty();
  while (
      message.token.empty() ||
      (seat.new_player && regions_.store().version(BodyId::avatar(player_of_token(message.token)))))
    message.token = make_player_token();

  const PlayerId player = player_of_token(message.token);
  std::size_t others = 0;
  for (const auto& [id, other] : seats_) {
    if (other.get() == &seat || other->closing) continue;
    const std::string* token = other->session ? &other->session->token()
                               : other->asked ? &other->asked->token
                                              : nullptr;
    if (!token) continue;
    if (player_of_token(*token) != player) {
      ++others;
    } else if (*token == message.token) {
      end_session(*other);
      refuse(*other, "You have connected again from another window");
    } else {
      return refuse(seat, "This token cannot be used now; please join without one");
    }
  }
  const auto max_players = static_cast<std::size_t>(options_.max_players);
  if (others >= max_players)
    return refuse(seat, fmt::format("This gateway is full: {} players are here", others));
  // Each of them is a body, and a place that somebody may come back to.
  if (seat.new_player)
    if (const std::size_t abandoned = abandoned_avatars(); abandoned >= max_players)
      return refuse(seat, fmt::format("The world still keeps the places of {} players who have "
                                      "just gone; please try again in half a minute",
                                      abandoned));
  seat.asked = std::move(message);
  seat.since_us = now_us;
  try_admit(seat, now_us);
}

void PlayerHub::regions_changed(std::int64_t now_us) {
  for (const auto& [id, seat] : seats_)
    if (seat->asked) try_admit(*seat, now_us);
}

void PlayerHub::try_admit(Seat& seat, std::int64_t now_us) {
  // An avatar that is sent to its spawn point while it stands in a region that is silent just now
  // would be there twice; a player who has never been here needs one region only.
  const PlayerId player = player_of_token(seat.asked->token);
  const bool ready =
      seat.new_player ? regions_.is_complete(spawn_region(player)) : regions_.all_complete();
  if (ready) return admit(seat, now_us);
  const std::vector<std::string> missing =
      seat.new_player ? std::vector{regions_.name_of(spawn_region(player))} : regions_.missing();
  if (now_us - seat.since_us >= regions_patience_us)
    return refuse(
        seat, fmt::format("The world is not complete yet; missing: {}", fmt::join(missing, ", ")));
  seat.connection->send_text(waiting_text(missing));
  seat.word_due_us = now_us + waiting_word_us;
}

void PlayerHub::admit(Seat& seat, std::int64_t now_us) {
  const JoinMessage join = std::move(*seat.asked);
  seat.asked.reset();
  const PlayerId player = player_of_token(join.token);
  const auto number = new_session(player, 0);
  if (!number) return refuse(seat, number.error().message);
  std::erase_if(departing_, [&](const Departing& d) { return d.session->player() == player; });
  const bool resumed = regions_.store().version(BodyId::avatar(player)).has_value();
  const std::uint16_t spawn = spawn_of(player);

  PlayerSession::Options options;
  options.token = join.token;
  options.name = join.name;
  options.view = {.width = join.width, .height = join.height};
  options.look = {world_.spawn_points[spawn].yaw_rad, 0};
  options.stream = {player, options_.gateway, *number, spawn};
  seat.session = std::make_shared<PlayerSession>(options);
  seat.view = std::make_shared<PlayerView>(stage_, seat.connection, seat.session);
  spdlog::info("player {} {} from {}", join.name, resumed ? "goes on" : "joins",
               seat.connection->remote());

  WelcomeMessage welcome;
  welcome.token = join.token;
  welcome.player = player;
  welcome.resumed = resumed;
  welcome.yaw = options.look.yaw;
  welcome.world_name = world_.name;
  welcome.world_description = world_.description;
  for (std::uint16_t r = 0; r < world_.regions.size(); ++r) {
    const Colour c = region_colour(RegionId{r});
    welcome.regions.push_back(
        {world_.regions[r].name, (std::uint32_t{c.r} << 16) | (std::uint32_t{c.g} << 8) | c.b});
  }
  for (std::size_t i = 0; i < 4; ++i) welcome.throwables[i] = world_.throwables[i].name;
  seat.connection->send_text(welcome_text(welcome));
  send_commands(*seat.session, now_us);
  send_status(seat, now_us);
}

}  // namespace aureole
