// A playground made up from a number: what benchmarks, golden images and pictures draw.
#include "renderer/bench/demo_scene.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace aureole::render {
namespace {

using Eigen::Vector3f;

constexpr std::array<Rgb, 8> palette{{{233, 106, 84},
                                      {247, 178, 74},
                                      {250, 214, 110},
                                      {108, 184, 138},
                                      {74, 160, 190},
                                      {104, 118, 196},
                                      {176, 112, 190},
                                      {236, 142, 158}}};
constexpr std::array<Rgb, 3> woods{{{205, 158, 104}, {186, 136, 88}, {219, 176, 124}}};

enum MeshName : MeshIndex {
  ball,
  big_ball,
  crate,
  domino,
  plank,
  barrel,
  avatar,
  gem,
  dumbbell,
  ramp,
  platform,
  pit_long,
  pit_short,
  mesh_name_count
};

// SplitMix64, https://prng.di.unimi.it/splitmix64.c (public domain): the same numbers everywhere.
class Random {
 public:
  float unit() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<float>((z ^ (z >> 31)) >> 40) * 0x1p-24f;
  }
  float between(float low, float high) { return low + (high - low) * unit(); }
  Eigen::Vector4f rotation() {
    Eigen::Vector4f q;
    do {
      for (int k = 0; k < 4; ++k) q[k] = between(-1, 1);
    } while (q.squaredNorm() > 1 || q.squaredNorm() < 0.01f);
    return q.normalized();
  }

 private:
  std::uint64_t state_ = 20190712;
};

Eigen::Vector4f turned(const Vector3f& axis, float angle) {
  return Eigen::Quaternionf(Eigen::AngleAxisf(angle, axis)).coeffs();
}

class Stage {
 public:
  DemoScene demo;

  void put(MeshName mesh, Rgb colour, const Vector3f& at,
           const Eigen::Vector4f& orientation = {0, 0, 0, 1}) {
    demo.scene.instances.push_back({next_key_++, mesh, colour, at, orientation});
  }
  void fix(MeshName mesh, Rgb colour, const Vector3f& at,
           const Eigen::Vector4f& orientation = {0, 0, 0, 1}) {
    demo.geometry.instances.push_back({next_key_++, mesh, colour, at, orientation});
  }
  Rgb any_colour() { return palette[static_cast<std::size_t>(random.unit() * 7.999f)]; }

  Random random;

 private:
  std::uint64_t next_key_ = 1;
};

std::vector<MeshDescription> demo_meshes() {
  std::vector<MeshDescription> meshes(mesh_name_count);
  meshes[ball] = {SphereShape{0.25f}};
  meshes[big_ball] = {SphereShape{0.8f}};
  meshes[crate] = {BoxShape{{0.4f, 0.4f, 0.4f}}};
  meshes[domino] = {BoxShape{{0.09f, 0.75f, 0.4f}}};
  meshes[plank] = {BoxShape{{1.6f, 0.08f, 0.3f}}};
  meshes[barrel] = {CylinderShape{0.35f, 0.95f}};
  meshes[avatar] = {CapsuleShape{0.35f, 1.8f}};
  HullShape hull;
  for (int k = 0; k < 7; ++k) {
    const float a = static_cast<float>(k) * 0.8976f;
    hull.points.emplace_back(0.42f * std::cos(a), -0.1f, 0.42f * std::sin(a));
    hull.points.emplace_back(0.26f * std::cos(a), 0.22f, 0.26f * std::sin(a));
  }
  hull.points.emplace_back(0, -0.45f, 0);
  meshes[gem] = {hull};
  CompoundShape bell;
  bell.parts.push_back({SphereShape{0.3f}, {-0.5f, 0, 0}});
  bell.parts.push_back({SphereShape{0.3f}, {0.5f, 0, 0}});
  bell.parts.push_back({BoxShape{{0.5f, 0.1f, 0.1f}}});
  meshes[dumbbell] = {bell};
  meshes[ramp] = {BoxShape{{2.0f, 0.15f, 4.0f}}};
  meshes[platform] = {BoxShape{{3.0f, 0.6f, 3.0f}}};
  meshes[pit_long] = {BoxShape{{4.0f, 0.5f, 0.2f}}};
  meshes[pit_short] = {BoxShape{{0.2f, 0.5f, 4.0f}}};
  return meshes;
}

