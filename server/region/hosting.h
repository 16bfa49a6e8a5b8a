// The bodies that this region simulates: their physics, their versions, and what gateways hear of
// them.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/aura/migration_policy.h"
#include "server/base/ids.h"
#include "server/base/tick.h"
#include "server/physics/physics_world.h"
#include "server/region/handoff/handoff.h"
#include "server/region/replica_publisher.h"
#include "server/worlds/world.h"

namespace aureole {

/// Every body that is here is in the physics world, has a version and is published, and nothing
/// else is: this class is the only one that adds and removes.
class Hosting {
 public:
  Hosting(const WorldDefinition& world, RegionId self, Incarnation incarnation);

  const PhysicsWorld& physics() const { return physics_; }
  PhysicsWorld& physics() { return physics_; }
  ReplicaPublisher& publisher() { return publisher_; }
  std::span<const BodyDefinition> definitions() const { return definitions_; }
  std::span<const StaticDefinition> statics() const { return statics_; }
  /// Radius of the bounding sphere of a prototype (m).
  float radius(PrototypeId prototype) const { return radii_[prototype.value]; }
  const Spine& spine(PrototypeId prototype) const { return spines_[prototype.value]; }

  bool hosts(BodyId id) const { return records_.contains(id); }
  std::uint32_t epoch(BodyId id) const { return records_.at(id).epoch; }
  Tick changed_owner(BodyId id) const { return records_.at(id).changed_owner; }
  Version version(BodyId id) const { return {epoch(id), incarnation_, self_}; }
  /// Call before each pass over bodies that are looked at; nobody may come or go during it.
  /// Returns who has come or gone since the last call, ascending, valid until the next.
  std::span<const BodyId> begin_look(Tick now);
  /// Call for each body that the pass will look at, before the first look() and in the same order;
  /// or for none of them. What is known of them is then fetched from far away all at once: after a
  /// physics step nothing of it is near any more.
  void expect(BodyId id);
  /// Call for each body that is looked at, in the order of their ids, with its id, surface speed
  /// and whether it sleeps: fills in for how many ticks it has been still and when its owner
  /// changed. Of one that was not looked at in the last such tick nothing is known but for how long
  /// it has been slow.
  void look(HostedBody& body, Tick now, float slow_for_s);
  /// Instead of look(), once, for one that has fallen asleep: until wake_up() it lies still.
  void lie_down(HostedBody& body);
  /// Of one that has been woken, after begin_look() and before look(); that alone does not make it
  /// move.
  void wake_up(BodyId id);
  std::uint8_t still_ticks(BodyId id, Tick now) const;
  bool lies_still(BodyId id, Tick now) const { return still_ticks(id, now) >= resting_ticks; }

  /// Bodies that come into the world here; those that are here already are left out. A name that is
  /// used again (a player who left comes back) starts in a later epoch than it ended, or stores
  /// would take the newcomer for the one that is gone.
  void spawn(std::span<const NewBody> bodies, std::uint32_t epoch = 1);
  /// Takes bodies out of the world on purpose.
  void remove(std::span<const BodyId> ids);

  /// Stops hosting the bodies and returns them with their contacts; avatars are the caller's
  /// matter. With `cut`, what rests on either side of the cut goes on holding the other up: members
  /// that lie still beside bodies that stay are left in place as stand-ins (`left_behind`), and
  /// the still bodies that they touch travel along as stand-ins.
  enum class Cut { nowhere, at_rest };
  struct Released {
    HandoffGroup group;
    std::vector<BodyId> left_behind;  ///< ascending
  };
  Released release(std::span<const BodyId> ids, Tick now, Cut cut);
  /// Hosts the group's bodies from now on, one epoch after its sender. Returns the ids taken:
  /// bodies that are held here already are counted as conflicts; of the two the later epoch stays.
  /// The group's stand-ins must have been put up before.
  std::vector<BodyId> accept(const HandoffGroup& group, RegionId from, Tick now);
  /// Hosts bodies that a recovery has claimed, under the very epochs that they come with. None may
  /// be here already.
  void claim(std::span<const HandoffGroup::Body> bodies, Tick now);
  /// What was removed on purpose since the last call.
  std::vector<RemovedBody> take_removed() { return std::exchange(removed_, {}); }

  struct Counts {
    std::uint64_t spawned = 0, removed = 0, migrations_in = 0, migrations_out = 0;
    std::uint64_t version_conflicts = 0;
    std::uint64_t recovered = 0;
  };
  const Counts& counts() const { return counts_; }
  std::uint64_t state_hash() const;

 private:
  static constexpr Tick born_now{std::numeric_limits<std::int64_t>::max()};
  struct Record {
    std::uint32_t epoch = 1;
    Tick changed_owner;
    std::optional<Tick> moved;  ///< When it was last seen to move.
    Tick changed_owner_before;  ///< The change before the last one.
    RegionId came_from;
    Tick came{-1'000'000};      ///< When it was looked at here for the first time.
    Tick looked_at = born_now;  ///< When it was last looked at; whoever comes is looked at.
    bool lies = false;          ///< It lay down, and no decision has been made since it woke.
  };
  struct Entry {
    BodyId id;
    Record* record;
  };
  static bool is_before(const Entry& entry, BodyId id) { return entry.id < id; }
  bool make_record(BodyId id, const Record& record);
  void erase_record(BodyId id);
  static void tell_history(const Record& record, HostedBody& body);
  void bring_in_order();
  const Entry& entry_in_order(BodyId id);
  Record& next_record(BodyId id);
  void find_contacts_of_sleepers(std::span<const NewBody> bodies);
  void bring_neighbours(HandoffGroup& group, Tick now) const;

  RegionId self_;
  Incarnation incarnation_;
  std::vector<BodyDefinition> definitions_;
  std::vector<StaticDefinition> statics_;
  std::vector<float> radii_;   ///< By prototype.
  std::vector<Spine> spines_;  ///< By prototype.
  PhysicsWorld physics_;
  ReplicaPublisher publisher_;
  std::unordered_map<BodyId, Record> records_;
  /// The same, ascending, for passes over all bodies: to search for each would cost more than
  /// everything else that is done with it.
  std::vector<Entry> in_order_;
  std::size_t next_ = 0;              ///< Where a pass has come to.
  std::vector<Entry> expected_;       ///< Who is going to be looked at in it, …
  std::size_t next_expected_ = 0;     ///< … and which of them comes next.
  std::vector<BodyId> out_of_order_;  ///< Came or went since.
  std::vector<BodyId> changed_;       ///< The same, as of the last look.
  Tick last_look_, look_before_;
  std::vector<RemovedBody> removed_;
  Counts counts_;
};

}  // namespace aureole
