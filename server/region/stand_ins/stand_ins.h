// Resting bodies of other servers as walls that do not move: who they are, and until when.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/aura/migration_policy.h"
#include "server/base/ids.h"
#include "server/base/tick.h"
#include "server/physics/physics_world.h"
#include "server/region/auras/aura_exchange.h"
#include "server/region/stand_ins/whereabouts.h"

namespace aureole {

/// Keeps the physics world's stand-ins in step with what other servers say of their resting bodies.
/// Between the word of one owner and that of the next (a body that is handed over) a stand-in stays
/// for `grace_ticks`; while its owner cannot be heard at all it stays for good, so that a heap does
/// not fall because a server died.
///
/// Around a corner every server hears of what rests along every boundary. What none of ours is near
/// to does not stand: it would be put up for nothing, and stretch Bullet's tree of what moves.
class StandIns {
 public:
  /// \param nowhere  of a world in which none of ours is yet; none: all stand, wherever ours are
  StandIns(PhysicsWorld& physics, std::optional<Whereabouts> nowhere)
      : physics_(physics), ours_(std::move(nowhere)) {}

  /// Where bodies of ours are, or will be in a moment; what is near them is put up. To be told of
  /// all that are awake after a step, and of whoever comes.
  void note_ours(std::span<const NewBody> bodies);
  /// Looks at all that are hosted here; what none of them is near to any more is put away.
  void look_around();

  /// Bodies that we handed over and that Hosting left in place as stand-ins.
  void left(std::span<const BodyId> ids, RegionId to, Tick now);
  /// Stand-ins that came with a group, as walls for it to lean on.
  void came_along(std::span<const NewBody> bodies, RegionId from, Tick now);
  /// Bodies that are hosted here from now on.
  void arrived(std::span<const BodyId> ids);
  /// What others said, in order.
  void take(std::span<const RestingNews> news, Tick now);
  /// Takes down those whose bodies are moving away, by the auras that are projected now, and those
  /// that nobody vouches for any more; wakes what leant on them.
  void tidy(std::span<const RemoteAura> remote, Tick now);

  /// Those that stand.
  std::size_t size() const { return entries_.size() - away_.size(); }

  /// A body that sleeps this deep inside a new stand-in wakes and is pushed out (m): another came
  /// to lie there while its server was down. Heaps that are cut are in each other by centimetres.
  static constexpr float overlap_wakes_m = 0.1f;
  /// About a second of flights; more than any two owners need to hand a body over.
  static constexpr std::int64_t grace_ticks = 32;

 private:
  struct Entry {
    RegionId sponsor;
    bool vouched = false;  ///< Its owner said that it rests, and has not taken it back.
    Tick since;            ///< When the present state of `vouched` began.
  };
  void put(const NewBody& body, const Entry& entry);
  void put_up_what_is_near();
  bool is_near_ours(const NewBody& body) const {
    return !ours_ || ours_->is_near(body.state.position);
  }
  /// A stand-in that has become a body (born or claimed here under that name) is one no more.
  void forget_bodies();

  /// `entries_`, `unvouched_` and `away_` change together: here and in forget_bodies().
  void note(BodyId id, const Entry& entry);
  void drop(BodyId id);
  void take_down(std::span<const BodyId> ids);

  PhysicsWorld& physics_;
  std::map<BodyId, Entry> entries_;
  /// Those of `entries_`, and since when; most of a heap that rests is vouched for.
  std::map<BodyId, Tick> unvouched_;
  Tick unvouched_from_;  ///< Nobody has been for longer than since then.
  /// Those of `entries_` that do not stand.
  std::map<BodyId, NewBody> away_;
  std::optional<Whereabouts> ours_;
};

}  // namespace aureole
