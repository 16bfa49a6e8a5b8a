// Scenes, and what is measured of them.
#include "server/experiment/oracles/single_server_oracle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "server/experiment/oracles/oracle_ownership.h"
#include "server/experiment/oracles/view/film.h"
#include "server/experiment/scenario/scenario.h"
#include "server/worlds/region_tiling.h"

namespace aureole {
namespace {

/// What no difference can be larger than; stands for "did not happen".
constexpr double far_off = 1e3;

/// The largest difference so far, and where it was.
struct Worst {
  double value = 0;
  std::string where;
  void take(double difference, const Film& split, int moment, BodyId id) {
    if (difference <= value) return;
    value = difference;
    where = split.place(moment, id);
  }
};

/// A prototype that the layouts lack: bounces off its like without loss and slides without
/// friction.
constexpr PrototypeId elastic_prototype{6};

WorldDefinition stage(MigrationMode mode) {
  WorldDefinition world = layout_world("corner4");
  world.mode = mode;
  world.max_bodies = 1000;  // Small pools: worlds are started by the dozen here.
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
  return {Film(split, timing, ticks + Film::begins), Film(whole, timing, ticks + Film::begins)};
}

void compare_positions(Worst& worst, const Film& a, const Film& b, int from, std::size_t bodies) {
  for (int t = from; t < a.moments(); ++t) {
    for (std::uint32_t n = 0; n < bodies; ++n) {
      const BodyId id = BodyId::world(n);
      const Film::Shot *one = a.at(t, id), *other = b.at(t, id);
      const bool there = one != nullptr && other != nullptr;
      worst.take(there ? 1000 * distance(one->state.position, other->state.position) : far_off, a,
                 t, id);
    }
  }
}

void compare_last_velocities(Worst& worst, const Film& a, const Film& b, std::size_t bodies) {
  for (std::uint32_t n = 0; n < bodies; ++n) {
    const BodyId id = BodyId::world(n);
    const Film::Shot *one = a.last(id), *other = b.last(id);
    const bool there = one != nullptr && other != nullptr;
    worst.take(there ? (one->state.linear_velocity - other->state.linear_velocity).norm() : far_off,
               a, a.moments() - 1, id);
  }
}

Comparison made(std::string scene, std::string measure, const Worst& worst, double limit) {
  Comparison c;
  c.scene = std::move(scene);
  c.measure = std::move(measure);
  c.worst = worst.value;
  c.limit = limit;
  c.where = worst.where;
  return c;
}

void count_servers(Comparison& c, const Film& split) {
  c.handoffs += split.handoffs();
  c.stand_ins = std::max(c.stand_ins, split.stand_ins_max());
}

constexpr std::uint32_t through_corner = 12;

/// It flies through a place on a boundary after `crosses_s`, as high as it was at first or higher.
void fly_through(WorldDefinition& world, PrototypeId what, Eigen::Vector3d through,
                 Eigen::Vector3f velocity, double crosses_s) {
  const Eigen::Vector3d way(velocity.x(), 0, velocity.z());
  put_body(world, what, WorldPosition::from(Eigen::Vector3d(through - way * crosses_s)), velocity);
}

/// Everyone must fly into another region, and of those through the corner and across each seam some
/// must also go home there in time. (Who flies past others of several servers stays where it is.)
std::string flights_that_stay(const Film& split, const WorldDefinition& world) {
  const PartitionMap map = partition_of(world);
  std::uint64_t handoffs[5] = {};
  for (std::uint32_t n = 0; n < world.bodies.size(); ++n) {
    const BodyId id = BodyId::world(n);
    const Film::Shot *first = split.at(Film::begins, id), *last = split.last(id);
    if (first == nullptr || last == nullptr) return describe(id) + " is not there";
    const WorldPosition &from = first->state.position, &to = last->state.position;
    if (map.region_at(from.x, from.z) == map.region_at(to.x, to.z))
      return describe(id) + " crosses no boundary";
    const std::uint32_t k = n - through_corner;
    handoffs[n < through_corner ? 0 : 1 + k % 4] += split.handoffs(id);
  }
  for (std::size_t g = 0; g < std::size(handoffs); ++g)
    if (handoffs[g] == 0)
      return g == 0 ? "nobody that flew through the corner changed the owner"
                    : fmt::format("nobody that flew across seam {} changed the owner", g);
  return {};
}

Comparison flights(MigrationMode mode, NetworkTiming timing) {
  WorldDefinition world = stage(mode);
  const auto shape = [](int k) { return k % 2 == 0 ? sphere_prototype : cuboid_prototype; };
  const float up = 14;  // In the air for more than 2.8 s.
  // Through the corner from all sides, and across each of the four seams in both directions: far
  // enough from each other that they never meet.
  for (int k = 0; k < static_cast<int>(through_corner); ++k) {
    const double angle = k * M_PI / 6 + 0.1;
    const float speed = 4.0f + 1.2f * static_cast<float>(k);
    fly_through(world, shape(k), {0, 1 + 1.5 * k, 0},
                {-speed * static_cast<float>(std::cos(angle)), up,
                 -speed * static_cast<float>(std::sin(angle))},
                0.3 + 0.01 * k);
  }
  for (int k = 0; k < 16; ++k) {
    const double along = (k / 2 % 2 == 0 ? 1 : -1) * (10 + 3 * (k / 4));
    const float speed = (k / 4 % 2 == 0 ? 1.0f : -1.0f) * (4.0f + static_cast<float>(k));
    const bool on_x = k % 2 == 0;  // Crosses x = 0, else z = 0; with a little way along the seam.
    fly_through(world, shape(k / 2), {on_x ? 0 : along, 1.2 + 0.1 * k, on_x ? along : 0},
                {on_x ? speed : 1.0f, up, on_x ? 1.0f : speed}, 0.35);
  }
  // They go home a second later. The tick from which each touches the ground differs; the film ends
  // before the first of them.
  const auto [split, whole] = both(world, timing, 165);
  Worst worst;
  compare_positions(worst, split, whole, Film::begins, world.bodies.size());
  Comparison c = made("ballistic flights", "mm apart at any tick", worst, 5);
  count_servers(c, split);
  c.idle = flights_that_stay(split, world);
  return c;
}

Comparison collisions(MigrationMode mode, NetworkTiming timing, bool on_corner) {
  Comparison c =
      made(on_corner ? "two bodies collide on the corner" : "two bodies collide on a seam",
           "m/s between outgoing velocities", {}, 0.05);
  Worst worst;
  for (const float speed : {2.0f, 6.0f, 14.0f}) {
    for (const double offset : {0.0, 0.15}) {
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
      const auto [split, whole] = both(world, timing, 48);
      compare_last_velocities(worst, split, whole, 2);
      count_servers(c, split);
      const Film::Shot* after = whole.last(BodyId::world(0));
      if (after == nullptr || after->state.linear_velocity.dot(way) > 0.9f * speed)
        c.idle = fmt::format("at {} m/s, {} m aside, they do not collide", speed, offset);
      else if (split.handoffs() == 0)
        c.idle = fmt::format("at {} m/s, {} m aside, nobody changed the owner", speed, offset);
    }
  }
  c.worst = worst.value;
  c.where = worst.where;
  return c;
}

Comparison cradle(MigrationMode mode, NetworkTiming timing) {
  WorldDefinition world = stage(mode);
  constexpr int balls = 5;
  for (int k = 0; k < balls; ++k)
    put_body(world, elastic_prototype, {(k - 2) * 0.6, 0.3, 8}, {0, 0, 0}, Activation::asleep);
  put_body(world, elastic_prototype, {-5, 0.3, 8}, {5, 0, 0});
  const auto [split, whole] = both(world, timing, 80);
  Worst worst;
  compare_last_velocities(worst, split, whole, world.bodies.size());
  Comparison c =
      made("Newton's cradle across a seam", "m/s between velocities after the blow", worst, 0.25);
  count_servers(c, split);
  if (c.handoffs == 0) c.idle = "nobody changed the owner";
  const Film::Shot* far_end = whole.last(BodyId::world(balls - 1));
  if (far_end == nullptr || far_end->state.linear_velocity.x() < 1)
    c.idle = "the blow never came through";
  return c;
}

/// The tick at which each one lies; far_off if it stands at the end.
std::vector<double> falls(const Film& film, std::uint32_t dominoes) {
  std::vector<double> when(dominoes, far_off);
  for (std::uint32_t n = 0; n < dominoes; ++n) {
    for (int t = film.moments() - 1; t >= Film::begins; --t) {
      const Film::Shot* shot = film.at(t, BodyId::world(n));
      if (shot == nullptr) continue;
      if ((shot->state.orientation * Eigen::Vector3f::UnitY()).y() > 0.7f) break;
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
  const auto [split, whole] = both(world, timing, 360);
  const std::vector<double> a = falls(split, count), b = falls(whole, count);
  Worst worst;
  for (std::uint32_t n = 0; n < count; ++n) {
    const bool fell = a[n] < far_off && b[n] < far_off;
    const bool in_order = n == 0 || a[n] >= a[n - 1];
    const int moment = a[n] < far_off ? static_cast<int>(a[n]) : split.moments() - 1;
    worst.take(fell && in_order ? std::abs(a[n] - b[n]) : far_off, split, moment, BodyId::world(n));
  }
  // Each blow passes a little of the difference on: one tick was measured at the last of them.
  Comparison c = made("dominoes across the corner", "ticks between the falls of any one", worst, 3);
  count_servers(c, split);
  if (c.handoffs == 0) c.idle = "nobody changed the owner";
  return c;
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
  // And one whose layers belong to either side in turn.
  for (int layer = 0; layer < 4; ++layer)
    put_body(world, brick_prototype, {layer % 2 == 0 ? 0.04 : -0.04, 0.152 + layer * 0.302, -14});
  const auto [split, whole] = both(world, timing, 250);
  Worst worst;
  compare_positions(worst, split, whole, split.moments() - 1, world.bodies.size());
  Comparison c = made("stacks that come to rest", "mm apart at the end", worst, 5);
  count_servers(c, split);
  if (c.handoffs == 0) c.idle = "nobody changed the owner";
  return c;
}

}  // namespace

std::string describe(const Comparison& c) {
  std::string told = fmt::format("{}: {:.3f} {}, allowed {}", c.scene, c.worst, c.measure, c.limit);
  if (!c.where.empty()) told += ", worst " + c.where;
  if (!c.idle.empty()) told += "; shows nothing, because " + c.idle;
  return told;
}

std::vector<Comparison> compare_with_single_server(MigrationMode mode, NetworkTiming timing) {
  return {flights(mode, timing), collisions(mode, timing, false), collisions(mode, timing, true),
          cradle(mode, timing),  dominoes(mode, timing),          stacks(mode, timing)};
}

}  // namespace aureole
