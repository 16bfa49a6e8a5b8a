// The newest state of every body in the world, gathered from all regions, and where it is at any
// moment.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "protocol/frame.h"
#include "protocol/quantise.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/tick.h"
#include "server/base/world_position.h"
#include "server/physics/body.h"
#include "server/replica/pose_history.h"
#include "server/replica/slot_table.h"
#include "server/replica/tombstones.h"

namespace aureole {

namespace wire {
struct ReplicaKey;
struct ReplicaMotion;
struct PlayerStatus;
}  // namespace wire

/// A body as it is drawn: poses lie on the world-wide quantisation grid, whichever way they came.
struct ReplicaPose {
  BodyId id;
  PrototypeId prototype;
  RegionId owner;
  bool asleep = false;
  WorldPosition position;
  Eigen::Quaternionf orientation{Eigen::Quaternionf::Identity()};
};

/// What a region says of a player whose avatar it owns.
struct ReplicaPlayer {
  PlayerId player;
  RegionId owner;
  std::uint32_t session = 0;
  std::uint32_t applied_sequence = 0;
  bool connected = false;
  BodyId carried;
};

/// How many bodies of the store a region owns; it may be down.
struct OwnerCounts {
  std::size_t bodies = 0;
  std::size_t awake = 0;
};

/// More bodies than this are refused: no world is that large, so somebody makes names up.
inline constexpr std::size_t replica_bodies_max = 200'000;

/// Pure: no clock, no sockets. Versions decide: a state with a lower version than the one held is
/// never taken, so the order in which regions are heard does not matter. A body leaves the store
/// only when a region says that it was removed on purpose, with at least the version held,
/// or when its owner, linked anew, has told its whole state without it.
class ReplicaStore {
 public:
  explicit ReplicaStore(std::size_t prototype_count) : prototype_count_(prototype_count) {}

  /// Takes in a replica_update payload of `from`. An Error (not a ReplicaUpdate, unknown prototype
  /// or slot, a version of another region, a tick that goes back, numbers that are not finite or
  /// out of range, `from` not up) means that the link must be closed; what came before the fault
  /// may have been taken.
  Status apply(RegionId from, std::span<const std::byte> payload);
  /// A (new) subscription begins: slots of `from` mean nothing any more, it is not complete.
  void region_up(RegionId from);
  /// Nothing more will come from it; its bodies stay where they were last.
  void region_down(RegionId from);
  /// True once `from` has sent its whole state since region_up.
  bool is_complete(RegionId from) const;
  /// Newest tick heard of `from`, if any since region_up.
  std::optional<Tick> newest_tick(RegionId from) const;

  /// All bodies at world time `world_us`, ascending by id: interpolated between the two states
  /// around that moment, the newest one if it is later than all (never extrapolated). A body that
  /// lay still stays there until one tick before its next state.
  void sample(std::int64_t world_us, std::vector<ReplicaPose>& out) const;
  std::optional<ReplicaPose> sample_body(BodyId id, std::int64_t world_us) const;

  /// Newest exact state (from key states), for recovery and tests.
  struct KeyState {
    Version version;
    Tick tick;
    PrototypeId prototype;
    BodyState state;
  };
  std::optional<KeyState> key_state(BodyId id) const;
  /// The newest states of all bodies, ascending: exact where the newest word was a key state, else
  /// the newest pose with the velocity between the last poses.
  std::vector<std::pair<BodyId, KeyState>> newest_states() const;
  const Tombstones& tombstones() const { return tombstones_; }
  /// Of all players whose avatars are in the store, ascending.
  std::vector<ReplicaPlayer> players() const;
  /// Newest tick ever heard of `from`, over whichever link.
  std::optional<Tick> last_heard(RegionId from) const;
  std::optional<Version> version(BodyId id) const;

  std::size_t size() const;
  std::size_t awake_count() const;
  OwnerCounts owner_counts(RegionId owner) const;
  /// Only while the avatar is in the store, and only as told by the region that owns the avatar.
  std::optional<ReplicaPlayer> player(PlayerId id) const;

 private:
  struct Body {
    PoseHistory history;
    BodyId id;
    std::uint64_t stamp = 0;  ///< Slots that were bound under another stamp mean somebody else.
    KeyState key;
    std::uint64_t link = 0;  ///< Of its owner, over which it was told last.
    bool asleep = false;
  };
  struct Region {
    bool up = false;
    bool complete = false;
    std::uint64_t link = 0;        ///< Tells this subscription from earlier ones.
    std::optional<Tick> newest;    ///< Of this subscription.
    std::optional<Tick> previous;  ///< The update before that.
    std::optional<Tick> heard;     ///< Of this and earlier subscriptions.
    SlotTable slots;
    OwnerCounts counts;
  };
  struct Place {
    BodyId id;
    std::uint32_t body = 0;
  };

  Status take(RegionId from, std::span<const std::byte> payload);
  void drop(BodyId id, std::uint32_t place);
  void drop_untold(RegionId from, const Region& region);
  Status take_key(const wire::ReplicaKey& key, RegionId from, Region& region);
  Status take_motion(const wire::ReplicaMotion& motion, Region& region);
  void take_removed(BodyId id, const Version& version);
  void take_player(const wire::PlayerStatus& status, RegionId from);
  void move(Body& body, const Region& region, const GridPose& pose, bool same_owner);
  std::uint32_t add_body(BodyId id);
  void set_owner(Body& body, const Version& version);
  void set_asleep(Body& body, bool asleep);
  void count(const Body& body, std::ptrdiff_t change);
  void tidy();
  const Body* find(BodyId id) const;
  ReplicaPose pose_of(const Body& body, std::int64_t world_us) const;

  std::size_t prototype_count_;
  std::map<RegionId, Region> regions_;
  std::vector<Body> bodies_;  ///< A pool: places of removed bodies are used again.
  std::vector<std::uint32_t> free_;
  std::vector<std::uint32_t> freed_;  ///< By the update in work; tidy() makes them free.
  std::unordered_map<BodyId, std::uint32_t> index_;
  std::vector<Place> order_;  ///< Ascending by id, but for the last `added_` ones until tidy().
  std::size_t added_ = 0;
  std::uint64_t last_stamp_ = 0;
  std::uint64_t last_link_ = 0;
  Tombstones tombstones_;
  std::unordered_map<PlayerId, ReplicaPlayer> players_;
};

}  // namespace aureole
