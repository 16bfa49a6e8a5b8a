// The room that a body may touch before anybody could act on it: a capsule.
#pragma once

#include <Eigen/Core>

#include "server/aura/shapes/aura_box.h"

namespace aureole {

/// Everything less than `girth_m` from the segment `centre` ± `half_spine` (world coordinates, m).
/// A sphere has no spine. Around a plank or a rolling log it is far smaller than a sphere, or than
/// a box along the axes of the world.
struct AuraCapsule {
  Eigen::Vector3d centre{0, 0, 0};
  Eigen::Vector3d half_spine{0, 0, 0};
  double girth_m = 0;  ///< ≥ 0

  AuraBox box() const { return {centre, half_spine.cwiseAbs().array() + girth_m}; }
};

/// Distance between the two (m); negative if they overlap.
double gap_m(const AuraCapsule& a, const AuraCapsule& b);

/// Where they are crowded most are so near that their middles say it.
inline bool overlap(const AuraCapsule& a, const AuraCapsule& b) {
  const double girths_m = a.girth_m + b.girth_m;
  return (a.centre - b.centre).squaredNorm() <= girths_m * girths_m || gap_m(a, b) <= 0;
}

}  // namespace aureole
