// What players and operators are told of players.
#include <algorithm>
#include <utility>

#include "server/gateway/players/player_hub.h"
#include "server/gateway/players/seat.h"

namespace aureole {

void PlayerHub::send_status(std::int64_t now_us) {
  for (const auto& [id, seat] : seats_)
    if (seat->session && !seat->closing) send_status(*seat, now_us);
}

void PlayerHub::send_status(Seat& seat, std::int64_t now_us) {
  const PlayerSession& session = *seat.session;
  const ReplicaStore& store = regions_.store();
  const BodyId avatar = BodyId::avatar(session.player());
  StatusMessage status;
  status.fps = session.pacing().fps(now_us);
  status.bodies = store.size();
  status.awake = store.awake_count();
  status.players = player_count();
  if (const auto version = store.version(avatar))
    status.region = world_.regions.at(version->region.value).name;
  const SharedMoment moment = stage_.moments.at(now_us);
  if (moment) {
    status.world_time_s = static_cast<double>(moment->world_us) / 1e6;
    if (const ReplicaPose* pose = moment->find(avatar)) status.position = pose->position;
  }
  const auto player = store.player(session.player());
  status.carrying = player && player->carried.value != 0;
  status.regions_up = regions_.linked_count();
  status.regions = world_.regions.size();
  status.quality = session.pacing().quality();
  status.scale = session.pacing().scale();
  status.notice = std::exchange(seat.notice, {});
  seat.connection->send_status(status_text(status));
}

std::size_t PlayerHub::player_count() const {
  return static_cast<std::size_t>(
      std::count_if(seats_.begin(), seats_.end(),
                    [](const auto& entry) { return entry.second->session != nullptr; }));
}

std::vector<PlayerReport> PlayerHub::reports(std::int64_t now_us) const {
  std::vector<PlayerReport> reports;
  for (const auto& [id, seat] : seats_) {
    if (!seat->session) continue;
    const PlayerSession& session = *seat->session;
    PlayerReport report;
    report.name = session.name();
    report.region = world_.regions.at(home_of(session.player()).value).name;
    report.fps = session.pacing().fps(now_us);
    report.quality = session.pacing().quality();
    report.scale = session.pacing().scale();
    report.width = session.picture_width();
    report.height = session.picture_height();
    report.round_trip_ms = static_cast<double>(session.pacing().shortest_round_trip_us()) / 1e3;
    report.unapplied = session.commands().unapplied();
    reports.push_back(std::move(report));
  }
  return reports;
}

}  // namespace aureole
