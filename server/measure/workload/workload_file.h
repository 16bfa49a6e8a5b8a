// A workload's world as the world file that region servers read.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "server/worlds/world.h"

namespace aureole {

/// Read back it has the same regions, tolerances, injectors and bodies. Knows what workloads have:
/// a ground plane, and spheres, boxes and capsules that are injected.
nlohmann::json workload_file(const WorldDefinition& world);

}  // namespace aureole
