// A region's decisions on who hosts what: what the policy is told, and what becomes of its answer.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <set>

#include "server/aura/adaptive/outlook/aura_size.h"
#include "server/aura/audience.h"
#include "server/base/leap.h"
#include "server/region/region_core.h"

namespace aureole {
namespace {

constexpr double everything_m = std::numeric_limits<double>::infinity();

/// What the policy may ask of contacts.
class Touching final : public ContactSource {
 public:
  explicit Touching(const PhysicsWorld& physics) : physics_(physics) {}
  std::size_t find_touching(std::uint32_t slot, std::vector<std::uint32_t>& found) const override {
    return physics_.find_touching(slot, found);
  }
  std::size_t slots() const override { return physics_.slots(); }
  void fetch_touching(std::uint32_t slot, FetchStep step) const override {
    physics_.fetch_touching(slot, step);
  }
  BodyId body_in(std::uint32_t slot) const override { return physics_.body_in_slot(slot); }

 private:
  const PhysicsWorld& physics_;
};

/// What the exchange tells of bodies.
class ProjectedBodies final : public AuraBodies {
 public:
  ProjectedBodies(const Hosting& hosting, const std::set<BodyId>& handed_over)
      : hosting_(hosting), handed_over_(handed_over) {}
  double mass_kg(BodyId id) const override {
    return double{hosting_.definitions()[hosting_.physics().prototype(id).value].mass_kg};
  }
  NewBody resting_body(BodyId id) const override {
    const BodyGlance seen = hosting_.physics().glance(id);
    return {id, seen.prototype(), seen.state()};
  }
  bool was_handed_over(BodyId id) const override { return handed_over_.contains(id); }

