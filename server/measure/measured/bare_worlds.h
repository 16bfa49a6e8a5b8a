// Regions as physics worlds without servers: the limits that servers are measured against.
#pragma once

#include <functional>
#include <memory>

#include "server/aura/partition/partition_map.h"
#include "server/base/tick.h"
#include "server/measure/measured/measured_run.h"
#include "server/physics/physics_world.h"
#include "server/worlds/world.h"

namespace aureole {

/// A frame is what the bodies that come and Bullet's step take; nobody else is told of anything.
class BareWorlds final : public MeasuredRun {
 public:
  enum class Crossing : std::uint8_t {
    stays,        ///< `ideal`: worlds that do not talk.
    handed_over,  ///< `cut`: at the end of its tick, with its contacts, at no cost.
  };
  /// `world` must outlive the run. `before_frame`: before each, if there is any.
  BareWorlds(const WorldDefinition& world, Crossing crossing, StepProfile::Clocks clocks,
             std::function<void()> before_frame = {});

  void tick() override;
  const std::vector<FrameTime>& frames() const override { return frames_; }
  std::vector<ServerLoad> loads() const override;
  std::uint64_t migrations() const override { return migrations_; }
  std::vector<LinkTraffic> traffic() const override { return {}; }
  std::uint64_t state_hash() const override;
  std::uint64_t refused_messages() const override { return 0; }
  const PhysicsWorld& world(std::size_t region) const { return worlds_[region]; }

 private:
  std::vector<std::vector<NewBody>> newcomers();
  void hand_over();

  const WorldDefinition& world_;
  Crossing crossing_;
  StepProfile profile_;
  std::function<void()> before_frame_;
  PartitionMap map_;
  std::vector<BodyDefinition> definitions_;
  std::vector<StaticDefinition> statics_;
  std::vector<PhysicsWorld> worlds_;  ///< By region.
  std::vector<std::uint64_t> injected_;
  std::vector<FrameTime> frames_;
  std::uint64_t migrations_ = 0;
  Tick now_;
};

}  // namespace aureole
