// Which part of a region's world its decisions depend on.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/aura/migration_policy.h"
#include "server/aura/partition/partition_map.h"

namespace aureole {

/// Everything outside the region, and what is less than `depth_m` from its boundary or from an aura
/// that another server projects: whatever happens elsewhere comes to nobody's notice before this
/// strip is looked at again. Found in a constant time for each body.
class BoundaryStrip final : public View {
 public:
  BoundaryStrip(const PartitionMap& map, RegionId self);

  /// Once a tick: where others have something inside our region, and how deep the strip is now.
  void note(std::span<const RemoteAura> remote, double depth_m);

  bool holds(double x, double z) const override {
    return !inner_.contains(x, z) || (visited_ && is_marked_at(x, z));
  }
  bool holds(const WorldPosition& at) const { return holds(at.x, at.z); }
  bool shows(const AuraBox& room) const override;

 private:
  /// Edge of a square that is marked as a whole (unit: m).
  static constexpr double square_m = 8;
  static constexpr std::int64_t side_max = 512;
  bool is_marked(std::int64_t column, std::int64_t row) const;
  /// The same of where somebody is. All who are awake are asked about in every decision: without
  /// calls, and most are outside of all that is marked.
  bool is_marked_at(double x, double z) const {
    if (marked_.empty()) return true;
    const double c = (x - low_x_) / square_m, r = (z - low_z_) / square_m;
    if (!(c >= 0 && c < static_cast<double>(columns_) && r >= 0 && r < static_cast<double>(rows_)))
      return false;
    return marked_[static_cast<std::size_t>(static_cast<std::int64_t>(r) * columns_ +
                                            static_cast<std::int64_t>(c))] != 0;
  }
  std::int64_t column(double x) const;
  std::int64_t row(double z) const;

  Rectangle area_;
  Rectangle inner_;  ///< Without the strip along the boundary.
  bool visited_ = false;
  double low_x_ = 0, low_z_ = 0;
  std::int64_t columns_ = 0, rows_ = 0;
  std::vector<std::uint8_t> marked_;  ///< Bytes: several squares of a row are set at once.
  std::vector<Rectangle> reached_;    ///< Only used within note().
};

}  // namespace aureole
