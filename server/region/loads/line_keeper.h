// Where a line had better lie that two regions meet at, side by side in a row of regions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/aura/partition/partition_lines.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/physics/body.h"

namespace aureole {

/// How many bodies are awake how far from a line's place in the map, smoothed over 5 s: in bins of
/// 4 m, from 56 m below it to 56 m above.
struct Crowd {
  static constexpr double bin_m = 4;
  static constexpr int bins = 28;
  static constexpr double from_m = -bin_m * bins / 2;
  std::array<double, bins> awake{};

  /// Between two distances from the line's place (m).
  double between(double from, double to) const;
  /// Whoever is so near that it would be about the line if that lay there: within 8 m.
  double at(double place_m) const { return between(place_m - 8, place_m + 8); }
  /// A byte for each bin, in steps of 5 %.
  std::vector<std::uint8_t> encoded() const;
  /// Errors: not as many bytes as there are bins.
  static Result<Crowd> decoded(std::span<const std::uint8_t> bytes);
};

/// The place of a line, and whom it is between.
struct LineSituation {
  double here_m = 0;            ///< Where it lies, from its place in the map.
  double far_m = 0;             ///< As far as it may be moved, to either side.
  Crowd below_has, above_has;   ///< Who is awake there, by the side that hosts it.
  double below = 0, above = 0;  ///< Bodies awake on either side; what other lines give included.
  double mean = 0, all = 0;     ///< Of all servers of the world, and what they have together.
  double crowd_max = LineSituation::crowd_share_max;  ///< See quiet_place_m(); of `all`.
  static constexpr double crowd_share_max = 0.08;

  /// How many bodies awake the side below gets if the line lies there.
  double gain(double place_m) const;
  /// Whoever is so near that it would be about the line if that lay there.
  double stirs_at(double place_m) const { return below_has.at(place_m) + above_has.at(place_m); }
};

/// Where a line had better lie (m, from its place in the map), or where it lies.
///
/// A line that lies in a crowd costs both its servers: what may touch across it has to be told of,
/// decided about and brought together. It is better off where at most half as many stir. But the
/// crowd then belongs to one server, and in a row one server is left without any: so only a crowd
/// of at most 8 % of all that is awake anywhere is given away whole, and only if neither side then
/// has more than 15 % over the mean of all servers. Any other is shared out by contests, where it
/// lies (load_balance.h). Who has 30 % too much because of its line is rid of it: the line goes
/// back to its place in the map. Fewer than 8 bodies are not worth the way.
double quiet_place_m(const LineSituation& line);

/// The server whose region ends at a line, towards greater coordinates, keeps it: it says where it
/// lies. Only in worlds without corners, where each line has one server on each side.
class LineKeeper {
 public:
  LineKeeper(const PartitionLines& lines, std::size_t regions, RegionId self);

  std::optional<std::size_t> line() const { return line_; }
  /// Whose line our region begins at.
  std::optional<RegionId> keeper_below() const { return keeper_below_of(self_); }
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
  /// Places are looked for from so many bodies awake on (mean of all servers, > 0). `eager`: for
  /// crowds of any share, so that a handful of bodies moves lines.
  void look_from(double awake, bool eager) {
    awake_min_ = awake;
    crowd_max_ = eager ? 1 : LineSituation::crowd_share_max;
  }

  /// Where the line is to lie a term from now, if it lies here: a step on its way.
  double next_m(double here_m);
  /// A line moves no further than this in a term (m).
  static constexpr double step_m = 12;

 private:
  struct Load {
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
  double awake_min_ = 64, crowd_max_ = LineSituation::crowd_share_max;
  std::optional<double> target_m_;
};

}  // namespace aureole
