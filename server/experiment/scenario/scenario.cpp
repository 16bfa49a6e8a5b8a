// Draws what happens in a seed: heaps poured over boundaries, flights, rows that are struck,
// players.
#include "server/experiment/scenario/scenario.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "server/experiment/random.h"
#include "server/worlds/region_tiling.h"
#include "server/worlds/world_file.h"

namespace aureole {
namespace {

/// Bodies come into the world in this share of the run, so that the rest can come to rest.
constexpr double pour_share = 0.35;
/// Boundaries without an end are used up to here (m).
constexpr double boundary_reach_m = 24;

class Author {
 public:
  Author(Scenario& scenario, const ScenarioOptions& options)
      : s_(scenario),
        o_(options),
        random_(options.seed, 3),
        spots_(boundary_spots(partition_of(scenario.world), boundary_reach_m)) {}

  void write() {
    // Three of six pour and do nothing else; the players' seeds pour too.
    switch (o_.seed % 6) {
      case 1:
        s_.kind = "flights";
        return flights(o_.bodies, pour_share);
      case 3:
        s_.kind = "rows";
        return rows();
      case 5:
        s_.kind = "players";
        return players();
      default:
        s_.kind = "pour";
        return pour(o_.bodies, 1 + random_.below(2));
    }
  }

 private:
  BoundarySpot any_spot() {
    // Corners are where most can go wrong: half of the time one of them, if there is any.
    const auto corners =
        std::count_if(spots_.begin(), spots_.end(), [](const BoundarySpot& s) { return s.corner; });
    if (corners > 0 && random_.chance(0.5))
      return spots_[static_cast<std::size_t>(random_.below(static_cast<int>(corners)))];
    return spots_[static_cast<std::size_t>(random_.below(static_cast<int>(spots_.size())))];
  }

  Injector& injector(double count, double start_s, double duration_s) {
    Injector& made = s_.world.injectors.emplace_back();
    made.name = "injector " + std::to_string(s_.world.injectors.size());
    made.start_s = start_s;
    made.duration_s = duration_s;
    made.rate_per_s = std::max(count, 0.5) / duration_s;
    made.seed = random_.bits();
    made.mix = {{sphere_prototype, 1}, {cuboid_prototype, 1}, {capsule_prototype, 1}};
    return made;
  }

  /// Columns 2 to 4 m wide above a corner or boundary. Either they straddle it, or there is one on
  /// each side, off the line so that nothing is born inside another server's body, and what falls
  /// is thrown towards the line.
  void pour(int bodies, int heaps) {
    for (int heap = 0; heap < heaps; ++heap) {
      const BoundarySpot spot = any_spot();
      const double half = random_.between(1, 2);
      const double count = static_cast<double>(bodies) / heaps;
      const double lasts = pour_share * o_.seconds;
      if (random_.chance(0.4)) {
        Injector& all = injector(count, 0.1, lasts);
        all.volume = {{spot.x - half, 4, spot.z - half}, {spot.x + half, 9, spot.z + half}};
        all.velocity_min = {-1, -5, -1};
        all.velocity_max = {1, -2, 1};
        continue;
      }
      for (const double sx : {-1.0, 1.0}) {
        for (const double sz : {-1.0, 1.0}) {
          constexpr double off_line_m = 0.6;
          Injector& quarter = injector(count / 4, 0.1, lasts);
          const Eigen::Vector3d near(spot.x + sx * off_line_m, 4, spot.z + sz * off_line_m);
          const Eigen::Vector3d far(spot.x + sx * (off_line_m + half), 9,
                                    spot.z + sz * (off_line_m + half));
          quarter.volume = {near.cwiseMin(far), near.cwiseMax(far)};
          const Eigen::Vector3f slow(static_cast<float>(-sx * 0.2), -5,
                                     static_cast<float>(-sz * 0.2));
          const Eigen::Vector3f fast(static_cast<float>(-sx * 2.5), -2,
                                     static_cast<float>(-sz * 2.5));
          quarter.velocity_min = slow.cwiseMin(fast);
          quarter.velocity_max = slow.cwiseMax(fast);
        }
      }
    }
  }

  /// Bodies that criss-cross over a few spots at up to 20 m/s and roll on.
  void flights(int bodies, double share) {
    const int jets = 6;
    for (int jet = 0; jet < jets; ++jet) {
      const BoundarySpot spot = any_spot();
      const double angle = random_.between(0, 2 * M_PI);
      const double away = random_.between(6, 11);
      const double speed = random_.between(6, 18);
      Injector& made =
          injector(static_cast<double>(bodies) / jets, 0.2 + random_.unit(), share * o_.seconds);
      const Eigen::Vector3d centre(spot.x + away * std::cos(angle), 1.5,
                                   spot.z + away * std::sin(angle));
      made.volume = {centre - Eigen::Vector3d(0.8, 0, 0.8), centre + Eigen::Vector3d(0.8, 2, 0.8)};
      const Eigen::Vector3f aim(static_cast<float>(-speed * std::cos(angle)), 3,
                                static_cast<float>(-speed * std::sin(angle)));
      made.velocity_min = aim - Eigen::Vector3f(1.2f, 1.5f, 1.2f);
      made.velocity_max = aim + Eigen::Vector3f(1.2f, 3, 1.2f);
    }
  }

