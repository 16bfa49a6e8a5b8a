// What changes its server and why: one small interface, one implementation for each mode.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/aura/audience.h"
#include "server/aura/migration_mode.h"
#include "server/aura/partition/partition_map.h"
#include "server/aura/precedence.h"
#include "server/aura/shapes/aura_box.h"
#include "server/aura/shapes/aura_capsule.h"
#include "server/aura/shapes/aura_radius.h"
#include "server/base/ids.h"
#include "server/base/prefetch.h"
#include "server/base/tick.h"
#include "server/base/world_position.h"

namespace aureole {

/// Longest that `HostedBody::still_ticks` counts; it travels in a byte.
inline constexpr std::uint8_t still_ticks_max = 255;
/// Slower than this a body is still (m/s); see HostedBody::motion_speed_mps.
inline constexpr double still_speed_mps = 0.15;
/// A body that has been still for so long rests, asleep or not: 0.4 s, the paper's (section 4.2).
inline constexpr std::uint8_t resting_ticks = 25;

/// What a policy knows of each body that its server hosts.
struct HostedBody {
  BodyId id;
  std::uint32_t slot = 0;  ///< Names it to ContactSource for as long as it is hosted here.
  WorldPosition position;
  Eigen::Vector3d half_extents{0, 0, 0};  ///< Of the box around the body as it stands (m).
  double bounding_radius_m = 0;           ///< R_o
  /// What is less than `girth_m` from the segment `position` ± `half_spine` holds the body (m).
  Eigen::Vector3d half_spine{0, 0, 0};
  double girth_m = 0;
  Eigen::Vector3d velocity_mps{0, 0, 0};  ///< Of its centre.
  double motion_speed_mps = 0;            ///< See motion_speed() of physics.
  bool round = false;                     ///< A sphere: it rolls where it is going.
  /// Air between it and the plane below, if that is within what it can reach in flight (m).
  double ground_gap_m = std::numeric_limits<double>::infinity();
  double lowest_m = 0;         ///< Its centre can be no lower over that plane (m).
  bool near_geometry = false;  ///< So is other immovable geometry.
  double mass_kg = 1;
  double restitution = 0;  ///< 0 … 1
  bool asleep = false;
  /// For how many ticks it has been slower than still_speed_mps, at most still_ticks_max. Bullet
  /// wakes a whole heap when one body of it is touched; that alone makes nothing move.
  std::uint8_t still_ticks = 0;
  /// A load of its contacts with stand-ins has risen: it counts as moving whatever its speed.
  bool pressed = false;
  /// What a player may do next with it or from it, which no motion foretells: something of
  /// `deed_mass_kg` may start here at `deed_speed_mps`. 0: nothing.
  double deed_speed_mps = 0;
  double deed_mass_kg = 0;
  /// The body that this one must be hosted with (a carried thing with the avatar); none: decides
  /// itself.
  BodyId leader;
  /// When it last changed its owner, and the time before that.
  Tick changed_owner;
  Tick changed_owner_before{-1'000'000};
  RegionId came_from{};   ///< Whose it was before; its present owner if it was born here.
  Tick came{-1'000'000};  ///< When it was looked at here for the first time.
};

/// Of a body whose aura overlaps others': who would go with it.
struct Company {
  /// The same for all bodies of a cluster, most likely not the same for others; 0: not known.
  std::uint16_t label = 0;
  /// Bodies in its cluster, as a power of two: from 2^n to 2^(n+1) - 1; at most size_class_max.
  std::uint8_t size_class = 0;
  static constexpr std::uint8_t size_class_max = 15;
  /// How often one of them has changed its owner within the last second: at most changes_max, and
  /// then it should not again.
  std::uint8_t changes = 0;
  static constexpr std::uint8_t changes_max = 2;
  bool crowded = false;  ///< It meets, or is near to, a third server.
  bool lately = false;   ///< One of them has come within the last round trip.

