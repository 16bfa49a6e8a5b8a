// A world as plain data: what a world file says after it has been read, checked and completed.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "server/aura/migration_mode.h"
#include "server/aura/partition/partition_map.h"
#include "server/aura/shapes/aura_radius.h"
#include "server/base/ids.h"
#include "server/base/world_position.h"
#include "server/physics/body.h"
#include "server/physics/physics_world.h"

namespace aureole {

struct RegionDefinition {
  std::string name;
  Rectangle area;
};

/// 24-bit colour as written in a world file ("#rrggbb").
struct Colour {
  std::uint8_t r = 200, g = 200, b = 200;
  friend bool operator==(const Colour&, const Colour&) = default;
};

struct Prototype {
  std::string name;
  BodyDefinition body;
  Colour colour;
};

struct WorldStatic {
  std::string name;
  StaticDefinition body;
  Colour colour;
};

struct WorldBody {
  PrototypeId prototype;
  BodyState state;
  /// Region that hosts it at the start instead of the one its centre is in (tests of handoffs).
  std::optional<RegionId> host;
};

/// The bodies that one named entry of a file made: `count` of them from index `first` on.
struct BodyGroup {
  std::string name;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

struct Box3 {
  Eigen::Vector3d min{0, 0, 0}, max{0, 0, 0};
};

/// Makes bodies at a constant rate from a seeded stream; every server can compute the whole stream
/// and makes those bodies that start in its own region.
struct Injector {
  std::string name;
  double rate_per_s = 1;                                         ///< > 0
  Box3 volume;                                                   ///< Positions, uniform (m).
  Eigen::Vector3f velocity_min{0, 0, 0}, velocity_max{0, 0, 0};  ///< Uniform (m/s).
  struct Share {
    PrototypeId prototype;
    double weight = 1;
  };
  std::vector<Share> mix;
  std::uint64_t seed = 1;
  double start_s = 0;
  double duration_s = std::numeric_limits<double>::infinity();
};

struct SpawnPoint {
  WorldPosition position;
  float yaw_rad = 0;
};

/// What a player can throw, keys 1 to 4.
struct Throwable {
  std::string name;
  PrototypeId prototype;
  float speed_mps = 20;
};

struct WorldDefinition {
  std::string name;
  std::string description;
  PhysicsSettings physics;
  AuraTolerances tolerances;
  MigrationMode mode = MigrationMode::adaptive;
  std::vector<RegionDefinition> regions;  ///< They tile the plane.
  Box3 bounds;                            ///< Strays outside are removed.
  std::uint32_t max_bodies = 20'000;
  std::uint32_t max_thrown_per_player = 40;
  std::vector<Prototype> prototypes;  ///< Those of bodies, injectors, throwables and the avatar.
  std::vector<WorldStatic> statics;
  std::vector<WorldBody> bodies;       ///< BodyId::world(index)
  std::vector<BodyGroup> body_groups;  ///< Entries that have a name, in the file's order.
  std::vector<Injector> injectors;
  std::vector<SpawnPoint> spawn_points;  ///< At least one.
  std::array<Throwable, 4> throwables;
  PrototypeId avatar;      ///< Upright capsule.
  std::uint64_t hash = 0;  ///< Over everything above; servers of one world agree on it.
};

/// What one region's physics makes room for from the beginning: twice its share of the world, which
/// may grow. Room for everything in each of 64 regions would be gigabytes.
inline std::size_t bodies_expected_by(const WorldDefinition& world) {
  constexpr std::size_t least = 1024, most = 8192;
  const std::size_t share = world.max_bodies / std::max<std::size_t>(1, world.regions.size());
  return std::clamp(2 * share, least, most);
}

/// The region whose area holds the point. Areas tile the plane, so there is always exactly one.
RegionId region_at(const std::vector<RegionDefinition>& regions, double x, double z);

}  // namespace aureole
