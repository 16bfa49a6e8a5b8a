// The convex hull of a handful of points.
#include "renderer/mesh/convex_hull.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace aureole::render {
namespace {

using Eigen::Vector3d;

struct Face {
  HullTriangle corners;
  Vector3d normal;
  double offset;
};

class HullBuilder {
 public:
  explicit HullBuilder(std::span<const Eigen::Vector3f> points) {
    points_.reserve(points.size());
    double size = 0;
    for (const auto& p : points) {
      if (!p.allFinite()) return;
      points_.push_back(p.cast<double>());
      size = std::max(size, points_.back().norm());
    }
    // Input in floats: what lies nearer to a face than float rounding counts as on it.
    tolerance_ = 1e-6 * size;
  }

  std::vector<HullTriangle> build() {
    if (points_.size() < 4 || tolerance_ <= 0 || !start()) return {};
    for (int i = 0; i < static_cast<int>(points_.size()); ++i) add(i);
    std::vector<HullTriangle> result;
    result.reserve(faces_.size());
    for (const Face& face : faces_) result.push_back(face.corners);
    return result;
  }

 private:
  double distance(const Face& face, int i) const {
    return face.normal.dot(points_[static_cast<std::size_t>(i)]) - face.offset;
  }
  const Vector3d& point(int i) const { return points_[static_cast<std::size_t>(i)]; }

  bool make_face(int a, int b, int c) {
    Vector3d normal = (point(b) - point(a)).cross(point(c) - point(a));
    const double length = normal.norm();
    if (length <= tolerance_ * tolerance_) return false;
    normal /= length;
    faces_.push_back({{a, b, c}, normal, normal.dot(point(a))});
    return true;
  }

  template <class Measure>
  int furthest(Measure measure) const {
    int best = 0;
    double best_value = -1;
    for (int i = 0; i < static_cast<int>(points_.size()); ++i) {
      const double value = measure(point(i));
      if (value > best_value) best = i, best_value = value;
    }
    return best_value > tolerance_ ? best : -1;
  }

  // Four points far apart: the widest pair from the first point, then off that line, then off that
  // plane.
  bool start() {
    const int a = 0;
    const int b = furthest([&](const Vector3d& p) { return (p - point(a)).norm(); });
    if (b < 0) return false;
    const Vector3d line = (point(b) - point(a)).normalized();
    const int c = furthest([&](const Vector3d& p) { return (p - point(a)).cross(line).norm(); });
    if (c < 0) return false;
    const Vector3d normal = line.cross(point(c) - point(a)).normalized();
    const int d = furthest([&](const Vector3d& p) { return std::abs((p - point(a)).dot(normal)); });
    if (d < 0) return false;
    const bool above = (point(d) - point(a)).dot(normal) > 0;
    const int second = above ? c : b, third = above ? b : c;
    return make_face(a, second, third) && make_face(a, third, d) && make_face(third, second, d) &&
           make_face(second, a, d);
  }

  void add(int i) {
    // An edge of a removed face that no other removed face shares (in reverse) borders the hole.
    std::map<std::pair<int, int>, bool> removed_edges;
    std::vector<Face> kept;
    for (const Face& face : faces_) {
      if (distance(face, i) <= tolerance_) {
        kept.push_back(face);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k)
        removed_edges[{face.corners[k], face.corners[(k + 1) % 3]}] = true;
    }
    if (removed_edges.empty()) return;
    std::vector<Face> before = std::move(faces_);
    faces_ = std::move(kept);
    for (const auto& [edge, unused] : removed_edges) {
      if (removed_edges.contains({edge.second, edge.first})) continue;
      if (!make_face(edge.first, edge.second, i)) {
        // The point lies on the border's line: leaving it out changes nothing that can be seen.
        faces_ = std::move(before);
        return;
      }
    }
  }

  std::vector<Vector3d> points_;
  std::vector<Face> faces_;
  double tolerance_ = 0;
};

}  // namespace

std::vector<HullTriangle> convex_hull(std::span<const Eigen::Vector3f> points) {
  return HullBuilder(points).build();
}

}  // namespace aureole::render
