// From the world's replicas to what the renderer draws: meshes, colours, boundaries and cameras.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/mesh/mesh.h"
#include "renderer/renderer.h"
#include "renderer/scene.h"
#include "server/aura/partition/partition_map.h"
#include "server/gateway/web/browser_messages.h"
#include "server/replica/replica_store.h"
#include "server/worlds/world.h"

namespace aureole {

/// Colour of the n-th region on the player page, and of its bodies when they are tinted.
Colour region_colour(RegionId region);
/// Colour of a player's avatar; the same in every view and after every restart.
Colour player_colour(PlayerId player);

/// Made once for a world; then a pure function of the poses.
class SceneBuilder {
 public:
  /// `world` must outlive it.
  explicit SceneBuilder(const WorldDefinition& world);

  /// The mesh table and the static geometry that a Renderer is made with.
  std::span<const render::MeshDescription> meshes() const { return meshes_; }
  const render::StaticGeometry& statics() const { return statics_; }

  /// Sort keys are body ids, positions relative to the world's origin. `tinted`: bodies are
  /// coloured by the region that owns them. Boundaries are not in it: they move.
  render::Scene build(std::span<const ReplicaPose> poses, bool tinted) const;

  /// From the eyes of an avatar that is at `pose`.
  render::Camera avatar_camera(const ReplicaPose& pose, Look look) const;
  /// Over the whole world, for players whose avatar is not there yet.
  render::Camera overview_camera() const;
  /// Where that avatar's eye is.
  WorldPosition eye(const WorldPosition& avatar) const;

 private:
  render::MeshIndex mesh_of(const Shape& shape);

  const WorldDefinition& world_;
  std::vector<render::MeshDescription> meshes_;
  std::vector<std::vector<float>> mesh_keys_;  ///< Equal shapes share a mesh, and so a draw call.
  std::vector<render::MeshIndex> mesh_of_prototype_;
  render::StaticGeometry statics_;
  double eye_above_centre_m_ = 0;
};

/// The edges that two regions share, cut off at the world's bounds.
std::vector<render::BoundaryLine> boundary_lines(const PartitionMap& map, const Box3& bounds);

}  // namespace aureole
