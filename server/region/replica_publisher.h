// What gateways hear of a region's bodies: full states when something changes, 18 bytes while they
// move.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "protocol/frame.h"
#include "protocol/frame_pool.h"
#include "protocol/quantise.h"
#include "protocol/wire.h"
#include "server/base/ids.h"
#include "server/base/tick.h"
#include "server/physics/physics_world.h"
#include "server/region/players/avatar.h"

namespace aureole {

/// A full state with its version, as it goes into a key.
struct VersionedBody {
  NewBody body;
  Version version;
};

struct RemovedBody {
  BodyId id;
  Version version;
};

/// One stream for all gateways; a gateway that joins is first sent the whole state. Bodies that
/// do not leave their grid cell cost no bytes; those that sleep cost no time either.
class ReplicaPublisher {
 public:
  /// Every moving body's full state is sent once in this many ticks, so that stores can be
  /// recovered from; staggered by slot.
  static constexpr std::int64_t key_interval_ticks = 64;
  static constexpr std::size_t keys_per_frame = 4096;
  /// 104 bytes each; the motions of a whole world and its removals still fit beside them.
  static constexpr std::size_t keys_per_update = 32'768;

  void body_gained(BodyId id, Version version);
  void body_lost(BodyId id);
  void body_removed(BodyId id, Version version);

  /// The update of tick `now` for gateways that already have the whole state.
  SharedBytes update(Tick now, const PhysicsWorld& world, std::span<const Avatar* const> avatars);
  /// Frames that bring a new gateway to the state of tick `now`; `passive` are copies of bodies in
  /// flight. Call after update() of the same tick.
  std::vector<SharedBytes> whole_state(Tick now, const PhysicsWorld& world,
                                       std::span<const VersionedBody> passive,
                                       std::span<const Avatar* const> avatars);

  /// Slots in use (tests, metrics).
  std::size_t size() const { return slots_.size(); }

 private:
  /// A body that gateways take for awake, and the pose they have of it. Small: every one of them is
  /// fetched anew in every step.
  struct Followed {
    BodyId id;
    std::uint32_t slot;
    bool lost;  ///< It is here no longer, or under another slot.
    QuantisedPose pose;
  };
  std::uint32_t take_slot();
  struct Round;  ///< One update in work.
  void keep_next(Round& round);
  void look_at_sleepers(Round& round, BodyId before);
  void quantise_awake(std::span<const NewBody> awake);
  std::size_t follow_from(Round& round, std::span<const NewBody> awake, std::size_t first);
  void greet(Round& round, const NewBody& body, const QuantisedPose& pose);
  bool send_key(Round& round, const NewBody& body, std::uint32_t slot) const;
  bool send_key(Round& round, BodyId id, std::uint32_t slot) const;

  std::unordered_map<BodyId, std::uint32_t> slots_;
  std::vector<Version> versions_;  ///< By slot.
  // Walked side by side with the bodies that are awake: all three ascend, and what sleeps and is
  // known to sleep is in none of them.
  std::vector<Followed> followed_;
  std::vector<BodyId> due_;  ///< Never told of, except while they wait for room in an update.

  std::vector<std::uint32_t> free_slots_;
  std::uint32_t next_slot_ = 0;
  std::vector<RemovedBody> removed_;
  struct PlayerSent {
    std::uint32_t session, applied_sequence;
    bool connected;
    BodyId carried;
    friend bool operator==(const PlayerSent&, const PlayerSent&) = default;
  };
  std::unordered_map<PlayerId, PlayerSent> players_;
  // Kept from update to update for their memory.
  std::vector<QuantisedPose> poses_;  ///< Of those who are awake.
  std::vector<wire::ReplicaKey> keys_;
  std::vector<wire::ReplicaMotion> motions_;  ///< One more than there can be.
  std::vector<Followed> woken_;               ///< To be followed from now on; ascending.
  std::vector<BodyId> still_due_;
  FramePool frames_{4};
  flatbuffers::FlatBufferBuilder builder_;
};

}  // namespace aureole
