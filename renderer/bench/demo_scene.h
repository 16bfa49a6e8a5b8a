// A playground made up from a number: what benchmarks, golden images and pictures draw.
#pragma once

#include <vector>

#include "renderer/mesh/mesh.h"
#include "renderer/renderer.h"
#include "renderer/scene.h"

namespace aureole::render {

struct DemoScene {
  std::vector<MeshDescription> meshes;
  StaticGeometry geometry;
  Scene scene;
  Camera camera;  ///< A view over all of it.
};

/// Stacks of crates, a line of dominoes, a ball pit, ramps, avatars, hulls and compounds around the
/// origin, then as many strewn bodies as are missing to `bodies` (at least those of the playground,
/// 273, when `bodies` is less). Equal arguments give equal scenes on every machine.
DemoScene make_demo_scene(int bodies);

/// The camera of the `frame`-th frame of a walk around the demo scene.
Camera demo_walk(int frame);

}  // namespace aureole::render