  /// How firmly it stays where it is: of two that meet the one that is held less comes to the
  /// other.
  enum class Hold : std::uint8_t { none, lately_come, changed_twice };
  Hold hold() const {
    return changes == changes_max ? Hold::changed_twice : lately ? Hold::lately_come : Hold::none;
  }
  friend bool operator==(const Company&, const Company&) = default;
};

/// An aura that another server projects to us.
struct RemoteAura {
  BodyId id;
  RegionId host;
  AuraCapsule room;  ///< In mode paper a sphere.
  bool asleep = false;
  /// It rests and expects no blow (adaptive).
  bool resting = false;
  bool left_its_place = false;  ///< It is not any more where its owner last said that it rests.
  double speed_mps = 0;         ///< The fastest that it may soon move (adaptive).
  double mass_kg = 1;
  Company company;  ///< (adaptive)
};

class Sleepers;

/// Who touches whom on this server: all bodies here, awake or not, by HostedBody::slot.
class ContactSource {
 public:
  virtual ~ContactSource() = default;
  /// Replaces `found` by the slots of the bodies that share a contact with the one in `slot`,
  /// ascending. Returns how many it touches, others' resting bodies included.
  virtual std::size_t find_touching(std::uint32_t slot,
                                    std::vector<std::uint32_t>& found) const = 0;
  /// All slots are below.
  virtual std::size_t slots() const = 0;
  /// For who asks about many: begins to bring nearer what find_touching() needs of the one in
  /// `slot`.
  virtual void fetch_touching(std::uint32_t /*slot*/, FetchStep) const {}
  virtual BodyId body_in(std::uint32_t slot) const = 0;
};

/// How much of its server's world a policy is shown.
class View {
 public:
  virtual ~View() = default;
  /// Whether every body is shown that stands anywhere above or below this box.
  virtual bool shows(const AuraBox& room) const = 0;
  /// Whether what stands at this place is shown.
  virtual bool holds(double x, double z) const = 0;
};

/// A server that decides for a pair asks the other one to hand a body over, with its cluster.
struct HandoverRequest {
  BodyId body;
  RegionId to;
  RegionId asker{};
  /// How firmly the asker knew the more firmly held of both sides to stay: it comes all the same.
  Company::Hold known = Company::Hold::changed_twice;
};

/// Everything that a decision may depend on; spans ascending by id, no body in both `hosted` and
/// `remote`. With `sleepers`, `hosted` has of the bodies that sleep only those with which something
/// is to happen (deeds, presses, who is carried); they are in both.
struct MigrationSituation {
  Tick now;
  RegionId self;
  const PartitionMap& map;
  std::span<const HostedBody> hosted;
  std::span<const RemoteAura> remote;
  std::span<const HandoverRequest> requested;
  /// Whether a region can be handed anything now; by region. While one is down, its boundary lets
  /// nobody through.
  const std::vector<bool>& linked;
  /// Who touches whom; null: nobody is asked (naive, paper, some tests).
  const ContactSource* contacts = nullptr;
  /// What `hosted` may lack, and where no sleepers are looked for; null: nothing. By name and by
  /// contact sleepers are found anywhere.
  const View* view = nullptr;
  /// All bodies that sleep here; null: they are in `hosted`.
  const Sleepers* sleepers = nullptr;
  /// How many bodies each server has awake, about, by region. Empty: nobody is compared.
  std::span<const double> awake{};
  /// (adaptive)
  Precedence order{};
  Precedence order_before{};  ///< As it was a second ago (long_stay_ticks).
  /// Others may have the lines of the map elsewhere by as much as this (m; adaptive).
  double map_margin_m = 0;
  bool asks_largest = false;  ///< MigrationDecision::largest_cluster is wanted.
};

/// Index of the body in `MigrationSituation::hosted`, if it is hosted here.
inline std::optional<std::uint32_t> index_of(std::span<const HostedBody> hosted, BodyId id) {
  const auto at = std::lower_bound(hosted.begin(), hosted.end(), id,
                                   [](const HostedBody& b, BodyId key) { return b.id < key; });
  if (at == hosted.end() || at->id != id) return {};
  return static_cast<std::uint32_t>(at - hosted.begin());
}

/// A group that goes to one server together.
struct Migration {
  RegionId to;
  std::vector<BodyId> bodies;  ///< ascending
};

/// Bodies that we ask another server to hand over to us, or to the server that ours go to.
struct Pull {
  RegionId from;
  RegionId to;
  std::vector<BodyId> bodies;  ///< ascending
  Company::Hold known = Company::Hold::changed_twice;  ///< As in HandoverRequest.
};

/// An aura that reaches beyond our region, and whom it concerns.
struct ProjectedAura {
  BodyId id;
  AuraCapsule room;
  bool asleep = false;
  bool resting = false;  ///< See RemoteAura.
  double speed_mps = 0;  ///< See RemoteAura.
  Company company;       ///< See RemoteAura.
  RegionSet to;
};

struct MigrationDecision {
  /// What must go together may not all be shown. Nothing has been decided: whoever asks shows
  /// more, in the same tick, and asks again; everything at the latest.
  bool sees_too_little = false;
  /// Bodies in the largest cluster that is shown, if it was asked for (adaptive).
  std::size_t largest_cluster = 0;
  std::vector<Migration> leaving;        ///< Disjoint groups, ascending by destination.
  std::vector<Pull> pulls;               ///< Ascending by `from`, `to`, `known`.
  std::vector<ProjectedAura> projected;  ///< Ascending by id.

