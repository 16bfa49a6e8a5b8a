// Where the bodies that a server hosts are, roughly: what is far from all of them need not stand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/base/world_position.h"
#include "server/worlds/world.h"

namespace aureole {

/// The plane in squares. Near is the square of whoever was noted, and two more in every direction.
class Whereabouts {
 public:
  /// `bounds` of the world: beyond them the squares along them count. `largest_radius_m`: no body
  /// reaches further from its centre.
  Whereabouts(const Box3& bounds, double largest_radius_m);

  void note(const WorldPosition& centre) {
    const std::size_t at = square_at(centre);
    if (!noted_[at]) mark(at);
  }
  void forget_all();
  /// Whether somebody who was noted may be less than an edge away from what is centred there.
  bool is_near(const WorldPosition& centre) const { return near_[square_at(centre)] != 0; }
  /// Whether more has become near since this was last asked.
  bool take_grown();
  /// Of a square (unit: m): at least 8, and two bodies side by side fit into one.
  double edge_m() const { return edge_m_; }

 private:
  static constexpr std::size_t side_max = 256;
  std::size_t index(double offset_m, std::size_t side) const;
  std::size_t square_at(const WorldPosition& centre) const {
    return index(centre.z - low_z_, rows_) * columns_ + index(centre.x - low_x_, columns_);
  }
  void mark(std::size_t square);

  double low_x_, low_z_, edge_m_;
  double per_edge_ = 0;  ///< 1/m: to divide for every body in every step takes its time.
  std::size_t columns_, rows_;
  std::vector<std::uint8_t> noted_, near_;
  bool grown_ = false;
};

inline std::size_t Whereabouts::index(double offset_m, std::size_t side) const {
  const double at = offset_m * per_edge_;
  // Written so that what is not a number comes to the first square.
  if (!(at > 0)) return 0;
  return at < static_cast<double>(side) ? static_cast<std::size_t>(at) : side - 1;
}

}  // namespace aureole