void crate_pyramid(Stage& s, const Vector3f& corner, int base, bool wooden) {
  for (int layer = 0; layer < base; ++layer) {
    for (int x = 0; x < base - layer; ++x) {
      for (int z = 0; z < base - layer; ++z) {
        const float step = 0.84f, shift = static_cast<float>(layer) * step / 2;
        const Vector3f at(shift + static_cast<float>(x) * step,
                          0.4f + 0.8f * static_cast<float>(layer),
                          shift + static_cast<float>(z) * step);
        const Rgb wood = woods[static_cast<std::size_t>(s.random.unit() * 2.999f)];
        s.put(crate, wooden ? wood : s.any_colour(), corner + at,
              turned(Vector3f::UnitY(), s.random.between(-0.06f, 0.06f)));
      }
    }
  }
}

void domino_line(Stage& s) {
  for (int k = 0; k < 56; ++k) {
    const float t = static_cast<float>(k) * 0.075f;
    const float x = -13.5f + static_cast<float>(k) * 0.49f, z = 3.4f + 1.5f * std::sin(t * 1.9f);
    const float slope = 1.5f * 1.9f * 0.075f / 0.49f * std::cos(t * 1.9f);
    const auto colour = palette[static_cast<std::size_t>(k / 7) % palette.size()];
    s.put(domino, colour, {x, 0.75f, z}, turned(Vector3f::UnitY(), -std::atan(slope)));
  }
}

void ball_pit(Stage& s, const Vector3f& centre) {
  const Rgb rim{226, 222, 212};
  s.fix(pit_long, rim, centre + Vector3f(0, 0.5f, 4.2f));
  s.fix(pit_long, rim, centre + Vector3f(0, 0.5f, -4.2f));
  s.fix(pit_short, rim, centre + Vector3f(4.2f, 0.5f, 0));
  s.fix(pit_short, rim, centre + Vector3f(-4.2f, 0.5f, 0));
  for (int k = 0; k < 130; ++k) {
    const Vector3f at(s.random.between(-3.7f, 3.7f), 0.25f + (k % 3 == 0 ? 0.4f : 0.0f),
                      s.random.between(-3.7f, 3.7f));
    s.put(ball, s.any_colour(), centre + at, s.random.rotation());
  }
}

void ramps_and_platform(Stage& s) {
  const Rgb stone{206, 204, 198};
  s.fix(platform, stone, {-8.5f, 0.6f, -6});
  s.fix(ramp, stone, {-8.5f, 0.42f, 0.6f}, turned(Vector3f::UnitX(), 0.2f));
  s.fix(ramp, stone, {13, 0.85f, -5}, turned(Vector3f::UnitX(), -0.26f));
  s.put(big_ball, palette[0], {-8.1f, 2.0f, -5.4f}, turned(Vector3f(0.6f, 0, 0.8f), 0.9f));
  s.put(barrel, palette[4], {-9.9f, 1.675f, -4.4f});
  s.put(barrel, palette[1], {-10.1f, 1.675f, -6.5f});
  s.put(dumbbell, palette[6], {-7, 1.5f, -7.6f}, turned(Vector3f::UnitY(), 0.6f));
  s.put(big_ball, palette[4], {13.2f, 2.2f, -4.6f}, turned(Vector3f(0, 0.6f, 0.8f), 0.8f));
}

