// One Bullet world behind plain data: bodies in and out, contacts with their impulses, one step,
// queries.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/base/ids.h"
#include "server/base/prefetch.h"
#include "server/physics/body.h"

namespace aureole {

struct PhysicsSettings {
  Eigen::Vector3f gravity{0, -9.81f, 0};  ///< m/s²
  int solver_iterations = 10;             ///< 1 … 50
  float sleep_linear_speed = 0.25f;       ///< m/s; Bullet's 0.8 freezes a box that still slides.
  float sleep_angular_speed = 0.35f;      ///< rad/s
  float sleep_after_s = 0.4f;             ///< s, the paper's (section 4.2)
  WorldPosition origin;                   ///< Where the floats of this world are centred.
};

struct RayHit {
  ContactPartner what;  ///< A body, a stand-in or static geometry.
  WorldPosition point;
  Eigen::Vector3f normal;
  float fraction;  ///< 0 … 1 of the ray
};

/// What the last step had to deal with, for metrics.
struct PhysicsStatistics {
  std::size_t pairs = 0;      ///< Overlapping boxes in the broadphase.
  std::size_t manifolds = 0;  ///< Contact manifolds, empty ones included.
  std::size_t islands = 0;    ///< Groups of bodies that were solved together and are awake.
};

struct BulletBody;
class BulletWorld;

/// A body as a pass over many sees it; valid within that pass. See PhysicsWorld::for_each.
class BodyGlance {
 public:
  BodyGlance(const BulletWorld& world, const BulletBody& body) : world_(world), body_(body) {}
  BodyId id() const;
  /// A small number that is the body's own for as long as it is in this world.
  std::uint32_t slot() const;
  PrototypeId prototype() const;
  bool is_asleep() const;
  /// For how long it has been slower than PhysicsSettings' sleep speeds (s); for one that sleeps it
  /// does not matter.
  float slow_for_s() const;
  WorldPosition position() const;
  Eigen::Vector3f linear_velocity() const;   ///< m/s
  Eigen::Vector3f angular_velocity() const;  ///< rad/s
  BodyState state() const;
  Eigen::Vector3f half_extents() const;  ///< See PhysicsWorld::half_extents().

 private:
  const BulletWorld& world_;
  const BulletBody& body_;
};

/// Whether those who touched what leaves or changes are woken.
enum class Wake : std::uint8_t { touching, nobody };

/// Besides bodies a world may hold *stand-ins*: immovable copies of resting bodies that another
/// server owns, on which bodies can lean. A stand-in is no body: ids(), size(), contains(), the
/// state hash and everything else here that speaks of bodies leaves it out unless it says so.
///
/// Everything inside one world is repeatable: the same calls in the same order give the same bits.
/// Bullet keeps process-wide state: use all worlds of a process from one thread at a time.
/// Ids that are unknown, doubled or already present are programmers' mistakes (AUREOLE_CHECK).
class PhysicsWorld {
 public:
  /// `prototypes` and `statics` must outlive the world; ids are indices into them. Pools for
  /// `expected_bodies` are allocated once (a scratch world wants few).
  PhysicsWorld(const PhysicsSettings& settings, std::span<const BodyDefinition> prototypes,
               std::span<const StaticDefinition> statics, std::size_t expected_bodies = 8192);
  ~PhysicsWorld();
  PhysicsWorld(PhysicsWorld&&) noexcept;
  PhysicsWorld& operator=(PhysicsWorld&&) noexcept;

  /// An empty world with this one's settings, prototypes and statics that shares its shapes: cheap
  /// enough for one handoff. Must not outlive this world; moving either of them is fine.
  PhysicsWorld scratch(std::size_t expected_bodies = 64) const;

  /// Adds bodies in the order of their ids, whatever their order in `bodies`. The states must be
  /// sane. An upright body's angular velocity becomes zero. A stand-in of the same id becomes the
  /// body, and nobody is woken; if none of its points is more than a millimetre from where the body
  /// comes, the contacts that others have with it are kept with their impulses.
  void add(std::span<const NewBody> bodies);
  /// Looks at the pairs of bodies that came asleep, which a step would not do before they wake:
  /// find_touching() then knows what they touch.
  void find_contacts(std::span<const BodyId> sleepers);
  /// Removes bodies with their pairs in one pass.
  void remove(std::span<const BodyId> ids, Wake wake = Wake::touching);

  /// Puts immovable copies where `bodies` says; one that is here already is moved there. Their
  /// velocities and activation do not matter: a stand-in stands still and sleeps. Nobody is woken.
  /// They collide with bodies only, not with static geometry, obstacles or each other. Contacts
  /// with bodies exist at once, without impulses; install_contacts() brings those.
  void add_stand_ins(std::span<const NewBody> bodies);
  void remove_stand_ins(std::span<const BodyId> ids, Wake wake);
  /// Bodies of this world stand still from now on, where they are, with the contacts (impulses
  /// included) that they have with those that stay bodies. Nobody is woken.
  void turn_into_stand_ins(std::span<const BodyId> ids);
  /// Ascending. Valid until the next call that adds or removes stand-ins or bodies.
  std::span<const BodyId> stand_in_ids() const;
  bool is_stand_in(BodyId id) const;
  /// Its prototype and pose, asleep and without velocity.
  NewBody stand_in(BodyId id) const;
  /// Appends what presses on stand-ins after the last step, for each stand-in and each *awake* body
  /// that share contact points; what is appended is sorted by (stand_in, body).
  void stand_in_loads(std::vector<StandInLoad>& out) const;

