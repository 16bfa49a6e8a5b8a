// Two regions side by side, a ground, a wall, and a few kinds of bodies.
#pragma once

#include "server/worlds/world.h"

namespace aureole::test {

inline constexpr PrototypeId avatar_kind{0};
inline constexpr PrototypeId ball_kind{1};   ///< Sphere of 0.3 m, 2 kg.
inline constexpr PrototypeId crate_kind{2};  ///< Box of 0.5 m half edges, 20 kg.
inline constexpr PrototypeId rock_kind{3};   ///< Box of 0.5 m half edges, 500 kg.

/// Regions "west" (x < 0) and "east"; spawn point at (-5, 1, 0) unless `spawn_x` says otherwise.
WorldDefinition small_world(double spawn_x = -5);
/// The same with four regions around the origin, west before east, north (z < 0) before south.
WorldDefinition small_world_with_corner();

}  // namespace aureole::test
