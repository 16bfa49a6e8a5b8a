// Scenes that the physics tests share: prototypes of every shape, stacks, heaps.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "server/base/tick.h"
#include "server/physics/physics_world.h"
#include "tests/support/catch.h"

namespace aureole::scenes {

enum : std::uint16_t { ball, cube, capsule, cylinder, hull, compound, plank, avatar, kinds };

inline const std::vector<BodyDefinition>& prototypes() {
  static const std::vector<BodyDefinition> table = [] {
    std::vector<BodyDefinition> t(kinds);
    t[ball].shape = SphereShape{0.5f};
    t[cube].shape = BoxShape{{0.5f, 0.5f, 0.5f}};
    t[capsule].shape = CapsuleShape{0.3f, 1.2f};
    t[cylinder].shape = CylinderShape{0.4f, 0.8f};
    t[hull].shape = ConvexHullShape{{{0.6f, -0.4f, 0.6f},
                                     {-0.6f, -0.4f, 0.6f},
                                     {0.6f, -0.4f, -0.6f},
                                     {-0.6f, -0.4f, -0.6f},
                                     {0.4f, 0.4f, 0.4f},
                                     {-0.4f, 0.4f, 0.4f},
                                     {0.4f, 0.4f, -0.4f},
                                     {-0.4f, 0.4f, -0.4f}}};
    const auto leg = std::make_shared<const Shape>(BoxShape{{0.15f, 0.3f, 0.5f}});
    const auto top = std::make_shared<const Shape>(BoxShape{{0.7f, 0.15f, 0.5f}});
    t[compound].shape = CompoundShape{{{top, {0, 0.3f, 0}, Eigen::Quaternionf::Identity()},
                                       {leg, {-0.55f, -0.15f, 0}, Eigen::Quaternionf::Identity()},
                                       {leg, {0.55f, -0.15f, 0}, Eigen::Quaternionf::Identity()}}};
    t[plank].shape = BoxShape{{0.5f, 0.25f, 0.15f}};
    t[avatar].shape = CapsuleShape{0.3f, 1.8f};
    t[avatar].upright = true;
    return t;
  }();
  return table;
}

inline const std::vector<StaticDefinition>& ground() {
  static const std::vector<StaticDefinition> table(1);
  return table;
}

inline PhysicsWorld world_on_ground() {
  return PhysicsWorld(PhysicsSettings{}, prototypes(), ground(), 64);
}

inline NewBody body(std::uint32_t n, std::uint16_t prototype, double x, double y, double z) {
  NewBody b{BodyId::world(n), PrototypeId{prototype}, {}};
  b.state.position = {x, y, z};
  return b;
}

inline void run(PhysicsWorld& world, int ticks) {
  for (int i = 0; i < ticks; ++i) world.step(tick_s);
}

/// Ten cubes: rows of four, three, two and one.
inline std::vector<NewBody> pyramid() {
  std::vector<NewBody> out;
  for (int row = 0; row < 4; ++row)
    for (int i = 0; i < 4 - row; ++i)
      out.push_back(body(static_cast<std::uint32_t>(out.size()), cube, 1.05 * i + 0.525 * row,
                         0.5 + 1.0 * row, 0));
  return out;
}

inline std::vector<NewBody> plain_tower() {
  std::vector<NewBody> out;
  for (std::uint32_t i = 0; i < 10; ++i) out.push_back(body(i, cube, 0, 0.5 + 1.0 * i, 0));
  return out;
}

/// The same, built by a hasty hand: every cube a little beside and across the one below.
inline std::vector<NewBody> careless_tower() {
  std::vector<NewBody> out = plain_tower();
  for (std::size_t i = 0; i < out.size(); ++i) {
    BodyState& s = out[i].state;
    const auto n = static_cast<float>(i);
    s.position.x += 0.03 * static_cast<double>(std::sin(2.1f * n));
    s.position.z += 0.03 * static_cast<double>(std::cos(1.7f * n));
    s.orientation = Eigen::AngleAxisf(0.1f * std::sin(3.3f * n), Eigen::Vector3f::UnitY());
  }
  return out;
}

/// Two planks side by side in each of five layers, every layer across the one below.
inline std::vector<NewBody> crossed_tower() {
  std::vector<NewBody> out;
  const Eigen::Quaternionf quarter(
      Eigen::AngleAxisf(static_cast<float>(M_PI / 2), Eigen::Vector3f::UnitY()));
  for (std::uint32_t i = 0; i < 10; ++i) {
    const double side = i % 2 ? 0.35 : -0.35;
    const bool turned = (i / 2) % 2;
    NewBody b = body(i, plank, turned ? side : 0, 0.25 + 0.5 * (i / 2), turned ? 0 : side);
    if (turned) b.state.orientation = quarter;
    out.push_back(b);
  }
  return out;
}

/// Bodies of all shapes in a column that falls into a heap; the same for the same seed.
inline std::vector<NewBody> heap(std::uint32_t count, std::uint32_t seed, int across = 6) {
  std::mt19937 random(seed);
  const auto between = [&](float low, float high) {
    return low + (high - low) * (static_cast<float>(random() >> 8) * 0x1p-24f);
  };
  std::vector<NewBody> out;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto place = static_cast<int>(i);
    NewBody b =
        body(i, static_cast<std::uint16_t>(random() % avatar),
             1.3 * (place % across) + between(-0.1f, 0.1f), 1.0 + 1.4 * (place / (across * across)),
             1.3 * (place / across % across) + between(-0.1f, 0.1f));
    b.state.orientation = Eigen::Quaternionf(between(-1, 1), between(-1, 1), between(-1, 1), 1.5f);
    b.state.orientation.normalize();
    b.state.linear_velocity = {between(-2, 2), between(-3, 1), between(-2, 2)};
    b.state.angular_velocity = {between(-3, 3), between(-3, 3), between(-3, 3)};
    out.push_back(b);
  }
  return out;
}

inline std::vector<NewBody> bodies_of(const PhysicsWorld& world) {
  std::vector<NewBody> out;
  for (BodyId id : world.ids()) out.push_back({id, world.prototype(id), world.state(id)});
  return out;
}

inline std::vector<BodyId> ids_of(const PhysicsWorld& world) {
  return {world.ids().begin(), world.ids().end()};
}

/// Every number the same, as floats compare. (Bytes may differ in padding.)
inline bool identical(const BodyState& a, const BodyState& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs() &&
         a.linear_velocity == b.linear_velocity && a.angular_velocity == b.angular_velocity &&
         a.activation == b.activation && a.deactivation_time_s == b.deactivation_time_s;
}

}  // namespace aureole::scenes
