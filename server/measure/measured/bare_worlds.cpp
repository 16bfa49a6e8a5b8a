// Bodies come, worlds step, and what has crossed a boundary changes its world or does not.
#include "server/measure/measured/bare_worlds.h"

#include <map>

#include "server/base/hash.h"
#include "server/experiment/scenario/scenario.h"
#include "server/worlds/injector.h"
#include "server/worlds/region_tiling.h"

namespace aureole {

BareWorlds::BareWorlds(const WorldDefinition& world, Crossing crossing, StepProfile::Clocks clocks,
                       std::function<void()> before_frame)
    : world_(world),
      crossing_(crossing),
      profile_(clocks),
      before_frame_(std::move(before_frame)),
      map_(partition_of(world)),
      injected_(world.injectors.size(), 0),
      frames_(world.regions.size()) {
  for (const auto& prototype : world.prototypes) definitions_.push_back(prototype.body);
  for (const auto& piece : world.statics) statics_.push_back(piece.body);
  worlds_.reserve(world.regions.size());
  for (std::size_t r = 0; r < world.regions.size(); ++r)
    worlds_.emplace_back(world.physics, definitions_, statics_, bodies_expected_by(world));
}

void BareWorlds::tick() {
  now_ = now_ + 1;
  const auto born = newcomers();
  for (std::size_t r = 0; r < worlds_.size(); ++r) {
    if (before_frame_) before_frame_();
    profile_.clear();
    profile_.enter(StepProfile::Part::physics);
    worlds_[r].add(born[r]);
    worlds_[r].step(tick_s);
    profile_.stop();
    frames_[r] = frame_time(profile_);
  }
  if (crossing_ == Crossing::handed_over) hand_over();
}

std::vector<std::vector<NewBody>> BareWorlds::newcomers() {
  std::vector<std::vector<NewBody>> born(worlds_.size());
  for (std::size_t i = 0; i < world_.injectors.size(); ++i) {
    const std::uint64_t made = injected_count(world_.injectors[i], now_);
    for (; injected_[i] < made; ++injected_[i]) {
      const InjectedBody body = injected_body(world_.injectors[i], injected_[i]);
      const RegionId home = map_.region_at(body.state.position.x, body.state.position.z);
      born[home.value].push_back({BodyId::injected(static_cast<std::uint16_t>(i), injected_[i]),
                                  body.prototype, body.state});
    }
  }
  return born;
}

void BareWorlds::hand_over() {
  // All first: nothing crosses two boundaries in one tick.
  std::map<std::pair<std::size_t, std::size_t>, std::vector<BodyId>> leaving;
  for (std::size_t r = 0; r < worlds_.size(); ++r) {
    for (BodyId id : worlds_[r].ids()) {
      const WorldPosition at = worlds_[r].position(id);
      const RegionId home = map_.region_at(at.x, at.z);
      // A body whose numbers have burst goes nowhere.
      if (home.value != r && is_sane(worlds_[r].state(id))) leaving[{r, home.value}].push_back(id);
    }
  }
  for (const auto& [way, ids] : leaving) {
    PhysicsWorld &from = worlds_[way.first], &to = worlds_[way.second];
    std::vector<NewBody> bodies;
    for (BodyId id : ids) bodies.push_back({id, from.prototype(id), from.state(id)});
    std::vector<ContactManifold> contacts = from.contacts_within(ids);
    std::erase_if(contacts, [](const ContactManifold& c) { return !is_sane(c); });
    from.remove(ids);
    to.add(bodies);
    to.install_contacts(contacts);
    migrations_ += ids.size();
  }
}

std::vector<ServerLoad> BareWorlds::loads() const {
  std::vector<ServerLoad> loads(worlds_.size());
  for (std::size_t r = 0; r < worlds_.size(); ++r) {
    loads[r].bodies = worlds_[r].size();
    loads[r].awake = worlds_[r].awake_count();
    for (BodyId id : worlds_[r].ids()) {
      const WorldPosition at = worlds_[r].position(id);
      if (map_.region_at(at.x, at.z).value != r) ++loads[r].foreign;
    }
  }
  return loads;
}

std::uint64_t BareWorlds::state_hash() const {
  Hasher hash;
  for (const PhysicsWorld& world : worlds_) hash.add(world.state_hash());
  return hash.value();
}

}  // namespace aureole
