// Scenes, and what is measured of them.
#include "server/experiment/oracles/single_server_oracle.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "server/experiment/simulation.h"

namespace aureole {
namespace {

/// What no difference can be larger than; stands for "did not happen".
constexpr double far_off = 1e3;

/// The states of all bodies at all ticks.
class Film {
 public:
  Film(const WorldDefinition& world, NetworkTiming timing, int ticks) {
    SimulationOptions options;
    options.scenario.seed = 1;
    options.scenario.seconds = ticks * tick_s;
    options.network = timing;
    Simulation simulation(Scenario{world, "comparison", 0}, options);
    for (int t = 0; t < ticks; ++t) {
      simulation.tick();
      auto& moment = moments_.emplace_back();
      for (const SeenBody& b : simulation.seen()) moment.emplace(b.id, b.state);
    }
  }
  int ticks() const { return static_cast<int>(moments_.size()); }
  const BodyState* at(int tick, BodyId id) const {
    const auto& moment = moments_[static_cast<std::size_t>(tick)];
    const auto it = moment.find(id);
    return it == moment.end() ? nullptr : &it->second;
  }
  /// At the last tick that was looked at.
  const BodyState* last(BodyId id) const { return at(ticks() - 1, id); }

 private:
  std::vector<std::map<BodyId, BodyState>> moments_;
};

/// A prototype that the layouts lack: bounces off its like without loss and slides without
/// friction.
constexpr PrototypeId elastic_prototype{6};

WorldDefinition stage(MigrationMode mode) {
  WorldDefinition world = layout_world("corner4");
  world.mode = mode;
  Prototype elastic = world.prototypes[sphere_prototype.value];
  elastic.name = "elastic ball";
  elastic.body.restitution = 1;
  elastic.body.friction = 0;
  elastic.body.linear_damping = elastic.body.angular_damping = 0;
  world.prototypes.push_back(elastic);
  return world;
}

/// The same world, and with one server.
std::pair<Film, Film> both(const WorldDefinition& split, NetworkTiming timing, int ticks) {
  WorldDefinition whole = split;
  whole.regions = {RegionDefinition{"r0", {}}};
  return {Film(split, timing, ticks), Film(whole, timing, ticks)};
}

double worst_distance(const Film& a, const Film& b, int from, std::size_t bodies) {
  double worst = 0;
  for (int t = from; t < a.ticks(); ++t) {
    for (std::uint32_t n = 0; n < bodies; ++n) {
      const BodyState* one = a.at(t, BodyId::world(n));
      const BodyState* other = b.at(t, BodyId::world(n));
      if (one == nullptr || other == nullptr)
        worst = far_off;
      else
        worst = std::max(worst, distance(one->position, other->position));
    }
  }
  return worst;
}

double worst_velocity_difference(const Film& a, const Film& b, std::size_t bodies) {
  double worst = 0;
  for (std::uint32_t n = 0; n < bodies; ++n) {
    const BodyState* one = a.last(BodyId::world(n));
    const BodyState* other = b.last(BodyId::world(n));
    if (one == nullptr || other == nullptr) return far_off;
    worst = std::max<double>(worst, (one->linear_velocity - other->linear_velocity).norm());
  }
  return worst;
}

/// The first moments of a film show nothing: the oracles look at what is past.
constexpr int film_begins = WorldView::delay_ticks + 1;

Comparison flights(MigrationMode mode, NetworkTiming timing) {
  WorldDefinition world = stage(mode);
  for (int k = 0; k < 12; ++k) {
    // Around the corner, far enough from each other that they never meet.
    const double angle = k * M_PI / 6 + 0.1;
    const float speed = 4.0f + 1.2f * static_cast<float>(k);
    const WorldPosition from{8 * std::cos(angle), 1 + 1.5 * k, 8 * std::sin(angle)};
    put_body(world, k % 2 == 0 ? sphere_prototype : cuboid_prototype, from,
             {-speed * static_cast<float>(std::cos(angle)), 4,
              -speed * static_cast<float>(std::sin(angle))});
  }
  // The tick from which each touches the ground differs; the film ends before the first of them.
  const auto [split, whole] = both(world, timing, 55 + film_begins);
  return {"ballistic flights", "mm apart at any tick",
          1000 * worst_distance(split, whole, film_begins, world.bodies.size()), 5};
}

Comparison collisions(MigrationMode mode, NetworkTiming timing, bool on_corner) {
  double worst = 0;
  for (const float speed : {2.0f, 6.0f, 14.0f}) {
    for (const double offset : {0.0, 0.25}) {
      WorldDefinition world = stage(mode);
      // They meet after 0.6 s, which is when they have fallen back to where they began.
      const double away = speed * 0.6 + 0.3;
      const Eigen::Vector3f way =
          on_corner ? Eigen::Vector3f(1, 0, 1).normalized() : Eigen::Vector3f(1, 0, 0);
      const Eigen::Vector3d to = way.cast<double>();
      const Eigen::Vector3d middle =
          on_corner ? Eigen::Vector3d(0, 3, 0) : Eigen::Vector3d(0, 3, 7);
      const Eigen::Vector3d aside = Eigen::Vector3d(-to.z(), 0, to.x()) * offset;
      const Eigen::Vector3f up(0, 0.3f * 9.81f, 0);
      put_body(world, elastic_prototype,
               WorldPosition::from(Eigen::Vector3d(middle - to * away + aside)), way * speed + up);
      put_body(world, elastic_prototype,
               WorldPosition::from(Eigen::Vector3d(middle + to * away - aside)), -way * speed + up);
      const auto [split, whole] = both(world, timing, 48 + film_begins);
      worst = std::max(worst, worst_velocity_difference(split, whole, 2));
    }
  }
  return {on_corner ? "two bodies collide on the corner" : "two bodies collide on a seam",
          "m/s between outgoing velocities", worst, 0.05};
}

Comparison cradle(MigrationMode mode, NetworkTiming timing) {
  WorldDefinition world = stage(mode);
  constexpr int balls = 5;
  for (int k = 0; k < balls; ++k)
    put_body(world, elastic_prototype, {(k - 2) * 0.6, 0.3, 8}, {0, 0, 0}, Activation::asleep);
  put_body(world, elastic_prototype, {-5, 0.3, 8}, {5, 0, 0});
  const auto [split, whole] = both(world, timing, 80 + film_begins);
  return {"Newton's cradle across a seam", "m/s between velocities after the blow",
          worst_velocity_difference(split, whole, world.bodies.size()), 0.25};
}

/// The tick at which each one lies; far_off if it stands at the end.
std::vector<double> falls(const Film& film, std::uint32_t dominoes) {
  std::vector<double> when(dominoes, far_off);
  for (std::uint32_t n = 0; n < dominoes; ++n) {
    for (int t = film.ticks() - 1; t >= film_begins; --t) {
      const BodyState* state = film.at(t, BodyId::world(n));
      if (state == nullptr) continue;
      if ((state->orientation * Eigen::Vector3f::UnitY()).y() > 0.7f) break;
      when[n] = t;
    }
  }
  return when;
}

Comparison dominoes(MigrationMode mode, NetworkTiming timing) {
  WorldDefinition world = stage(mode);
  constexpr std::uint32_t count = 24;
  const float turn = static_cast<float>(-M_PI / 4);  // The row runs through the corner, from one
                                                     // region into the one across.
  for (std::uint32_t k = 0; k < count; ++k) {
    const double u = (k - (count - 1) / 2.0) * 0.42 * M_SQRT1_2;
    put_body(world, domino_prototype, {u, 0.4, u}, {0, 0, 0}, Activation::asleep);
    world.bodies.back().state.orientation =
        Eigen::Quaternionf(Eigen::AngleAxisf(turn, Eigen::Vector3f::UnitY()));
  }
  BodyState& first = world.bodies.front().state;
  first.activation = Activation::awake;
  first.linear_velocity = Eigen::Vector3f(0.6f, 0, 0.6f);
  first.angular_velocity = Eigen::Vector3f(1.6f, 0, -1.6f);
  const auto [split, whole] = both(world, timing, 360 + film_begins);
  const std::vector<double> a = falls(split, count), b = falls(whole, count);
  double worst = 0;
  for (std::uint32_t n = 0; n < count; ++n) {
    worst = std::max(worst, std::abs(a[n] - b[n]));
    const bool fell = a[n] < far_off && b[n] < far_off;
    const bool in_order = n == 0 || a[n] >= a[n - 1];
    if (!fell || !in_order) worst = far_off;
  }
  // Each blow passes a little of the difference on; a quarter of a second after five is not seen.
  return {"dominoes across the corner", "ticks between the falls of any one", worst, 16};
}

Comparison stacks(MigrationMode mode, NetworkTiming timing) {
  WorldDefinition world = stage(mode);
  const std::pair<double, double> places[] = {{0.05, 0.04}, {0.03, 9}, {-8, 0.02}};
  for (const auto& [x, z] : places)
    for (int layer = 0; layer < 5; ++layer)
      put_body(world, brick_prototype, {x, 0.152 + layer * 0.302, z});
  // Two that lean on each other across the seam.
  put_body(world, brick_prototype, {-0.202, 0.152, -9});
  put_body(world, brick_prototype, {0.202, 0.152, -9});
  const auto [split, whole] = both(world, timing, 250 + film_begins);
  const double worst = worst_distance(split, whole, split.ticks() - 1, world.bodies.size());
  return {"stacks that come to rest", "mm apart at the end", 1000 * worst, 5};
}

}  // namespace

std::vector<Comparison> compare_with_single_server(MigrationMode mode, NetworkTiming timing) {
  return {flights(mode, timing), collisions(mode, timing, false), collisions(mode, timing, true),
          cradle(mode, timing),  dominoes(mode, timing),          stacks(mode, timing)};
}

}  // namespace aureole
