// Broad phase by rows of boxes, then real shapes, then the question of what excuses a pair.
#include "server/experiment/oracles/oracle_interactions.h"

#include <fmt/format.h>

#include <algorithm>

namespace aureole {
namespace {

constexpr std::size_t told_max = 4;

bool moves(const SeenBody& b) {
  return b.state.activation != Activation::asleep;
}

/// What players throw has been expected of their avatars.
bool comes_unannounced(BodyId id) {
  return id.kind() != BodyId::Kind::thrown;
}

}  // namespace

InteractionOracle::InteractionOracle(const WorldDefinition& world,
                                     const ToleranceRecord& tolerances,
                                     const OwnershipOracle& ownership)
    : world_(world), tolerances_(tolerances), ownership_(ownership), shapes_(world) {}

void InteractionOracle::look(Tick tick, const std::vector<SeenBody>& bodies) {
  follow(tick, bodies);
  const bool one_owner = std::all_of(bodies.begin(), bodies.end(), [&](const SeenBody& b) {
    return b.owner == bodies.front().owner;
  });
  if (!one_owner) {
    boxes_.clear();
    for (const SeenBody& b : bodies) {
      AuraBox& box = boxes_.emplace_back();
      box.centre = b.state.position.vector();
      // Half of a tick's way to each side would do; a whole one is as easy and safer.
      const double reach =
          shapes_.bounding_radius(b.prototype) + b.state.linear_velocity.norm() * tick_s;
      box.half.setConstant(reach);
    }
    rows_.build(boxes_);
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < bodies.size(); ++i) {
      found.clear();
      rows_.find(boxes_[i], found);
      for (std::uint32_t j : found)
        if (j > i && bodies[j].owner != bodies[i].owner) look_at_pair(tick, bodies[i], bodies[j]);
    }
  }
  // What was not seen to overlap in this tick has separated, or is on one server again.
  std::erase_if(overlaps_, [&](const auto& o) { return o.second.seen < tick; });
  for (const SeenBody& b : bodies) {
    Track& track = tracks_[b.id];
    track.last = b;
    track.seen = tick;
  }
}

void InteractionOracle::follow(Tick tick, const std::vector<SeenBody>& bodies) {
  for (const SeenBody& b : bodies) {
    Track& track = tracks_[b.id];
    track.outside = std::max(track.outside, tolerances_.server(b.owner));
    if (b.state.linear_velocity.norm() > world_.tolerances.speed_mps) track.outside = tick;
    const bool known = track.last.id == b.id;
    // Nobody simulated it for longer than a flight takes, wherever it went meanwhile.
    if (known && tick - track.seen > WorldView::flight_ticks_max) track.outside = tick;
    if (known && track.last.owner != b.owner)
      track.outside = std::max({track.outside, tolerances_.link(track.last.owner, b.owner),
                                tolerances_.server(track.last.owner)});
  }
}

void InteractionOracle::look_at_pair(Tick tick, const SeenBody& a, const SeenBody& b) {
  const double bound = shapes_.bounding_radius(a.prototype) + shapes_.bounding_radius(b.prototype);
  const bool near = distance(a.state.position, b.state.position) < bound;
  const double depth =
      near ? -shapes_.separation(a, b) - a.uncertainty_m - b.uncertainty_m : -bound;
  const auto known = overlaps_.find({a.id, b.id});
  // A pair that counted does not count again until there is air between the two.
  if (known != overlaps_.end() && depth > 0) known->second.seen = tick;
  if (depth > slop_m) {
    Overlap& overlap = known != overlaps_.end() ? known->second : begin_overlap(tick, a, b, depth);
    if (depth > overlap.brought_m + slop_m) count(tick, a, b, overlap, depth, "overlaps");
  } else if (depth <= 0 && known == overlaps_.end() && passed_through(tick, a, b)) {
    count(tick, a, b, begin_overlap(tick, a, b, depth), 0, "went through");
  }
}

InteractionOracle::Overlap& InteractionOracle::begin_overlap(Tick tick, const SeenBody& a,
                                                             const SeenBody& b, double depth_m) {
  Overlap& overlap = overlaps_[{a.id, b.id}];
  overlap.seen = tick;
  const Track &ta = tracks_.at(a.id), &tb = tracks_.at(b.id);
  const bool were_together = ta.last.id == a.id && tb.last.id == b.id &&
                             ta.last.owner == tb.last.owner && tick - ta.seen <= 2 &&
                             tick - tb.seen <= 2;
  if (were_together) overlap.brought_m = depth_m;
  overlap.at_birth = is_newborn(a.id, tick) || is_newborn(b.id, tick);
  return overlap;
}

