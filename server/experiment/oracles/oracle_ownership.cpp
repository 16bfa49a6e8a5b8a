// The ledger of bodies.
#include "server/experiment/oracles/oracle_ownership.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "server/worlds/injector.h"

namespace aureole {
namespace {

/// Of each rule so many are told in words; the rest are counted.
constexpr int told_max = 3;

/// Handoffs in the journals of `core` that hold anybody who `has_left` and were sealed in this
/// step.
std::vector<Departure> departures_of(const RegionCore& core, RegionId self,
                                     const WorldDefinition& world,
                                     const std::function<bool(BodyId)>& has_left, Tick tick) {
  std::vector<Departure> found;
  for (std::uint16_t other = 0; other < world.regions.size(); ++other) {
    if (other == self.value) continue;
    for (const Journal::Entry& entry : core.journal(RegionId{other}).unacknowledged()) {
      if (entry.type != FrameType::handoff) continue;
      auto group = decode_handoff(entry.payload, world.prototypes.size(), world.statics.size());
      if (!group || tick - group->tick > 1) continue;
      const bool ours = std::any_of(group->bodies.begin(), group->bodies.end(),
                                    [&](const auto& b) { return has_left(b.body.id); });
      if (ours) found.push_back({self, RegionId{other}, std::move(*group)});
    }
  }
  return found;
}

}  // namespace

std::string describe(BodyId id) {
  const std::uint64_t rest = id.value & 0xff'ffff'ffff'ffffu;
  switch (id.kind()) {
    case BodyId::Kind::world:
      return fmt::format("world body {}", rest);
    case BodyId::Kind::injected:
      return fmt::format("body {} of injector {}", rest & 0xff'ffff'ffffu, rest >> 40);
    case BodyId::Kind::avatar:
      return fmt::format("avatar {}", rest);
    case BodyId::Kind::thrown:
      return fmt::format("body {} thrown by player {}", rest & 0xff'ffffu, rest >> 24);
    case BodyId::Kind::none:
      break;
  }
  return "no body";
}

OwnershipOracle::OwnershipOracle(const WorldDefinition& world, std::size_t regions)
    : world_(world), servers_(regions) {}

std::vector<Departure> OwnershipOracle::stepped(const SimulatedServer& from, Tick tick) {
  Server& server = servers_[from.self().value];
  const RegionCore& core = from.core();
  if (server.incarnation != from.incarnation()) {
    server = {};
    server.incarnation = from.incarnation();
    server.started = tick;
  }
  const auto now_hosted = core.physics().ids();
  std::vector<BodyId> came, went;
  std::set_difference(now_hosted.begin(), now_hosted.end(), server.hosted.begin(),
                      server.hosted.end(), std::back_inserter(came));
  std::set_difference(server.hosted.begin(), server.hosted.end(), now_hosted.begin(),
                      now_hosted.end(), std::back_inserter(went));
  const Hosting::Counts counts = core.hosting().counts();
  std::vector<Departure> departures;
  std::set<BodyId> unexplained(went.begin(), went.end());
  if (counts.migrations_out != server.counts.migrations_out) {
    // Who is born and handed over in one step was never seen here.
    const auto has_left = [&](BodyId id) {
      return unexplained.contains(id) || !bodies_.contains(id);
    };
    departures = departures_of(core, from.self(), world_, has_left, tick);
    for (const Departure& departure : departures) {
      largest_ = std::max<std::uint64_t>(largest_, departure.group.bodies.size());
      for (const auto& b : departure.group.bodies) {
        unexplained.erase(b.body.id);
        if (!bodies_.contains(b.body.id)) left_at_birth(b.body.id, from, tick);
      }
    }
  }
  const bool on_purpose = counts.removed - server.counts.removed >= unexplained.size();
  for (BodyId id : went) {
    Record& record = bodies_[id];
    if (record.owner == from.self()) record.owner.reset();
    record.missing_since = tick;
    if (unexplained.contains(id) && on_purpose && !record.owner) {
      record.removed = true;
      record.removed_by = from.self();
      record.removed_at = tick;
      missing_.erase(id);
    } else if (!record.owner) {
      missing_.insert(id);
    }
  }
  coming_.clear();
  for (BodyId id : came)
    if (const auto known = bodies_.find(id); known != bodies_.end())
      coming_[id] = known->second.last_owner;
  forced_from_.clear();
  for (const auto& [id, owner] : coming_)
    if (meets_settled(id, owner, from, tick)) forced_from_.insert(owner);
  for (BodyId id : came) gained(id, from, tick);
  conflicts_ += counts.version_conflicts - server.counts.version_conflicts;
  if (counts.version_conflicts != server.counts.version_conflicts)
    violate("duplicated", tick,
            fmt::format("a body arrived at r{} that it hosts already", from.self().value));
  server.counts = counts;
  server.hosted.assign(now_hosted.begin(), now_hosted.end());
  return departures;
}

void OwnershipOracle::left_at_birth(BodyId id, const SimulatedServer& server, Tick tick) {
  Record& record = bodies_[id];
  record.born = record.missing_since = tick;
  record.last_owner = server.self();
  record.last_incarnation = server.incarnation();
  missing_.insert(id);
}

void OwnershipOracle::gained(BodyId id, const SimulatedServer& server, Tick tick) {
  const auto [it, fresh] = bodies_.try_emplace(id);
  Record& record = it->second;
  const RegionId self = server.self();
  const bool name_again =
      record.removed && (id.kind() == BodyId::Kind::avatar || id.kind() == BodyId::Kind::thrown);
  if (fresh || name_again) {
    record = {};
    record.born = tick;
  } else if (record.removed && !record.may_return) {
    ++duplicated_;
    violate("duplicated", tick,
            fmt::format("{} is simulated by r{} although r{} removed it at tick {}", describe(id),
                        self.value, record.removed_by.value, record.removed_at.value));
  } else if (record.owner && *record.owner != self) {
    ++duplicated_;
    violate("duplicated", tick,
            fmt::format("{} is simulated by r{} and by r{}", describe(id), record.owner->value,
                        self.value));
  }
  const bool changed = !fresh && !name_again && record.last_owner != self;
  if (changed) {
    ++migrations_;
    const bool owner_died =
        servers_[record.last_owner.value].incarnation != record.last_incarnation;
    const bool recovery =
        owner_died || server.is_recovering() ||
        (server.incarnation().value > 1 && tick - servers_[self.value].started < recovery_ticks);
    const std::uint64_t changes = recovery ? 0 : changes_.add({id, tick, record.last_owner, self});
    if (changes == changes_per_s_max + 1 && forced_from_.contains(record.last_owner))
      ++forced_;
    else if (changes > changes_per_s_max)
      violate("thrash", tick,
              fmt::format("{} changed its owner {} times within a second, now from r{} to r{}",
                          describe(id), changes, record.last_owner.value, self.value));
  }
  record.removed = record.lost = record.may_vanish = false;
  record.owner = record.last_owner = self;
  record.last_incarnation = server.incarnation();
  missing_.erase(id);
}

/// Whether the server hosts anything near the body that has changed its owner as often as it may,
/// and has not come along with it.
bool OwnershipOracle::meets_settled(BodyId id, RegionId from, const SimulatedServer& server,
                                    Tick tick) const {
  const PhysicsWorld& physics = server.core().physics();
  const WorldPosition at = physics.position(id);
  const auto came_along = [&](BodyId other) {
    const auto came = coming_.find(other);
    return came != coming_.end() && came->second == from;
  };
  const auto ids = physics.ids();
  return std::any_of(ids.begin(), ids.end(), [&](BodyId other) {
    // Who comes in this step has not been counted yet.
    const std::uint64_t may_have = changes_per_s_max - (coming_.contains(other) ? 1 : 0);
    return changes_.recent(other, tick) >= may_have && !came_along(other) &&
           distance(physics.position(other), at) <= meeting_m;
  });
}

void OwnershipOracle::crashed(RegionId region, Tick tick) {
  servers_[region.value].hosted.clear();
  for (auto& [id, record] : bodies_) {
    if (record.removed && record.removed_by == region && tick - record.removed_at <= rollback_ticks)
      record.may_return = true;
    const bool hosted = record.owner == region;
    // Handed over, and nobody has been seen to have it: the message may have died with its journal.
    const bool on_its_way = !record.owner && !record.removed && record.last_owner == region &&
                            record.last_incarnation == servers_[region.value].incarnation;
    if (!hosted && !on_its_way) continue;
    record.owner.reset();
    record.missing_since = tick;
    record.may_vanish = tick - record.born <= rollback_ticks;
    missing_.insert(id);
  }
}

bool OwnershipOracle::in_a_journal(BodyId id, std::span<const SimulatedServer> servers) const {
  for (const SimulatedServer& server : servers) {
    if (!server.runs()) continue;
    for (std::uint16_t other = 0; other < servers.size(); ++other) {
      if (other == server.self().value) continue;
      for (const auto& entry : server.core().journal(RegionId{other}).unacknowledged()) {
        if (entry.type != FrameType::handoff) continue;
        const auto group =
            decode_handoff(entry.payload, world_.prototypes.size(), world_.statics.size());
        if (!group) continue;
        for (const auto& b : group->bodies)
          if (b.body.id == id) return true;
      }
    }
  }
  return false;
}

void OwnershipOracle::look(Tick tick, std::span<const SimulatedServer> servers, bool all_run) {
  for (BodyId id : missing_) {
    Record& record = bodies_.at(id);
    if (!all_run) record.missing_since = tick;
    if (record.lost || record.may_vanish || tick - record.missing_since <= missing_ticks_max)
      continue;
    if (in_a_journal(id, servers))
      record.missing_since = tick;
    else
      lose(id, record, tick, "has been nowhere for 5 s");
  }
}

void OwnershipOracle::lose(BodyId id, Record& record, Tick tick, const std::string& how) {
  if (record.lost) return;
  record.lost = true;
  ++lost_;
  violate("lost", tick,
          fmt::format("{} {}; r{} had it last, until tick {}", describe(id), how,
                      record.last_owner.value, record.missing_since.value));
}

void OwnershipOracle::at_end(Tick tick, std::span<const SimulatedServer> servers, bool in_flow) {
  for (BodyId id : std::set<BodyId>(missing_)) {
    Record& record = bodies_.at(id);
    const bool handed_over = in_a_journal(id, servers);
    const bool flies = handed_over && tick - record.missing_since <= WorldView::flight_ticks_max;
    if (in_flow && flies) continue;
    if (record.may_vanish)
      ++rolled_back_;
    else
      lose(id, record, tick,
           handed_over ? "is in a journal at the end, and simulated by nobody"
                       : "is nowhere at the end");
  }
  const auto never_born = [&](BodyId id) {
    if (bodies_.contains(id)) return;
    ++lost_;
    violate("lost", tick, fmt::format("{} never came into the world", describe(id)));
  };
  for (std::uint32_t n = 0; n < world_.bodies.size(); ++n) never_born(BodyId::world(n));
  for (std::uint16_t i = 0; i < world_.injectors.size(); ++i) {
    const std::uint64_t count = injected_count(world_.injectors[i], tick);
    for (std::uint64_t n = 0; n < count; ++n) never_born(BodyId::injected(i, n));
  }
}

std::optional<Tick> OwnershipOracle::born(BodyId id) const {
  const auto it = bodies_.find(id);
  return it == bodies_.end() ? std::nullopt : std::optional(it->second.born);
}

void OwnershipOracle::violate(const std::string& rule, Tick tick, std::string what) {
  if (told_[rule]++ < told_max) violations_.push_back({rule, tick.value, std::move(what)});
}

void OwnershipOracle::report(SeedResult& result) const {
  result.bodies_spawned = bodies_.size();
  result.bodies_lost = lost_;
  result.bodies_duplicated = duplicated_;
  result.bodies_rolled_back = rolled_back_;
  result.migrations = migrations_;
  result.migrations_per_body_max_per_s = changes_.max();
  result.forced_changes = forced_;
  result.version_conflicts = conflicts_;
  result.largest_cluster = largest_;
  result.violations.insert(result.violations.end(), violations_.begin(), violations_.end());
}

}  // namespace aureole