 private:
  const Hosting& hosting_;
  const std::set<BodyId>& handed_over_;
};

}  // namespace

bool RegionCore::nothing_stirs(Tick now) const {
  // What is going to happen to bodies that sleep has to be told of ahead as well.
  const bool blast_ahead = !blasts_.empty() && blasts_.back().tick > now;
  const auto avatars = players_.avatars();
  const bool deeds_ahead = std::any_of(avatars.begin(), avatars.end(), [&](const Avatar* avatar) {
    return players_.in_play(*avatar, now);
  });
  const Hosting::Counts& c = hosting_.counts();
  return hosting_.physics().awake_count() == 0 && !blast_ahead && !deeds_ahead &&
         handover_requests_.empty() && !aura_exchange_.has_changed() &&
         now - last_decision_ < decision_interval_ticks &&
         c.spawned + c.removed + c.migrations_in + c.migrations_out == changes_at_decision_;
}

/// Blasts are heard of before they happen: what they will throw comes together until then.
void RegionCore::foresee_blasts(std::vector<HostedBody>& hosted, Tick now) const {
  for (const BlastEffect& blast : blasts_) {
    if (blast.tick <= now) continue;
    for (HostedBody& body : hosted) {
      const double gap_m =
          distance(body.position, blast.position) - body.bounding_radius_m - double{blast.radius_m};
      if (gap_m > body.motion_speed_mps * reach_time_s(tolerances_.limits())) continue;
      body.deed_speed_mps = std::max(body.deed_speed_mps, double{blast.speed_mps});
      body.deed_mass_kg = std::max(body.deed_mass_kg, body.mass_kg);
    }
  }
}

/// What players may do in the next moment with what they carry or throw, so that whoever may be hit
/// is here before.
void RegionCore::foresee_deeds(std::vector<HostedBody>& hosted, Tick now) {
  foresee_blasts(hosted, now);
  double speed = 0, mass = 0;
  for (const Throwable& item : world_.throwables) {
    const double item_kg = double{hosting_.definitions()[item.prototype.value].mass_kg};
    if (double{item.speed_mps} * item_kg > speed * mass) mass = item_kg;
    speed = std::max(speed, double{item.speed_mps});
  }
  for (const Avatar* avatar : players_.avatars()) {
    const auto body = index_of(hosted, avatar->body());
    if (!body) continue;
    const double reach_s = reach_time_s(tolerances_.limits());
    const AuraCapsule reach =
        struck_aura(hosted[*body], resting_aura(hosted[*body]), speed * reach_s, reach_s);
    // What rests beyond the boundary is not told of before something comes near to it.
    const AuraBox room = reach.box();
    const bool leaves_home =
        !audience_of(home_lines_.map(), self_, hosted[*body].position,
                     std::max(room.half.x(), room.half.z()) + home_lines_.margin_m())
             .empty();
    const auto remote = aura_exchange_.remote();
    players_.note_company(avatar->player,
                          leaves_home || std::any_of(remote.begin(), remote.end(), [&](auto& aura) {
                            return overlap(aura.room, reach);
                          }));
    if (!players_.in_play(*avatar, now)) continue;
    hosted[*body].deed_speed_mps = std::max(hosted[*body].deed_speed_mps, speed);
    hosted[*body].deed_mass_kg = std::max(hosted[*body].deed_mass_kg, mass);
    if (avatar->carried == BodyId{}) continue;
    if (const auto carried = index_of(hosted, avatar->carried)) {
      hosted[*carried].deed_speed_mps = double{AvatarTuning{}.carry_speed_max_mps};
      hosted[*carried].deed_mass_kg = hosted[*carried].mass_kg;
    }
  }
}

/// With whom something is to happen though it may sleep. Ascending.
std::vector<BodyId> RegionCore::stirred_bodies(Tick now) const {
  std::vector<BodyId> stirred;
  stand_in_watch_.append_pressed(now, stirred);
  for (const Avatar* avatar : players_.avatars()) {
    stirred.push_back(avatar->body());
    if (avatar->carried != BodyId{}) stirred.push_back(avatar->carried);
  }
  if (const Sleepers* sleepers = hosted_bodies_.sleepers()) {
    std::vector<Sleepers::Place> struck;
    for (const BlastEffect& blast : blasts_)
      if (blast.tick > now)
        sleepers->rows().find(
            {blast.position.vector(), Eigen::Vector3d::Constant(double{blast.radius_m})}, struck);
    for (const Sleepers::Place place : struck) stirred.push_back(sleepers->body(place).id);
  }
  std::sort(stirred.begin(), stirred.end());
  stirred.erase(std::unique(stirred.begin(), stirred.end()), stirred.end());
  return stirred;
}

std::span<const HostedBody> RegionCore::look_at_hosted(Tick now) {
  std::vector<BodyId> asked_for;
  for (const HandoverRequest& request : handover_requests_) asked_for.push_back(request.body);
  const std::vector<BodyId> stirred = stirred_bodies(now);
  std::vector<HostedBody>& hosted = hosted_bodies_.look(
      hosting_, {stand_in_watch_, reach_time_s(tolerances_.limits()), asked_for, stirred}, now);
  for (const Avatar* avatar : players_.avatars()) {
    if (avatar->carried == BodyId{} || !index_of(hosted, avatar->body())) continue;
    if (const auto carried = index_of(hosted, avatar->carried))
      hosted[*carried].leader = avatar->body();
  }
  foresee_deeds(hosted, now);
  return hosted;
}

void RegionCore::watch_stand_ins(Tick now) {
  stand_in_watch_.look(
      hosting_.physics(), now, [&](BodyId body) { return hosting_.lies_still(body, now); },
      [&](PrototypeId prototype) {
        return double{hosting_.definitions()[prototype.value].mass_kg};
      });
  constexpr std::int64_t look_around_ticks = 512;
  if (now.value % look_around_ticks == 0) stand_ins_.look_around();
  stand_ins_.note_ours(hosting_.physics().awake());
}

Hosting::Cut RegionCore::cut() const {
  return world_.mode == MigrationMode::adaptive ? Hosting::Cut::at_rest : Hosting::Cut::nowhere;
}

const MigrationDecision& RegionCore::decide(Tick now) {
  linked_.assign(map_.size(), false);
  for (const auto& [id, peer] : peers_)
    if (id.is_region())
      linked_[id.as_region().value] =
          peer.up && !peer.recovering && !waits_for_auras(id.as_region(), peer, now);
  const MigrationDecision* decision = nullptr;
  const double depth_m = policy_->depth_m() + home_lines_.margin_m();
  const bool asks_largest = load_levels_.is_to_choose(now);
  // Where a strip is not enough, one twice as deep nearly always is. But if the largest cluster is
  // asked for it is to be the largest of the region, as far as that has to be looked at.
  const double deeper_m = asks_largest ? everything_m : 2 * depth_m;
  hosted_bodies_.begin(hosting_, std::isfinite(depth_m), now);
  const Touching contacts(hosting_.physics());
  for (const double look_m : {depth_m, deeper_m, everything_m}) {
    if (depth_m < look_m && look_m == everything_m) ++extra_.whole_looks;
    hosted_bodies_.show_within(look_m, remote_auras_);
    const std::span<const HostedBody> hosted = look_at_hosted(now);
    decision = &policy_->decide({.now = now,
                                 .self = self_,
                                 .map = home_lines_.map(),
                                 .hosted = hosted,
                                 .remote = remote_auras_,
                                 .requested = handover_requests_,
                                 .linked = linked_,
                                 .contacts = &contacts,
                                 .view = hosted_bodies_.view(),
                                 .sleepers = hosted_bodies_.sleepers(),
                                 .awake = awake_everywhere_,
                                 .order = {load_levels_.in_force(now), neighbours_},
                                 .order_before = {load_levels_.in_force_before(now), neighbours_},
                                 .map_margin_m = home_lines_.margin_m(),
                                 .asks_largest = asks_largest});
    if (!decision->sees_too_little) break;
  }
  handover_requests_.clear();
  largest_cluster_ = decision->largest_cluster;
  return *decision;
}

/// All servers decide at the same ticks; who was held up makes up for one that was left out.
bool RegionCore::decides_at(Tick now) const {
  const std::int64_t interval = policy_->interval_ticks();
  return !started_ || now.value / interval != last_tick_.value / interval;
}

/// What is said of a body that has come to us since is out of date. Seldom is there any.
void RegionCore::find_remote_auras() {
  const std::span<const RemoteAura> told = aura_exchange_.remote();
  const std::span<const BodyId> ours = hosting_.physics().ids();
  auto at = ours.begin();  // Both ascend.
  const auto is_ours = [&](const RemoteAura& aura) {
    at = leap(at, ours.end(), aura.id, std::less<>{});
    return at != ours.end() && *at == aura.id;
  };
  remote_auras_ = told;
  const auto first = std::find_if(told.begin(), told.end(), is_ours);
  if (first == told.end()) return;
  others_auras_.assign(told.begin(), first);
  at = ours.begin();
  std::copy_if(first, told.end(), std::back_inserter(others_auras_),
               [&](const RemoteAura& aura) { return !is_ours(aura); });
  remote_auras_ = others_auras_;
}

void RegionCore::migrate(Tick now) {
  if (!decides_at(now)) return;
  const bool home_is_elsewhere = home_lines_.move(now);
  if (home_is_elsewhere) hosted_bodies_.move_home(home_lines_.map(), self_, home_lines_.margin_m());
  // Most of a world sleeps most of the time; what was decided then still holds.
  if (!home_is_elsewhere && nothing_stirs(now)) return;
  find_remote_auras();
  const MigrationDecision& decision = decide(now);
  enter(StepProfile::Part::aura);
  for (const Migration& migration : decision.leaving)
    handed_over_.insert(migration.bodies.begin(), migration.bodies.end());
  aura_exchange_.announce(now, decision, ProjectedBodies(hosting_, handed_over_));
  handed_over_.clear();
  const Hosting::Counts& c = hosting_.counts();
  changes_at_decision_ = c.spawned + c.removed + c.migrations_in + c.migrations_out;
  last_decision_ = now;
  enter(StepProfile::Part::wire);
  for (const Migration& migration : decision.leaving) {
    std::span<const BodyId> rest(migration.bodies);
    while (!rest.empty()) {
      const std::size_t count = std::min(rest.size(), max_handoff_bodies);
      emigrate(rest.first(count), migration.to, now);
      rest = rest.subspan(count);
    }
  }
  handed_over_.clear();
}

void RegionCore::emigrate(std::span<const BodyId> bodies, RegionId to, Tick now) {
  Hosting::Released released = hosting_.release(bodies, now, cut());
  HandoffGroup& group = released.group;
  group.avatars = players_.release(bodies, to, now);
  stand_ins_.left(released.left_behind, to, now);
  handed_over_.insert(bodies.begin(), bodies.end());
  Journal& journal = peers_.at(PeerId::region(to)).journal;
  journal.append(FrameType::handoff, encode_handoff(group));
  for (const auto& b : group.bodies)
    traces_.remember({b.body.id, {b.epoch + 1, journal.peer(), to}, false}, now);
}

}  // namespace aureole
