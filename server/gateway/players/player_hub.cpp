// Connections, playing and leaving.
#include "server/gateway/players/player_hub.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "server/gateway/players/picking.h"
#include "server/gateway/players/seat.h"
#include "server/net/world_clock.h"

namespace aureole {
namespace {

/// A connection that has not said `join` by then is closed (µs).
constexpr std::int64_t join_patience_us = 10'000'000;
/// So long the regions are told that a player is gone, until they confirm it (µs).
constexpr std::int64_t departing_us = 5'000'000;
/// An avatar that no region knows of for so long will not come back by itself (µs).
constexpr std::int64_t lost_avatar_us = 2'000'000;
/// Departing players remembered at a time; more are dropped, and time out in their regions.
constexpr std::size_t max_departing = 256;
/// Deeds (throws, blasts …) of one player: so many a second for long, and so many at once.
constexpr double actions_per_s = 15;
constexpr double actions_burst = 30;

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
  if (!number) return number.error();
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
      if (now_us >= seat->word_due_us) try_admit(*seat, now_us);
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