  /// Nothing has been decided yet; the memory stays.
  void clear() {
    sees_too_little = false;
    largest_cluster = 0;
    leaving.clear();
    pulls.clear();
    projected.clear();
  }
};

class MigrationPolicy {
 public:
  virtual ~MigrationPolicy() = default;
  /// Called after every step whose tick is a multiple of interval_ticks(), or the first one after
  /// such a tick was left out. What it returns holds until the next call.
  virtual const MigrationDecision& decide(const MigrationSituation& situation) = 0;
  virtual std::int64_t interval_ticks() const { return 1; }
  /// How far from the boundary, and from auras of others, a hosted body is of no interest (m): what
  /// is farther away need not be shown at first; see MigrationDecision::sees_too_little. Infinite:
  /// all are wanted.
  virtual double depth_m() const { return std::numeric_limits<double>::infinity(); }
  /// From the next decision on auras are sized by these.
  virtual void set_tolerances(const AuraTolerances&) {}
};

/// Section 3.1 of the paper: a body is handed over when its centre has crossed the boundary. Bodies
/// that cross in the same step to the same region travel as one group, so that a sleeping stack
/// goes whole. Against thrash a centre must be `naive_hysteresis_m` across, and a body stays at
/// least `stay_ticks` with each owner. Nothing is projected: bodies of two servers never meet.
std::unique_ptr<MigrationPolicy> make_naive_policy();

/// The published algorithms: spheres of one size, see paper_policy.cpp.
std::unique_ptr<MigrationPolicy> make_paper_policy(const AuraTolerances& tolerances);

/// What may soon touch and moves is brought together, what rests may be cut; see
/// adaptive_policy.cpp.
std::unique_ptr<MigrationPolicy> make_adaptive_policy(const AuraTolerances& tolerances);

std::unique_ptr<MigrationPolicy> make_policy(MigrationMode mode, const AuraTolerances& tolerances);

/// Far enough that a body resting on the line does not flicker; near enough not to be seen (m).
inline constexpr double naive_hysteresis_m = 0.05;
/// How far a cluster's nearest member must be outside its host's region before it goes home (m).
inline constexpr double home_hysteresis_m = 0.5;
/// How far outside its host's region a resting body must be before it goes home by itself (m).
inline constexpr double resting_hysteresis_m = 0.1;
/// Half a second: at most two changes of owner in any second.
inline constexpr std::int64_t stay_ticks = 32;
/// The same for whoever may be fetched back at any moment: a second and a bit, so that a body that
/// goes home, is fetched and goes home again has changed its owner twice in a second.
inline constexpr std::int64_t long_stay_ticks = 64;
/// When nothing moves any more anywhere near: all must be home a second after that.
inline constexpr std::int64_t calm_stay_ticks = 58;

}  // namespace aureole