void InteractionOracle::count(Tick tick, const SeenBody& a, const SeenBody& b, Overlap& overlap,
                              double depth_m, const char* how) {
  if (overlap.at_birth) {
    if (!overlap.counted) ++at_birth_;
    overlap.counted = true;
    return;
  }
  if (!overlap.counted) ++missed_;
  overlap.counted = true;
  if (overlap.counted_in_tolerance || is_excused(tick, a, b)) return;
  overlap.counted_in_tolerance = true;
  ++missed_in_tolerance_;
  if (violations_.size() >= told_max) return;
  const WorldPosition& at = a.state.position;
  violations_.push_back(
      {"missed", tick.value,
       fmt::format("{} on r{} {} {} on r{} by {:.0f} mm at ({:.2f}, {:.2f}, {:.2f}), speeds {:.1f} "
                   "and {:.1f} m/s{}{}",
                   describe(a.id), a.owner.value, how, describe(b.id), b.owner.value,
                   depth_m * 1000, at.x, at.y, at.z, a.state.linear_velocity.norm(),
                   b.state.linear_velocity.norm(), moves(a) ? "" : ", the first asleep",
                   moves(b) ? "" : ", the second asleep")});
}

bool InteractionOracle::was_apart(Tick tick, const SeenBody& a, const SeenBody& b) const {
  const Track &ta = tracks_.at(a.id), &tb = tracks_.at(b.id);
  return ta.seen == tick - 1 && tb.seen == tick - 1 && ta.last.owner != tb.last.owner;
}

bool InteractionOracle::passed_through(Tick tick, const SeenBody& a, const SeenBody& b) const {
  if (!was_apart(tick, a, b)) return false;
  const SeenBody &a_before = tracks_.at(a.id).last, &b_before = tracks_.at(b.id).last;
  const Eigen::Vector3d before =
      a_before.state.position.vector() - b_before.state.position.vector();
  const Eigen::Vector3d after = a.state.position.vector() - b.state.position.vector();
  // Only what moved relative to each other by more than the smaller one is thick can have passed.
  const double way = (after - before).norm();
  constexpr double thinnest_m = 0.1;
  if (way < thinnest_m) return false;
  return shapes_.meet_between(a_before, a, b_before, b, slop_m) &&
         shapes_.collide_in_one_step(a_before, b_before);
}

bool InteractionOracle::is_excused(Tick tick, const SeenBody& a, const SeenBody& b) const {
  const Tick outside =
      std::max({tracks_.at(a.id).outside, tracks_.at(b.id).outside, tolerances_.server(a.owner),
                tolerances_.server(b.owner), tolerances_.link(a.owner, b.owner)});
  return tolerances_.excuses(outside, tick);
}

bool InteractionOracle::is_newborn(BodyId id, Tick tick) const {
  const auto born = ownership_.born(id);
  return comes_unannounced(id) && born && tick - *born <= tolerances_.notice_ticks();
}

void InteractionOracle::stand_in_struck(RegionId region, const StandInWatch::Struck& struck) {
  // One whom nobody has seen yet at the end of a tick is born in this one.
  const bool fresh = comes_unannounced(struck.body) && !ownership_.born(struck.body);
  if (fresh || is_newborn(struck.body, struck.tick) || is_newborn(struck.stand_in, struck.tick)) {
    ++at_birth_;
    return;
  }
  ++struck_;
  ++missed_;
  if (tolerances_.excuses(tolerances_.anything_at(region), struck.tick)) return;
  ++missed_in_tolerance_;
  if (violations_.size() < told_max)
    violations_.push_back(
        {"missed", struck.tick.value,
         fmt::format("{} on r{} struck the stand-in of {} with {:.2f} m/s", describe(struck.body),
                     region.value, describe(struck.stand_in), struck.rise_mps)});
}

void InteractionOracle::report(SeedResult& result) const {
  result.missed_interactions = missed_;
  result.missed_interactions_in_tolerance = missed_in_tolerance_;
  result.missed_at_birth = at_birth_;
  result.struck_stand_ins = struck_;
  result.violations.insert(result.violations.end(), violations_.begin(), violations_.end());
}

}  // namespace aureole
