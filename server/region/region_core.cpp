// A region's surroundings: peers that come and go, and messages that are checked and queued.
#include "server/region/region_core.h"

#include <algorithm>
#include <limits>

#include "protocol/wire.h"
#include "server/base/check.h"
#include "server/base/hash.h"
#include "server/region/signs_of_life.h"
#include "server/region/status/status_message.h"
#include "server/worlds/region_tiling.h"

namespace aureole {
namespace {

/// Messages of one kind that wait for the next step; far more than honest peers send in one.
constexpr std::size_t queue_max = 65'536;
/// The same from gateways while this region recovers.
constexpr std::size_t frozen_commands_max = 4096;
/// The same for whole messages. They come again from the journal.
constexpr std::size_t waiting_max = 4096;
/// Of groups that wait. Whoever catches up takes one in every step at least.
constexpr std::size_t waiting_bytes_max = 256u << 20;
/// Messages that a neighbour has not said it has taken: it says so in every step.
constexpr std::size_t untaken_max = 16'384;
/// Blasts that wait, or are remembered: every one is looked at in every step. Far more than players
/// can set off in that time.
constexpr std::size_t blasts_max = 4096;
/// As many as a snapshot takes.
constexpr std::size_t pending_removals_max = 65'536;

/// None in columns: what is told there is near as it is.
std::optional<Whereabouts> whereabouts_in(const WorldDefinition& world, bool has_corners) {
  if (!has_corners) return {};
  double largest_m = 0;
  for (const Prototype& prototype : world.prototypes)
    largest_m = std::max(largest_m, double{bounding_radius(prototype.body.shape)});
  return Whereabouts(world.bounds, largest_m);
}

/// For an order of servers where three regions meet; elsewhere none, so that numbers decide.
std::vector<std::uint16_t> neighbours_in(const PartitionMap& map) {
  std::vector<std::uint16_t> neighbours;
  if (!map.has_corners()) return neighbours;
  for (std::uint16_t k = 0; k < map.size(); ++k)
    neighbours.push_back(static_cast<std::uint16_t>(map.neighbours(RegionId{k}).size()));
  return neighbours;
}

}  // namespace

RegionCore::RegionCore(const WorldDefinition& world, RegionId self, Incarnation incarnation)
    : world_(world),
      self_(self),
      incarnation_(incarnation),
      map_(partition_of(world)),
      policy_(make_policy(world.mode, world.tolerances)),
      hosting_(world, self, incarnation),
      players_(world, map_, self, hosting_),
      stand_ins_(hosting_.physics(), whereabouts_in(world, map_.has_corners())),
      hosted_bodies_(map_, self_, hosting_.statics()),
      awake_everywhere_(world.regions.size(), 0.0),
      load_levels_(world.regions.size(), self),
      neighbours_(neighbours_in(map_)),
      home_lines_(map_, self, HomeLines::rule_in(world.mode, map_)),
      injected_(world.injectors.size(), 0),
      tolerances_(world.tolerances, self, world.regions.size()) {
  AUREOLE_CHECK(self.value < world.regions.size(), "a core is one of its world's regions");
  level_from(LoadLevels::awake_min);
  for (std::size_t i = 0; i < world.regions.size(); ++i) {
    if (i == self.value) continue;
    const RegionId region{static_cast<std::uint16_t>(i)};
    const std::int64_t interval_ticks =
        word_interval_ticks(map_, self, region, world.tolerances.speed_mps);
    peers_[PeerId::region(region)].word_every_ticks = interval_ticks;
    tolerances_.expect_word(region, interval_ticks);
  }
  for (const Injector& injector : world.injectors) {
    const Eigen::Vector3d &low = injector.volume.min, &high = injector.volume.max;
    may_inject_here_.push_back(map_.area(self).overlaps({low.x(), low.z(), high.x(), high.z()}));
  }
}

void RegionCore::level_from(double awake, std::optional<double> crowd_share) {
  // Where only two ever meet the line between them is shifted; an order that changes would only
  // make bodies change their owners more often.
  constexpr double never = std::numeric_limits<double>::infinity();
  load_levels_.level_from(map_.has_corners() ? awake : never);
  // A handful of bodies that is to move lines is a large crowd of all there are.
  const bool eager = awake < LoadLevels::awake_min;
  QuietPlaceLimits limits = eager ? QuietPlaceLimits::none() : QuietPlaceLimits{};
  limits.crowd_share = crowd_share.value_or(limits.crowd_share);
  home_lines_.level_from(awake / 2, limits);
}

void RegionCore::peer_up(PeerId id, Incarnation incarnation) {
  Peer& peer = peers_[id];
  peer.up = true;
  peer.up_since = last_tick_;
  peer.met = true;
  peer.incarnation = incarnation;
  peer.recovering = false;
  peer.asked_round = 0;
  if (recovery_) recovery_->peer_up(id, incarnation);
  if (id.is_region()) {
    note_neighbour_is_back(id.as_region());
    peer.journal.link_up(incarnation);
    aura_exchange_.link_up(id.as_region());
    tolerances_.link_up(id.as_region());
    peer.wants_status = true;
  } else {
    peer.wants_whole_state = true;
  }
}

void RegionCore::note_neighbour_is_back(RegionId region) {
  const auto& neighbours = map_.neighbours(self_);
  if (std::binary_search(neighbours.begin(), neighbours.end(), region))
    players_.hold_all(last_tick_);
}

void RegionCore::peer_down(PeerId id) {
  const auto it = peers_.find(id);
  if (it == peers_.end()) return;
  it->second.up = false;
  if (recovery_) recovery_->peer_down(id);
  if (id.is_region()) {
    aura_exchange_.link_down(id.as_region());
    tolerances_.link_down(id.as_region());
    return;
  }
  players_.gateway_down(static_cast<std::uint16_t>(id.value - PeerId::first_gateway), last_tick_);
  peers_.erase(it);
}

Status RegionCore::check_room(const EffectsMessage& effects) const {
  if (arrived_effects_.size() >= waiting_max) return Error{"too many effects at once"};
  std::size_t blasts = blasts_.size() + effects.blasts.size();
  std::size_t removals = pending_removals_.size() + effects.removals.size();
  for (const auto& [from, arrived] : arrived_effects_) {
    blasts += arrived.blasts.size();
    removals += arrived.removals.size();
  }
  if (blasts > blasts_max)
    return Error::format("{} blasts would wait or have just been; expected at most {}", blasts,
                         blasts_max);
  if (removals > pending_removals_max)
    return Error::format("{} removals would wait for their bodies; expected at most {}", removals,
                         pending_removals_max);
  return Ok{};
}

Status RegionCore::receive(PeerId from, const FrameView& frame) {
  const auto it = peers_.find(from);
  if (it == peers_.end() || !it->second.up)
    return Error::format("a message of server {}, which is not part of this world", from.value);
  Peer& peer = it->second;
  if (frame.type != FrameType::acknowledge && peer.journal.untaken() > untaken_max)
    return Error::format("it has not said that it took {} messages; expected at most {}",
                         peer.journal.untaken(), untaken_max);

  if (frame.type == FrameType::commands) {
    auto commands = decode_commands(frame.payload);
    if (!commands) return commands.error();
    // While nothing is simulated gateways would fill the queue; what they do not see applied they
    // send again.
    const bool full = arrived_commands_.size() + commands->size() > frozen_commands_max;
    if (recovery_ && !from.is_region() && full) return Ok{};
    if (arrived_commands_.size() + commands->size() > queue_max)
      return Error{"too many commands at once"};
    if (from.is_region()) {
      auto arrival = peer.journal.arrive(frame.sequence);
      if (!arrival) return arrival.error();
      if (*arrival == Journal::Arrival::repeated) return Ok{};
    } else {
      // A gateway speaks for its own players only under its own number.
      for (PlayerCommand& c : *commands)
        c.gateway = static_cast<std::uint16_t>(from.value - PeerId::first_gateway);
    }
    arrived_commands_.insert(arrived_commands_.end(), commands->begin(), commands->end());
    return Ok{};
  }
  if (frame.type == FrameType::recovery_query || frame.type == FrameType::recovery_answer)
    return receive_recovery(from, peer, frame);
  if (!from.is_region())
    return Error::format(
        "a gateway sent a message of type {}; expected commands or a recovery answer",
        static_cast<int>(frame.type));
  switch (frame.type) {
    case FrameType::acknowledge: {
      const auto* message = verified<wire::Acknowledge>(frame.payload);
      if (message == nullptr) return Error{"an acknowledgement is not a valid message"};
      return peer.journal.acknowledge(message->sequence(), message->durable());
    }
    case FrameType::handoff: {
      auto group =
          decode_handoff(frame.payload, hosting_.definitions().size(), hosting_.statics().size());
      if (!group) return group.error();
      std::size_t bytes = frame.payload.size();
      for (const Arrived& arrived : arrived_groups_) bytes += arrived.bytes;
      if (arrived_groups_.size() >= waiting_max || bytes > waiting_bytes_max)
        return Error{"too many handoffs at once"};
      auto arrival = peer.journal.arrive(frame.sequence);
      if (!arrival) return arrival.error();
      if (*arrival == Journal::Arrival::repeated) return Ok{};
      if (recovery_) return recovery_->hear_group(*group);
      arrived_groups_.push_back({from.as_region(), std::move(*group), frame.payload.size()});
      return Ok{};
    }
    case FrameType::effects: {
      auto effects = decode_effects(frame.payload);
      if (!effects) return effects.error();
      if (auto ok = check_room(*effects); !ok) return ok;
      auto arrival = peer.journal.arrive(frame.sequence);
      if (!arrival) return arrival.error();
      if (*arrival == Journal::Arrival::fresh)
        arrived_effects_.emplace_back(from.as_region(), std::move(*effects));
      return Ok{};
    }
    case FrameType::auras: {
      auto told = aura_exchange_.receive(from.as_region(), frame.payload,
                                         hosting_.definitions().size(), map_.size());
      if (!told) return told.error();
      tolerances_.heard(from.as_region(), *told);
      if (peer.word_every_ticks > 1)
        tolerances_.expect_word(from.as_region(), aura_exchange_.hears_of(from.as_region())
                                                      ? 1
                                                      : peer.word_every_ticks);
      return Ok{};
    }
    case FrameType::region_status: {
      const auto status = decode_status(frame.payload, map_.size());
      if (!status) return status.error();
      peer.bodies = status->report.bodies;
      note_awake(from.as_region(), status->report.awake);
      load_levels_.hear(from.as_region(), status->tick, status->level);
      home_lines_.hear(from.as_region(), status->tick, status->lines);
      return Ok{};
    }
    default:
      return Error::format("a region sent a message of type {}, which regions do not take",
                           static_cast<int>(frame.type));
  }
}

void RegionCore::link_measured(RegionId peer, double latency_ms) {
  tolerances_.link_measured(peer, latency_ms);
}

/// As told in statuses, ours as well: smoothed over about a second, for blows wake whole heaps for
/// a moment.
void RegionCore::note_awake(RegionId region, std::size_t awake) {
  double& mean = awake_everywhere_[region.value];
  mean += (static_cast<double>(awake) - mean) / 4;
}

bool RegionCore::has_room(std::size_t more) const {
  std::size_t known = hosting_.physics().size() + more;
  for (const auto& [id, peer] : peers_) known += peer.bodies;
  return known <= world_.max_bodies;
}

bool RegionCore::is_up(RegionId region) const {
  const auto it = peers_.find(PeerId::region(region));
  return it != peers_.end() && it->second.up && !it->second.recovering;
}

/// Where those are and were at home that have been there and simulate nothing now. Lines that were
/// on their way when a region went down go on, but what it had stays where it was. Whoever is back
/// simulates again when it tells us of a step: until then it may be about to recover.
std::vector<Rectangle> RegionCore::close_areas() {
  std::vector<Rectangle> closed;
  for (auto& [id, peer] : peers_) {
    if (!id.is_region() || !peer.met) continue;
    const bool away = !peer.up || peer.recovering;
    const Rectangle& home = home_lines_.map().area(id.as_region());
    if (!away && aura_exchange_.has_heard(id.as_region()))
      peer.closed.reset();
    else if (away && !peer.closed)
      peer.closed = home;
    if (!peer.closed) continue;
    closed.push_back(*peer.closed);
    if (home != *peer.closed) closed.push_back(home);
  }
  return closed;
}

bool RegionCore::waits_for_auras(RegionId region, const Peer& peer, Tick now) const {
  return now - peer.up_since <= await_auras_ticks && !aura_exchange_.has_heard(region);
}

std::uint64_t RegionCore::state_hash() const {
  Hasher hasher;
  hasher.add(last_tick_.value).add(hosting_.state_hash());
  for (const auto& arrived : arrived_groups_)
    for (const auto& b : arrived.group.bodies) hasher.add(b.body.id.value).add(b.epoch);
  for (const auto& [id, peer] : peers_)
    hasher.add(id.value).add(peer.journal.taken()).add(peer.journal.unacknowledged().size());
  for (const Avatar* avatar : players_.avatars())
    hasher.add(avatar->player.value).add(avatar->applied_sequence).add(avatar->carried.value);
  return hasher.value();
}

RegionStatistics RegionCore::statistics() const {
  RegionStatistics all = extra_;
  const Hosting::Counts& counts = hosting_.counts();
  all.bodies = hosting_.physics().size();
  all.awake = hosting_.physics().awake_count();
  all.spawned = counts.spawned;
  all.removed = counts.removed;
  all.migrations_in = counts.migrations_in;
  all.migrations_out = counts.migrations_out;
  all.version_conflicts = counts.version_conflicts;
  all.stand_ins = stand_ins_.size();
  all.struck_stand_ins = stand_in_watch_.struck();
  all.recovered = counts.recovered;
  all.tolerance_events = tolerances_.left_count();
  for (const auto& [id, peer] : peers_) {
    all.unacknowledged += peer.journal.unacknowledged().size();
    all.let_go += peer.journal.let_go();
  }
  return all;
}

}  // namespace aureole