  /// Shoots `count` spheres at a place, from the side, beginning at `start_s`.
  void strike(const BoundarySpot& at, double angle, int count, double start_s) {
    const double speed = random_.between(10, 18);
    Injector& gun = injector(count, start_s, 0.6 * count);
    gun.mix = {{sphere_prototype, 1}};
    const Eigen::Vector3d from(at.x + 9 * std::cos(angle), 1.2, at.z + 9 * std::sin(angle));
    gun.volume = {from, from + Eigen::Vector3d(0.1, 0.1, 0.1)};
    const Eigen::Vector3f aim(static_cast<float>(-speed * std::cos(angle)), 1.5f,
                              static_cast<float>(-speed * std::sin(angle)));
    gun.velocity_min = aim - Eigen::Vector3f(0.5f, 0.5f, 0.5f);
    gun.velocity_max = aim + Eigen::Vector3f(0.5f, 0.5f, 0.5f);
  }

  void stand(PrototypeId what, double x, double y, double z) {
    put_body(s_.world, what, {x, y, z}, {0, 0, 0}, Activation::asleep);
  }

  /// Dominoes, towers, walls and touching balls that sleep across boundaries until they are struck.
  void rows() {
    const int spots = std::clamp(static_cast<int>(spots_.size()), 1, 4);
    const double begin = 1 + random_.unit();
    std::vector<std::pair<double, double>> taken;
    for (int n = 0; n < spots; ++n) {
      const BoundarySpot spot = any_spot();
      const bool occupied = std::any_of(taken.begin(), taken.end(), [&](const auto& t) {
        return std::hypot(t.first - spot.x, t.second - spot.z) < 12;
      });
      if (occupied) continue;
      taken.emplace_back(spot.x, spot.z);
      const bool along_x = random_.chance(0.5);
      const auto at = [&](double u, double v) {
        return along_x ? std::pair(spot.x + u, spot.z + v) : std::pair(spot.x + v, spot.z + u);
      };
      switch (random_.below(4)) {
        case 0:
          dominoes(spot);
          break;
        case 1:
          for (int layer = 0; layer < 8; ++layer)
            for (int k = -1; k <= 1; ++k) {
              const auto [x, z] = at(k * 0.62, 0.1);
              stand(brick_prototype, x, 0.15 + layer * 0.3, z);
            }
          break;
        case 2:
          for (int layer = 0; layer < 4; ++layer)
            for (int k = -6; k <= 6; ++k)
              stand(brick_prototype, spot.x + k * 0.405 + layer % 2 * 0.2, 0.15 + layer * 0.3,
                    spot.z + 0.05);
          break;
        default:
          for (int k = -5; k <= 5; ++k) {
            const auto [x, z] = at(k * 0.6, 0);
            stand(sphere_prototype, x, 0.3, z);
          }
      }
      strike(spot, along_x ? M_PI : random_.between(0, 2 * M_PI), 3, begin);
      strike(spot, random_.between(0, 2 * M_PI), 3, begin + 2);
    }
    const int rest = std::max(0, o_.bodies - static_cast<int>(s_.world.bodies.size()));
    flights(rest / 3, 0.5);
  }

  /// A row along x through the spot, its first one falling when a ball comes along the row.
  void dominoes(const BoundarySpot& spot) {
    for (int k = -12; k <= 12; ++k) stand(domino_prototype, spot.x + k * 0.4, 0.4, spot.z + 0.02);
    Injector& ball = injector(1, 1.5, 2);
    ball.mix = {{sphere_prototype, 1}};
    const Eigen::Vector3d from(spot.x - 7, 0.5, spot.z + 0.02);
    ball.volume = {from, from};
    ball.velocity_min = ball.velocity_max = {9, 1, 0};
  }

  /// People around a boundary who walk across it, throw, blast and carry things, on a small pour.
  void players() {
    s_.players = 2 + random_.below(2);
    s_.world.spawn_points.clear();
    for (int n = 0; n < s_.players; ++n) {
      const BoundarySpot spot = any_spot();
      s_.world.spawn_points.push_back(
          {{spot.x + random_.between(-4, 4), 0.95, spot.z + random_.between(3, 6)}, 0});
      for (int k = 0; k < 6; ++k)
        put_body(s_.world, k % 2 == 0 ? sphere_prototype : brick_prototype,
                 {spot.x + random_.between(-0.3, 0.3) + (k - 3) * 1.2, 0.35, spot.z + 1.0 - k % 3});
    }
    pour(o_.bodies / 2, 1);
  }

  Scenario& s_;
  const ScenarioOptions& o_;
  Random random_;
  std::vector<BoundarySpot> spots_;
};

}  // namespace

Result<Scenario> make_scenario(const ScenarioOptions& options) {
  Scenario scenario;
  if (is_layout(options.layout)) {
    scenario.world = layout_world(options.layout);
    // Nine servers with pools for tens of thousands spend a tenth of a run on touching them.
    scenario.world.max_bodies = static_cast<std::uint32_t>(4 * std::max(300, options.bodies));
    Author(scenario, options).write();
  } else {
    auto world = load_world(options.layout);
    if (!world && !std::filesystem::exists(options.layout))
      return Error::format("{}; built-in layouts are {}", world.error().message, layout_names());
    if (!world) return world.error();
    scenario.world = std::move(*world);
    scenario.kind = "file";
    scenario.players = options.seed % 2 == 0 ? 1 : 0;
  }
  scenario.world.mode = options.mode;
  if (options.latency_tolerance_ms)
    scenario.world.tolerances.latency_ms = *options.latency_tolerance_ms;
  return scenario;
}

}  // namespace aureole
