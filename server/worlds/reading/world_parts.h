// The sections of a world file, each read by one function into the world that is being completed.
#pragma once

#include <map>
#include <string>

#include "server/worlds/reading/body_reader.h"
#include "server/worlds/reading/json_reader.h"
#include "server/worlds/world.h"

namespace aureole {

/// What the sections share while one file is read.
struct WorldReading {
  WorldReading(const JsonNode& root, WorldDefinition& w) : parts(root), world(w) {}
  NamedParts parts;
  PrototypeTable prototypes;
  WorldDefinition& world;
  std::map<std::string, RegionId> region_names;
};

void read_physics(const JsonNode& node, PhysicsSettings& settings);
void read_tolerances(const JsonNode& node, AuraTolerances& tolerances);
MigrationMode read_mode(const JsonNode& node);
Box3 read_box(const JsonNode& node, const NumberRange& range);
Rectangle read_area(const JsonNode& node);

/// Names are checked to be single; the tiling is checked by the caller.
void read_regions(const JsonNode& node, WorldReading& reading);
void read_statics(const JsonNode& node, WorldReading& reading);
/// Needs bounds, regions, tolerances and max_bodies to have been read.
void read_bodies(const JsonNode& node, WorldReading& reading);
void read_injectors(const JsonNode& node, WorldReading& reading);
void read_spawn_points(const JsonNode& node, WorldReading& reading);
/// Either the file's four, or a rubber ball, a heavy ball, a crate and a plank.
void read_throwables(const JsonNode* node, WorldReading& reading, const JsonNode& root);
/// The file's avatar, or a capsule of 1.8 m and 80 kg.
void read_avatar(const JsonNode* node, WorldReading& reading, const JsonNode& root);

/// FNV-1a over the completed world in one canonical order, `hash` itself left out.
std::uint64_t world_hash(const WorldDefinition& world);

}  // namespace aureole
