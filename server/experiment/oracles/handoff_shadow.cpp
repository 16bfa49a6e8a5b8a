// Capture at the sender, step, compare at the receiver.
#include "server/experiment/oracles/handoff_shadow.h"

#include <algorithm>
#include <set>

namespace aureole {

HandoffShadow::HandoffShadow(const WorldDefinition& world) {
  for (const auto& prototype : world.prototypes) definitions_.push_back(prototype.body);
  for (const auto& piece : world.statics) statics_.push_back(piece.body);
  physics_ = std::make_unique<PhysicsWorld>(world.physics, definitions_, statics_, 4);
}

void HandoffShadow::left(const RegionCore& sender, Tick tick, std::span<const Departure> departures,
                         bool players_act) {
  if (players_act) return;
  for (const Departure& departure : departures) {
    const HandoffGroup& group = departure.group;
    if (!group.avatars.empty() || group.bodies.size() > group_max || sampled_ >= sampled_max)
      continue;
    const bool sleeps = std::all_of(group.bodies.begin(), group.bodies.end(), [](const auto& b) {
      return b.body.state.activation == Activation::asleep;
    });
    // What another server reached for left before the step that the neighbours have taken.
    if (sleeps || group.tick != tick) continue;
    ++sampled_;
    Followed followed;
    followed.tick = group.tick;
    followed.from = departure.from;
    followed.to = departure.to;
    followed.contacts = group.contacts;
    std::set<BodyId> near;
    for (const auto& b : group.bodies) {
      followed.group.push_back(b.body);
      const float reach = bounding_radius(definitions_[b.body.prototype.value].shape) +
                          static_cast<float>(neighbourhood_m);
      for (BodyId id : sender.physics().overlapping_sphere(b.body.state.position, reach))
        if (sender.hosting().hosts(id)) near.insert(id);
    }
    // Not those that the sender received in the meantime under the same name.
    for (const NewBody& b : followed.group) near.erase(b.id);
    const std::vector<BodyId> ids(near.begin(), near.end());
    for (BodyId id : ids)
      followed.near.push_back({id, sender.physics().prototype(id), sender.physics().state(id)});
    for (ContactManifold& contact : sender.physics().contacts_within(ids))
      followed.contacts.push_back(std::move(contact));
    followed_.push_back(std::move(followed));
  }
}

void HandoffShadow::stepped(RegionId receiver, Tick tick, const RegionCore& core,
                            bool players_act) {
  std::erase_if(followed_, [&](const Followed& f) {
    if (tick - f.tick > flight_ticks_max) return true;
    if (f.to != receiver || !core.hosting().hosts(f.group.front().id)) return false;
    if (!players_act) compare(f, tick, core);
    return true;
  });
}

void HandoffShadow::compare(const Followed& followed, Tick tick, const RegionCore& receiver) {
  PhysicsWorld shadow = physics_->scratch(followed.group.size() + followed.near.size());
  std::vector<NewBody> all = followed.group;
  all.insert(all.end(), followed.near.begin(), followed.near.end());
  shadow.add(all);
  shadow.install_contacts(followed.contacts);
  for (Tick t = followed.tick; t < tick; t = t + 1) shadow.step(tick_s);
  if (meets_others(shadow, followed, receiver)) return;
  for (const NewBody& b : followed.group) {
    if (!receiver.hosting().hosts(b.id)) continue;  // Handed on already.
    const double mm = 1000 * distance(shadow.position(b.id), receiver.physics().position(b.id));
    jumps_mm_.push_back(mm);
    jumps_.push_back({b.id, followed.from, followed.to, tick, mm});
  }
}

bool HandoffShadow::meets_others(const PhysicsWorld& shadow, const Followed& followed,
                                 const RegionCore& receiver) const {
  std::set<BodyId> own;
  for (const NewBody& b : followed.group) own.insert(b.id);
  for (const NewBody& b : followed.group) {
    const float reach = bounding_radius(definitions_[b.prototype.value].shape) + 0.3f +
                        b.state.linear_velocity.norm() * 3 * tick_s;
    for (BodyId id : receiver.physics().overlapping_sphere(shadow.position(b.id), reach))
      if (!own.contains(id)) return true;
  }
  return false;
}

const HandoffShadow::Jump* HandoffShadow::p99() const {
  if (jumps_.empty()) return nullptr;
  std::vector<const Jump*> sorted;
  for (const Jump& jump : jumps_) sorted.push_back(&jump);
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(0.99 * (sorted.size() - 1.0));
  std::nth_element(sorted.begin(), at, sorted.end(),
                   [](const Jump* a, const Jump* b) { return a->mm < b->mm; });
  return *at;
}

void HandoffShadow::report(SeedResult& result) const {
  result.handoff_jumps_mm = jumps_mm_;
}

}  // namespace aureole
