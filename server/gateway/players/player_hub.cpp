// Joining, resuming, playing and leaving.
#include "server/gateway/players/player_hub.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "protocol/wire.h"
#include "server/gateway/players/picking.h"
#include "server/gateway/players/player_token.h"
#include "server/gateway/players/seat.h"
#include "server/net/world_clock.h"

namespace aureole {
namespace {

/// A connection that has not said `join` by then is closed (µs).
constexpr std::int64_t join_patience_us = 10'000'000;
/// So long a player waits for regions that are not there (µs); then the page is told that they are
/// missing, and the connection is closed.
constexpr std::int64_t regions_patience_us = 600'000'000;
/// One who waits is told what for this often (µs): a page that hears nothing takes the connection
/// for lost after some seconds.
constexpr std::int64_t waiting_word_us = 2'000'000;
/// So long the regions are told that a player is gone, until they confirm it (µs).
constexpr std::int64_t departing_us = 5'000'000;
/// An avatar that no region knows of for so long will not come back by itself (µs).
constexpr std::int64_t lost_avatar_us = 2'000'000;
/// Departing players remembered at a time; more are dropped, and time out in their regions.
constexpr std::size_t max_departing = 256;
/// Deeds (throws, blasts …) of one player: so many a second for long, and so many at once.
constexpr double actions_per_s = 15;
constexpr double actions_burst = 30;

constexpr const char* no_sessions_left =
    "This avatar has been taken over too often to be taken over again; please join without a token";

std::int64_t unix_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

PlayerHub::PlayerHub(const WorldDefinition& world, RegionSubscriber& regions, Stage& stage,
                     const PlayerHubOptions& options)
    : world_(world), regions_(regions), stage_(stage), options_(options) {}

PlayerHub::~PlayerHub() {
  stop();
}

// ---- Where a player belongs
// ----------------------------------------------------------------------

std::uint16_t PlayerHub::spawn_of(PlayerId player) const {
  return static_cast<std::uint16_t>(player.value % world_.spawn_points.size());
}

RegionId PlayerHub::spawn_region(PlayerId player) const {
  const WorldPosition& at = world_.spawn_points[spawn_of(player)].position;
  return region_at(world_.regions, at.x, at.z);
}

RegionId PlayerHub::home_of(PlayerId player) const {
  const auto version = regions_.store().version(BodyId::avatar(player));
  return version ? version->region : spawn_region(player);
}

std::optional<std::uint32_t> PlayerHub::new_session(PlayerId player, std::uint32_t after) {
  newest_session_ = next_session(unix_ms(), newest_session_);
  // What others have used for this player counts for this player alone: whoever makes up a number
  // near the end does not use up everybody's.
  const auto known = regions_.store().player(player);
  const std::uint32_t taken = std::max(after, known ? known->session : 0);
  if (taken >= session_max) return std::nullopt;
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

// ---- Coming and going
// ----------------------------------------------------------------------------

void PlayerHub::connected(std::shared_ptr<Connection> connection) {
  const SeatId id = next_seat_++;
  auto seat = std::make_unique<Seat>();
  seat->id = id;
  seat->connection = connection;
  seat->since_us = monotonic_us();
  Seat& placed = *seats_.emplace(id, std::move(seat)).first->second;

  const auto with_seat = [this, id, alive = std::weak_ptr<int>(alive_)](auto use) {
    if (alive.expired()) return;
    const auto at = seats_.find(id);
    if (at != seats_.end()) use(*at->second);
  };
  ConnectionEvents events;
  events.text = [this, with_seat](std::string_view text) {
    with_seat([&](Seat& s) { on_text(s, text, monotonic_us()); });
  };
  events.picture_started = [with_seat](std::uint32_t number) {
    with_seat([&](Seat& s) {
      if (!s.session) return;
      s.session->pacing().sent(number, monotonic_us());
      s.view->retry(monotonic_us());
    });
  };
  events.closed = [this, with_seat](const std::string& reason) {
    with_seat([&](Seat& s) { on_closed(s.id, reason); });
  };
  connection->start(std::move(events));
  // Those who have not joined cost a seat too; a few more than players may stand at the door.
  if (seats_.size() > static_cast<std::size_t>(options_.max_players) + 16)
    refuse(placed, "This gateway has no room for more players");
}

void PlayerHub::refuse(Seat& seat, const std::string& sentence) {
  if (seat.closing) return;
  seat.closing = true;
  seat.asked.reset();
  seat.connection->close(sentence);
}

void PlayerHub::on_closed(SeatId id, const std::string& reason) {
  const auto at = seats_.find(id);
  if (at == seats_.end()) return;
  Seat& seat = *at->second;
  if (seat.session) {
    spdlog::info("player {} is gone: {}", seat.session->name(), reason);
    seat.session->depart(/*lost=*/true);
    if (departing_.size() < max_departing)
      departing_.push_back({.session = seat.session, .until_us = monotonic_us() + departing_us});
  }
  end_session(seat);
  seats_.erase(at);
}

void PlayerHub::end_session(Seat& seat) {
  if (seat.view) seat.view->end();
  seat.view.reset();
  seat.session.reset();
}

void PlayerHub::on_text(Seat& seat, std::string_view text, std::int64_t now_us) {
  if (seat.closing) return;
  auto message = parse_browser_message(text);
  if (!message) {
    spdlog::warn("{} is disconnected: {}", seat.connection->remote(), message.error().message);
    return refuse(seat, message.error().message);
  }
  if (auto* join = std::get_if<JoinMessage>(&*message)) {
    on_join(seat, std::move(*join), now_us);
  } else if (const auto* ping = std::get_if<PingMessage>(&*message)) {
    seat.connection->send_text(pong_text(ping->t));
  } else if (seat.session) {
    on_message(seat, *message, now_us);
  } else if (!seat.asked) {
    refuse(seat, "The first message must be \"join\"");
  }  // What comes between join and welcome is about a world that is not shown yet.
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
  const std::optional<std::uint32_t> number = new_session(player, 0);
  if (!number) return refuse(seat, no_sessions_left);
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

// ---- Playing
// -------------------------------------------------------------------------------------

void PlayerHub::on_message(Seat& seat, const BrowserMessage& message, std::int64_t now_us) {
  PlayerSession& session = *seat.session;
  Status status = Ok{};
  if (const auto* ack = std::get_if<AckMessage>(&message)) {
    session.pacing().acknowledged(ack->frame, now_us);
    return seat.view->retry(now_us);
  }
  if (const auto* input = std::get_if<InputMessage>(&message)) {
    status = session.input(*input, now_us);
  } else if (const auto* action = std::get_if<ActionMessage>(&message)) {
    status = on_action(seat, *action, now_us);
  } else if (const auto* view = std::get_if<ViewMessage>(&message)) {
    session.set_view(*view);
  } else if (std::holds_alternative<LeaveMessage>(message)) {
    return on_leave(seat, now_us);
  }
  if (!status) return refuse(seat, status.error().message);
  send_commands(session, now_us);
}

Status PlayerHub::on_action(Seat& seat, const ActionMessage& message, std::int64_t now_us) {
  PlayerSession& session = *seat.session;
  // Each deed costs the regions work; faster than any hand it counts as looking around only.
  seat.actions_left =
      std::min(actions_burst, seat.actions_left + static_cast<double>(now_us - seat.actions_at_us) /
                                                      1e6 * actions_per_s);
  seat.actions_at_us = now_us;
  if (seat.actions_left < 1)
    return session.input({message.seq, session.keys(), message.look}, now_us);
  seat.actions_left -= 1;
  BodyId target;
  if (message.action == PlayerAction::grab) {
    const auto known = regions_.store().player(session.player());
    if (!session.will_carry(known && known->carried.value != 0)) {
      // What the player sees counts, so the ray goes through the moment that is drawn now.
      const SharedMoment moment = stage_.moments.at(now_us);
      const ReplicaPose* avatar = moment ? moment->find(BodyId::avatar(session.player())) : nullptr;
      std::optional<BodyId> picked;
      if (avatar)
        picked =
            pick_body(world_, moment->poses, {stage_.builder.eye(avatar->position), message.look});
      if (!picked) {
        seat.notice = "Nothing that you can carry is within reach";
        send_status(seat, now_us);
        return session.input({message.seq, session.keys(), message.look}, now_us);
      }
      target = *picked;
    }
  }
  return session.action(message, target, now_us);
}

void PlayerHub::on_leave(Seat& seat, std::int64_t now_us) {
  seat.session->depart(/*lost=*/false);
  send_commands(*seat.session, now_us);
  if (departing_.size() < max_departing)
    departing_.push_back({.session = seat.session, .until_us = now_us + departing_us});
  spdlog::info("player {} leaves", seat.session->name());
  end_session(seat);
  refuse(seat, "You have left the world");
}

void PlayerHub::send_commands(PlayerSession& session, std::int64_t now_us) {
  const RegionId home = home_of(session.player());
  // Commands for a region that is away wait here, where the newest angles replace older ones.
  if (!regions_.is_complete(home)) return;
  CommandStream& stream = session.commands();
  stream.set_avatar_exists(regions_.store().version(BodyId::avatar(session.player())).has_value());
  regions_.send(home, stream.due(home, now_us));
}

void PlayerHub::region_updated(RegionId region, std::int64_t now_us) {
  const auto tick = regions_.store().newest_tick(region);
  if (!tick) return;
  const auto confirm = [&](PlayerSession& session) {
    const auto player = regions_.store().player(session.player());
    if (player && player->owner == region)
      session.commands().confirm(player->session, player->applied_sequence, *tick, now_us);
  };
  for (const auto& [id, seat] : seats_)
    if (seat->session) confirm(*seat->session);
  for (const Departing& departing : departing_) confirm(*departing.session);
}

Status PlayerHub::replace_lost_avatar(Seat& seat, std::int64_t now_us) {
  CommandStream& commands = seat.session->commands();
  const bool exists = regions_.store().version(BodyId::avatar(seat.session->player())).has_value();
  bool must_restart = commands.must_restart(now_us);
  if (exists || !regions_.all_complete()) {
    seat.avatar_missing_since_us.reset();
  } else if (!seat.avatar_missing_since_us) {
    seat.avatar_missing_since_us = now_us;
  } else if (now_us - *seat.avatar_missing_since_us >= lost_avatar_us) {
    seat.avatar_missing_since_us = now_us;
    must_restart = true;
  }
  if (!must_restart) return Ok{};
  const auto number = new_session(seat.session->player(), commands.session());
  if (!number) return Error{no_sessions_left};
  commands.restart(*number);
  return Ok{};
}

Status PlayerHub::play(Seat& seat, std::int64_t now_us) {
  PlayerSession& session = *seat.session;
  if (session.commands().superseded()) {
    end_session(seat);  // without a word to the region: the avatar has another player now
    return Error{"You have connected again from another place"};
  }
  if (auto status = session.tick(now_us); !status) return status;
  if (auto status = replace_lost_avatar(seat, now_us); !status) return status;
  send_commands(session, now_us);
  seat.view->due(now_us);
  return Ok{};
}

void PlayerHub::frame(std::int64_t now_us) {
  for (const auto& [id, seat] : seats_) {
    if (seat->closing) continue;
    if (seat->session) {
      if (auto status = play(*seat, now_us); !status) refuse(*seat, status.error().message);
    } else if (seat->asked) {
      if (now_us >= std::min(seat->word_due_us, seat->since_us + regions_patience_us))
        try_admit(*seat, now_us);
    } else if (now_us - seat->since_us >= join_patience_us) {
      refuse(*seat, "No \"join\" came");
    }
  }
  serve_departing(now_us);
}

void PlayerHub::serve_departing(std::int64_t now_us) {
  for (const Departing& departing : departing_) send_commands(*departing.session, now_us);
  const auto exists = [&](const Departing& d) {
    return regions_.store().version(BodyId::avatar(d.session->player())).has_value();
  };
  for (Departing& departing : departing_) departing.avatar_seen |= exists(departing);
  std::erase_if(departing_, [&](const Departing& d) {
    // The avatar of one who has gone at once is about to appear, and not gone.
    const bool avatar_gone = d.avatar_seen && !exists(d);
    return now_us >= d.until_us || d.session->commands().all_applied() || avatar_gone ||
           d.session->commands().superseded();
  });
}

void PlayerHub::stop() {
  for (auto& [id, seat] : seats_) {
    end_session(*seat);
    refuse(*seat, {});
  }
  seats_.clear();
  departing_.clear();
}

}  // namespace aureole
