// A region's decisions on who hosts what: what the policy is told, and what becomes of its answer.
#include <algorithm>
#include <map>
#include <set>

#include "server/aura/adaptive/aura_size.h"
#include "server/region/region_core.h"

namespace aureole {
namespace {

/// What the policy may ask of contacts.
class Touching final : public ContactSource {
 public:
  explicit Touching(const PhysicsWorld& physics) : physics_(physics) {}
  void touching(BodyId body, std::vector<BodyId>& found) const override {
    const auto all = physics_.contact_graph().touching(body);
    found.insert(found.end(), all.begin(), all.end());
  }

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
    return {id, hosting_.physics().prototype(id), hosting_.physics().state(id)};
  }
  bool was_handed_over(BodyId id) const override { return handed_over_.contains(id); }

 private:
  const Hosting& hosting_;
  const std::set<BodyId>& handed_over_;
};

}  // namespace

bool RegionCore::nothing_stirs(Tick now) const {
  const Hosting::Counts& c = hosting_.counts();
  return hosting_.physics().awake_count() == 0 && handover_requests_.empty() &&
         !aura_exchange_.has_changed() && now - last_decision_ < decision_interval_ticks &&
         c.spawned + c.removed + c.migrations_in + c.migrations_out == changes_at_decision_;
}

/// What players may do in the next moment with what they carry or throw, so that whoever may be hit
/// is here before.
void RegionCore::foresee_deeds(std::vector<HostedBody>& hosted, Tick now) {
  double speed = 0, mass = 0;
  for (const Throwable& item : world_.throwables) {
    const double item_kg = double{hosting_.definitions()[item.prototype.value].mass_kg};
    if (double{item.speed_mps} * item_kg > speed * mass) mass = item_kg;
    speed = std::max(speed, double{item.speed_mps});
  }
  for (const Avatar* avatar : players_.avatars()) {
    const auto body = index_of(hosted, avatar->body());
    if (!body) continue;
    const AuraBox reach = struck_aura(hosted[*body], speed, reach_time_s(tolerances_.limits()));
    const auto remote = aura_exchange_.remote();
    players_.note_company(avatar->player,
                          std::any_of(remote.begin(), remote.end(),
                                      [&](auto& aura) { return aura.box.overlaps(reach); }));
    if (!players_.in_play(*avatar, now)) continue;
    hosted[*body].deed_speed_mps = speed;
    hosted[*body].deed_mass_kg = mass;
    if (avatar->carried == BodyId{}) continue;
    if (const auto carried = index_of(hosted, avatar->carried)) {
      hosted[*carried].deed_speed_mps = double{AvatarTuning{}.carry_speed_max_mps};
      hosted[*carried].deed_mass_kg = hosted[*carried].mass_kg;
    }
  }
}

std::vector<HostedBody> RegionCore::hosted_bodies(Tick now) {
  std::map<BodyId, BodyId> leaders;
  for (const Avatar* avatar : players_.avatars())
    if (avatar->carried != BodyId{}) leaders[avatar->carried] = avatar->body();

  std::vector<HostedBody> hosted;
  const PhysicsWorld& physics = hosting_.physics();
  hosted.reserve(physics.size());
  for (BodyId id : physics.ids()) {
    const auto leader = leaders.find(id);
    const BodyState state = physics.state(id);
    const PrototypeId prototype = physics.prototype(id);
    const BodyDefinition& definition = hosting_.definitions()[prototype.value];
    HostedBody& body = hosted.emplace_back();
    body.id = id;
    body.position = state.position;
    body.half_extents = physics.half_extents(id).cast<double>();
    body.bounding_radius_m = hosting_.radius(prototype);
    body.velocity_mps = state.linear_velocity.cast<double>();
    body.surface_speed_mps = double{surface_speed(definition.shape, state.orientation,
                                                  state.linear_velocity, state.angular_velocity)};
    body.mass_kg = definition.mass_kg;
    body.restitution = definition.restitution;
    body.round = std::holds_alternative<SphereShape>(definition.shape);
    body.asleep = state.activation == Activation::asleep;
    body.still_ticks = hosting_.note_stillness(id, body.surface_speed_mps, now);
    body.pressed = stand_in_watch_.is_pressed(id, now);
    if (body.still_ticks == 0) nearby_geometry_.look(body, reach_time_s(tolerances_.limits()));
    if (leader != leaders.end()) body.leader = leader->second;
    body.changed_owner = hosting_.changed_owner(id);
  }
  foresee_deeds(hosted, now);
  return hosted;
}

void RegionCore::watch_stand_ins(Tick now) {
  stand_in_watch_.look(
      hosting_.physics(), now, [&](BodyId body) { return hosting_.lies_still(body, now); },
      [&](BodyId stand_in) {
        const PrototypeId prototype = hosting_.physics().stand_in(stand_in).prototype;
        return double{hosting_.definitions()[prototype.value].mass_kg};
      });
}

Hosting::Cut RegionCore::cut() const {
  return world_.mode == MigrationMode::adaptive ? Hosting::Cut::at_rest : Hosting::Cut::nowhere;
}

void RegionCore::migrate(Tick now) {
  // Most of a world sleeps most of the time; what was decided then still holds.
  if (nothing_stirs(now)) return;
  const std::vector<HostedBody> hosted = hosted_bodies(now);
  std::vector<bool> linked;
  for (std::size_t i = 0; i < map_.size(); ++i)
    linked.push_back(is_up(RegionId{static_cast<std::uint16_t>(i)}) && !waits_for_auras(now));
  const Touching contacts(hosting_.physics());
  const MigrationDecision decision = policy_->decide(
      {now, self_, map_, hosted, aura_exchange_.remote(), handover_requests_, linked, &contacts});
  handover_requests_.clear();
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
