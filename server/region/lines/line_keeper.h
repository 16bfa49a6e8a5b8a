// Who moves a line in a row of regions, and what it goes by.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/aura/partition/partition_lines.h"
#include "server/base/ids.h"
#include "server/physics/body.h"
#include "server/region/lines/quiet_place.h"

namespace aureole {

/// The server whose region ends at a line, towards greater coordinates, keeps it: it says where it
/// lies. Only in worlds without corners, where each line has one server on each side.
class LineKeeper {
 public:
  LineKeeper(const PartitionLines& lines, std::size_t regions, RegionId self);

  std::optional<std::size_t> line() const { return line_; }
  /// Whose line a region begins at.
  std::optional<RegionId> keeper_below_of(RegionId region) const {
    const RegionId keeper = keepers_below_[region.value];
    return keeper == region ? std::nullopt : std::optional(keeper);
  }

  /// At every status of ours: who is awake here.
  void note_awake(std::span<const NewBody> awake);
  /// What we have awake near the line that our region begins at, for who keeps that.
  const Crowd& crowd_below() const { return begins_; }
  /// How many bodies awake our line will still bring us where it goes.
  std::int32_t gain() const;

  /// What a status says.
  void hear(RegionId from, double awake, std::int32_t gain, const Crowd& crowd_below);
  /// Places are looked for from so many bodies awake on (mean of all servers, > 0).
  void look_from(double awake, const QuietPlaceLimits& limits = {}) {
    awake_min_ = awake;
    limits_ = limits;
  }

  /// Whether so little is awake now that the line stays where it is.
  bool idle() const;
  /// Where the line is to lie a term from now, if it lies here: a step on its way.
  double next_m(double here_m);
  /// A line moves no further than this in a term (m).
  static constexpr double step_m = 12;

 private:
  struct Load {
    double awake_now = 0;
    double awake = 0;  ///< Smoothed.
    double gain = 0;
    std::int64_t looks = 0;
  };
  double expected(RegionId region) const;
  LineSituation situation(double here_m) const;

  PartitionLines lines_;
  RegionId self_;
  std::optional<std::size_t> line_, line_below_;
  std::vector<RegionId> keepers_below_;  ///< By region; its own number: nobody.
  std::vector<Load> loads_;
  Crowd ends_, begins_, beyond_;  ///< Ours at our line, at the one below; the other side of ours.
  std::int64_t looks_ = 0;
  double awake_min_ = 64;
  QuietPlaceLimits limits_;
  std::optional<double> target_m_;
};

}  // namespace aureole