  /// Gives pairs of bodies, stand-ins and static geometry the contacts they had in the world they
  /// come from, sleeping or not, instead of those they have. Call after add(); a pair that no
  /// longer overlaps, that is not all here or that nothing can move is skipped. Contacts from
  /// outside must have passed is_sane().
  void install_contacts(std::span<const ContactManifold> contacts);
  /// Contacts among the bodies of `group` and between them and static geometry; sorted by (a, b,
  /// ordinal), a being the smaller id whichever world they come from.
  std::vector<ContactManifold> contacts_within(std::span<const BodyId> group) const;
  /// The same and those between `group` and bodies or stand-ins outside it; if the one outside has
  /// the smaller id, it is a. `group` may name stand-ins.
  /// `beside_others`, if given, becomes those of the group, ascending, that are beside a body
  /// outside of it, whether they touch or not: in the last step Bullet's boxes overlapped, which
  /// are 2 cm larger than what is in them.
  std::vector<ContactManifold> contacts_around(std::span<const BodyId> group,
                                               std::vector<BodyId>* beside_others = nullptr) const;
  /// Bodies and stand-ins that share at least one contact point with `id` (a body or a stand-in);
  /// sorted. For one question; who asks about many takes find_touching().
  std::vector<BodyId> touching(BodyId id) const;
  /// Replaces `found` by the slots (BodyGlance::slot()) of the bodies, awake or asleep, that share
  /// at least one contact point with the one in `slot`; ascending. Returns how many it touches,
  /// stand-ins included, of which a compound may count more than once.
  std::size_t find_touching(std::uint32_t slot, std::vector<std::uint32_t>& found) const;
  /// Begins to bring nearer what find_touching() needs.
  void fetch_touching(std::uint32_t slot, FetchStep step) const;
  /// The body in a slot that is taken; all slots are below slots().
  BodyId body_in_slot(std::uint32_t slot) const;
  std::size_t slots() const;
  /// True if something carries the body: a contact whose normal points up by more than `min_up`.
  bool is_supported(BodyId id, float min_up = 0.6f) const;

  /// Steps by dt_s (unit: s, > 0) without sub-steps.
  void step(float dt_s);

  bool contains(BodyId id) const;
  std::size_t size() const;
  std::size_t awake_count() const;
  /// All bodies that are awake, as they are, ascending by id. After a step it costs nothing to ask,
  /// however many sleep. Valid until the next call that adds, removes or changes anything.
  std::span<const NewBody> awake() const;
  /// All bodies, ascending. Valid until the next add or remove.
  std::span<const BodyId> ids() const;
  /// One look at each body in the order of their ids, without a search for any; `visit` changes
  /// nothing in this world.
  void for_each(const std::function<void(const BodyGlance&)>& visit) const;
  /// One look at the n-th of awake(), while its answer is valid, or at a body by its id.
  BodyGlance awake_glance(std::size_t n) const;
  BodyGlance glance(BodyId id) const;
  PrototypeId prototype(BodyId id) const;
  BodyState state(BodyId id) const;
  WorldPosition position(BodyId id) const;
  bool is_asleep(BodyId id) const;
  /// Half edges of the axis-aligned box around the body as it stands (m).
  Eigen::Vector3f half_extents(BodyId id) const;

  /// Overwrites pose, velocities and activation; wakes what touched the body if the pose changes. A
  /// body that sleeps is not moved without being woken: others remember where it lies.
  void set_state(BodyId id, const BodyState& state);
  /// Velocity change at the centre of mass (unit: N s); wakes the body.
  void apply_impulse(BodyId id, const Eigen::Vector3f& impulse);
  /// Sets velocities (m/s, rad/s) and wakes the body.
  void set_velocity(BodyId id, const Eigen::Vector3f& linear, const Eigen::Vector3f& angular);
  /// Force for the next step (unit: N); wakes the body.
  void apply_force(BodyId id, const Eigen::Vector3f& force);
  void wake(BodyId id);
  /// Wakes bodies that a contact has deeper inside one of these stand-ins than `deeper_than_m`.
  void wake_what_is_inside(std::span<const BodyId> stand_ins, float deeper_than_m);

  /// Nearest hit on a body, a stand-in or static geometry, `ignore` left out (a body or a
  /// stand-in). A plane is met from above only.
  std::optional<RayHit> raycast(const WorldPosition& from, const WorldPosition& to,
                                std::optional<BodyId> ignore = {}) const;
  /// Bodies whose bounding box touches the sphere; sorted.
  std::vector<BodyId> overlapping_sphere(const WorldPosition& centre, float radius) const;

  /// A body that nothing moves, as an obstacle: infinite mass, driven along `state`'s velocity.
  /// For the scratch world that makes up time in flight. Slower than the sleeping speeds, it wakes
  /// nobody; it does not collide with static geometry or with other obstacles.
  void add_obstacle(const NewBody& body);

  /// Over all ids and states, bit for bit.
  std::uint64_t state_hash() const;

  PhysicsStatistics statistics() const;

 private:
  struct Impl;
  explicit PhysicsWorld(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// True if every number is finite and the orientation has unit length within 1e-3: the check that
/// each state from a socket passes before it reaches Bullet.
bool is_sane(const BodyState& state);
/// True if there are 1 to 4 points of finite numbers with normals of unit length and impulses ≥ 0.
bool is_sane(const ContactManifold& manifold);

}  // namespace aureole
