// Rules 1, 2 and 4: each body is simulated by one server, none is lost, none changes owner all the
// time.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "server/experiment/oracles/owner_changes.h"
#include "server/experiment/oracles/view/world_view.h"
#include "server/experiment/seed_result.h"
#include "server/experiment/simulated/simulated_server.h"

namespace aureole {

/// Keeps a ledger of every body from the differences between one step and the next of each server:
/// a body that a server hosts and did not before has come to it, and may be hosted by nobody else.
/// A body that is gone has left in a handoff, or was removed on purpose (the core's count says how
/// many), or is missing.
///
/// Missing bodies are not lost yet: they may be in a journal, in a group that waits, frozen in a
/// region that recovers, on a disk. They are lost if they are missing at the end of the run, or for
/// 5 s while every region runs and no journal holds them. A body that was born less than 100 ms
/// before its server was killed may be gone (nobody else had seen it, no snapshot holds it): that
/// is a rollback; likewise one that was removed just before may be back.
class OwnershipOracle {
 public:
  OwnershipOracle(const WorldDefinition& world, std::size_t regions);

  /// After each step. Returns what left in it.
  std::vector<Departure> stepped(const SimulatedServer& server, Tick tick);
  void crashed(RegionId region, Tick tick);
  /// Once a tick; `all_run`: no region is down or recovering.
  void look(Tick tick, std::span<const SimulatedServer> servers, bool all_run);
  /// `in_flow`: bodies still come into the world, so some may just be on their way in a handoff.
  void at_end(Tick tick, std::span<const SimulatedServer> servers, bool in_flow);

  void report(SeedResult& result) const;
  std::vector<Violation> violations() const { return violations_; }
  /// When it first came into the world.
  std::optional<Tick> born(BodyId id) const;
  /// Changes of owner at or after this tick.
  std::vector<OwnerChange> changes_since(Tick tick) const { return changes_.since(tick); }

  static constexpr std::uint64_t changes_per_s_max = 2;
  /// Where two clusters meet that have both changed their owners as often, one of them has to once
  /// more: that they are together comes first. It is counted (`forced_changes`) and no broken rule,
  /// if somebody of those who come together comes so near to such a one of others (m): twice as far
  /// as auras reach.
  static constexpr double meeting_m = 10;
  static constexpr std::int64_t missing_ticks_max = ticks_from_ms(5000);
  static constexpr std::int64_t rollback_ticks = ticks_from_ms(100) + 1;
  /// Changes of owner that a restarted region causes for so long are recovery.
  static constexpr std::int64_t recovery_ticks = ticks_from_ms(3000);

 private:
  struct Record {
    std::optional<RegionId> owner;
    RegionId last_owner;
    Incarnation last_incarnation;
    Tick born;
    Tick missing_since;
    bool removed = false, may_return = false, may_vanish = false, lost = false;
    RegionId removed_by;
    Tick removed_at;
  };
  struct Server {
    std::vector<BodyId> hosted;
    Incarnation incarnation;
    Tick started;
    Hosting::Counts counts;
    std::uint64_t conflicts = 0;
  };
  void left_at_birth(BodyId id, const SimulatedServer& server, Tick tick);
  void gained(BodyId id, const SimulatedServer& server, Tick tick);
  bool meets_settled(BodyId id, RegionId from, const SimulatedServer& server, Tick tick) const;
  bool in_a_journal(BodyId id, std::span<const SimulatedServer> servers) const;
  void lose(BodyId id, Record& record, Tick tick, const std::string& how);
  void violate(const std::string& rule, Tick tick, std::string what);

  const WorldDefinition& world_;
  std::vector<Server> servers_;
  std::map<BodyId, Record> bodies_;
  std::set<BodyId> missing_;
  std::map<BodyId, RegionId> coming_;  ///< Whose those were that come in this step.
  std::set<RegionId> forced_from_;     ///< Of these servers somebody meets such as have settled.
  std::vector<Violation> violations_;
  std::map<std::string, int> told_;
  OwnerChanges changes_;
  std::uint64_t duplicated_ = 0, lost_ = 0, rolled_back_ = 0, migrations_ = 0, conflicts_ = 0;
  std::uint64_t forced_ = 0;
  std::uint64_t largest_ = 0;
};

/// "world body 12", "injected body 3 of 0", "avatar 2", "thrown body 4 of player 1".
std::string describe(BodyId id);

}  // namespace aureole
