// Moments of each server, kept for a while, and put together for one tick.
#include "server/experiment/oracles/view/world_view.h"

#include <algorithm>

namespace aureole {
namespace {

bool by_id(const SeenBody& a, const SeenBody& b) {
  return a.id < b.id;
}

}  // namespace

void WorldView::stepped(RegionId region, Tick tick, const RegionCore& core,
                        std::span<const Departure> departures) {
  Server& server = servers_[region.value];
  if (server.gone_since) {
    server.moments.clear();
    server.gone_since.reset();
  }
  Moment& moment = server.moments.emplace_back();
  moment.tick = tick;
  const PhysicsWorld& physics = core.physics();
  moment.bodies.reserve(physics.size());
  for (BodyId id : physics.ids())
    moment.bodies.push_back({id, physics.prototype(id), region, physics.state(id)});
  for (const Departure& departure : departures) {
    for (const auto& b : departure.group.bodies) {
      const SeenBody last{b.body.id, b.body.prototype, region, b.body.state};
      moment.bodies.push_back(last);
      moment.left.push_back(b.body.id);
      flights_.insert_or_assign(b.body.id, Flight{departure.group.tick, departure.to, last});
    }
  }
  std::sort(moment.bodies.begin(), moment.bodies.end(), by_id);
  std::sort(moment.left.begin(), moment.left.end());
  while (server.moments.size() > 2 * delay_ticks) server.moments.pop_front();
}

void WorldView::gone(RegionId region, Tick tick) {
  servers_[region.value].gone_since = tick;
}

const std::vector<SeenBody>& WorldView::at(Tick tick) {
  struct Claim {
    SeenBody body;
    Tick of;
  };
  std::vector<Claim> claims;
  for (const Server& server : servers_) {
    if (server.gone_since && tick >= *server.gone_since) continue;
    const Moment* moment = nullptr;
    for (const Moment& m : server.moments)
      if (m.tick <= tick) moment = &m;
    if (moment == nullptr) continue;
    for (const SeenBody& body : moment->bodies) {
      const bool left = moment->tick < tick &&
                        std::binary_search(moment->left.begin(), moment->left.end(), body.id);
      if (!left) claims.push_back({body, moment->tick});
    }
  }
  std::stable_sort(claims.begin(), claims.end(), [](const Claim& a, const Claim& b) {
    return std::pair(a.body.id, b.of) < std::pair(b.body.id, a.of);
  });
  seen_.clear();
  for (const Claim& claim : claims)
    if (seen_.empty() || seen_.back().id != claim.body.id) seen_.push_back(claim.body);
  fill_in_flights(tick);
  return seen_;
}

void WorldView::fill_in_flights(Tick tick) {
  const std::size_t hosted = seen_.size();
  for (auto it = flights_.begin(); it != flights_.end();) {
    const Flight& flight = it->second;
    if (flight.since >= tick) {
      ++it;
      continue;
    }
    const bool landed = std::binary_search(seen_.begin(), seen_.begin() + std::ptrdiff_t(hosted),
                                           flight.last, by_id);
    if (landed || tick - flight.since > flight_ticks_max) {
      it = flights_.erase(it);
      continue;
    }
    Tick when;
    if (const auto first = first_after(flight.to, tick, it->first, when)) {
      SeenBody body = *first;
      const double whole = static_cast<double>(when - flight.since) * tick_s;
      const double share = static_cast<double>(tick - flight.since) * tick_s / whole;
      const Eigen::Vector3d from = flight.last.state.position.vector();
      const Eigen::Vector3d to = first->state.position.vector();
      body.state.position = WorldPosition::from(Eigen::Vector3d(from + (to - from) * share));
      body.state.orientation =
          flight.last.state.orientation.slerp(static_cast<float>(share), first->state.orientation);
      const Eigen::Vector3d ballistic =
          from + flight.last.state.linear_velocity.cast<double>() * whole;
      body.uncertainty_m = (to - ballistic).norm();
      seen_.push_back(body);
    }
    ++it;
  }
  std::sort(seen_.begin(), seen_.end(), by_id);
}

std::optional<SeenBody> WorldView::first_after(RegionId region, Tick tick, BodyId id,
                                               Tick& when) const {
  for (const Moment& moment : servers_[region.value].moments) {
    if (moment.tick <= tick) continue;
    const auto at =
        std::lower_bound(moment.bodies.begin(), moment.bodies.end(), id,
                         [](const SeenBody& b, BodyId wanted) { return b.id < wanted; });
    if (at == moment.bodies.end() || at->id != id) continue;
    when = moment.tick;
    return *at;
  }
  return {};
}

}  // namespace aureole