void people_and_loose_parts(Stage& s) {
  s.put(avatar, palette[0], {-3.4f, 0.9f, 6.2f});
  s.put(avatar, palette[4], {-1.9f, 0.9f, 6.9f});
  s.put(avatar, palette[3], {4.8f, 0.9f, 6.0f});
  s.put(avatar, palette[6], {-8.6f, 1.63f, -0.9f});
  s.put(barrel, palette[3], {6.4f, 0.35f, 6.8f}, turned(Vector3f(0, 0, 1), 1.5708f));
  s.put(plank, woods[0], {1.2f, 0.62f, 7.2f}, turned(Vector3f(0, 0, 1), 0.32f));
  s.put(barrel, palette[5], {1.2f, 0.35f, 7.2f}, turned(Vector3f(1, 0, 0), 1.5708f));
  s.put(gem, palette[6], {3.2f, 0.32f, 8.1f}, turned(Vector3f(1, 0, 0), 0.5f));
  s.put(gem, palette[3], {-5.4f, 0.32f, 8.2f}, turned(Vector3f(0, 0, 1), -0.6f));
  s.put(dumbbell, palette[1], {-0.4f, 0.3f, 9.0f}, turned(Vector3f::UnitY(), -0.5f));
  s.put(ball, palette[0], {0.6f, 2.9f, 5.2f}, turned(Vector3f(1, 0, 0), 0.5f));
  s.put(ball, palette[7], {4.3f, 0.25f, 8.9f}, turned(Vector3f(0.6f, 0, 0.8f), 0.7f));
  s.put(ball, palette[4], {-3.1f, 0.25f, 9.3f}, turned(Vector3f(0.8f, 0, 0.6f), 1.1f));
}

void strew(Stage& s, int count) {
  // A disc whose density does not depend on the number, around what is built by hand.
  const float area = static_cast<float>(count) * 9.0f;
  const float outer = std::sqrt(area / 3.14159f + 20.0f * 20.0f);
  for (int k = 0; k < count; ++k) {
    const float angle = s.random.between(0, 6.2831853f);
    const float r2 = s.random.between(20.0f * 20.0f, outer * outer);
    const Vector3f at(std::sqrt(r2) * std::cos(angle), 0, std::sqrt(r2) * std::sin(angle));
    const float y = s.random.unit() < 0.2f ? s.random.between(1, 4) : 0.0f;
    switch (k % 5) {
      case 0:
        s.put(ball, s.any_colour(), at + Vector3f(0, 0.25f + y, 0), s.random.rotation());
        break;
      case 1:
        s.put(crate, woods[0], at + Vector3f(0, 0.4f, 0),
              turned(Vector3f::UnitY(), s.random.between(0, 3)));
        break;
      case 2:
        s.put(barrel, s.any_colour(), at + Vector3f(0, 0.475f, 0));
        break;
      case 3:
        s.put(gem, s.any_colour(), at + Vector3f(0, 0.4f + y, 0), s.random.rotation());
        break;
      default:
        s.put(dumbbell, s.any_colour(), at + Vector3f(0, 0.3f, 0),
              turned(Vector3f::UnitY(), s.random.between(0, 3)));
        break;
    }
  }
}

}  // namespace

DemoScene make_demo_scene(int bodies) {
  Stage stage;
  stage.demo.meshes = demo_meshes();
  crate_pyramid(stage, {-4.2f, 0, -5.5f}, 5, true);
  crate_pyramid(stage, {8.2f, 0, 1.0f}, 3, false);
  domino_line(stage);
  ball_pit(stage, {5.5f, 0, -5.5f});
  ramps_and_platform(stage);
  people_and_loose_parts(stage);
  const int missing = bodies - static_cast<int>(stage.demo.scene.instances.size());
  if (missing > 0) strew(stage, missing);
  stage.demo.scene.boundaries = {{{-1e4f, -1}, {1e4f, -1}}, {{0.2f, -1e4f}, {0.2f, 1e4f}}};
  stage.demo.camera.eye = {1.2f, 3.6f, 15.5f};
  stage.demo.camera.yaw_rad = 0.06f;
  stage.demo.camera.pitch_rad = -0.17f;
  return stage.demo;
}

Camera demo_walk(int frame) {
  Camera camera;
  const float t = static_cast<float>(frame) * 0.02f;
  camera.eye = {15.0f * std::sin(t), 3.0f + std::sin(t * 1.7f), 15.0f * std::cos(t)};
  camera.yaw_rad = t;
  camera.pitch_rad = -0.12f;
  return camera;
}

}  // namespace aureole::render
