// Segments against each other.
#include "server/aura/shapes/aura_capsule.h"

#include <algorithm>

namespace aureole {
namespace {

double within_one(double share) {
  return std::clamp(share, 0.0, 1.0);
}

}  // namespace

// Closest points of two segments: Ericson, Real-Time Collision Detection (2005), section 5.1.9.
double gap_m(const AuraCapsule& a, const AuraCapsule& b) {
  const Eigen::Vector3d along_a = 2 * a.half_spine, along_b = 2 * b.half_spine;
  const Eigen::Vector3d apart = (a.centre - a.half_spine) - (b.centre - b.half_spine);
  const double aa = along_a.squaredNorm(), bb = along_b.squaredNorm();
  const double a_apart = along_a.dot(apart), b_apart = along_b.dot(apart);
  constexpr double point = 1e-9;
  double on_a = 0, on_b = 0;
  if (aa <= point && bb > point) {
    on_b = within_one(b_apart / bb);
  } else if (bb <= point && aa > point) {
    on_a = within_one(-a_apart / aa);
  } else if (aa > point) {
    const double ab = along_a.dot(along_b);
    const double crossing = aa * bb - ab * ab;  // 0 for parallels
    if (crossing > point) on_a = within_one((ab * b_apart - a_apart * bb) / crossing);
    on_b = (ab * on_a + b_apart) / bb;
    if (on_b < 0) {
      on_b = 0;
      on_a = within_one(-a_apart / aa);
    } else if (on_b > 1) {
      on_b = 1;
      on_a = within_one((ab - a_apart) / aa);
    }
  }
  return (apart + on_a * along_a - on_b * along_b).norm() - a.girth_m - b.girth_m;
}

}  // namespace aureole
