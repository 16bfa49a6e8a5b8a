// How much each server has to do, as all servers know it at the same tick.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "server/aura/partition/partition_map.h"
#include "server/base/tick.h"

namespace aureole {

/// Loads in terms of 128 ticks, about two seconds. In the second half of a term a server says at
/// which level it will be in the next one, and with every status from then on again: everybody
/// whose link has not been silent for a second has heard before the term begins, and orders the
/// servers alike (precedence.h). Who has not heard goes by the last that it has.
///
/// Levels are 3 % apart for an order of servers, and one is left only for a load that is a whole
/// level away, and by more bodies than hang together: what nobody can share out would go to and
/// fro. Every term that changes the order costs changes of owner. Shorter terms do not even out any
/// better, longer ones less (docs/tried.md).
class LoadLevels {
 public:
  static constexpr std::int64_t term_ticks = 128;
  static std::int64_t term_of(Tick tick) { return tick.value / term_ticks; }
  /// From one level to the next, for an order of servers.
  static constexpr double coarse_step = 1.03;
  /// Loads below this are all at level 0 (bodies awake): a world that calms down has one order.
  static constexpr double awake_min = 128;
  /// What a status says of a term whose level has not been chosen yet, or is not known.
  static constexpr std::uint16_t unknown = 0xFFFF;
  /// After all others, whatever it has to do: of a server whose messages take more than from one
  /// decision to the next. When an order changes, what has been asked for by the one before is
  /// still on its way; where that takes long two servers pass each other
  /// (docs/adaptive.md#where-messages-are-slow).
  static constexpr std::uint16_t last = unknown - 1;

  /// `self`: one of `regions`. `step`: from one level to the next (> 1).
  LoadLevels(std::size_t regions, RegionId self, double step = coarse_step)
      : known_(regions), self_(self), step_(step) {}

  /// Loads below this are at level 0 instead (bodies awake, > 0; infinite: all are alike).
  void level_from(double awake) { awake_min_ = awake; }

  /// What a status of some tick says: the level in that term and in the next.
  struct Told {
    std::uint16_t now = 0, next = unknown;
    friend bool operator==(const Told&, const Told&) = default;
  };
  /// What ours says; chooses our next level when the term is half over. `awake`: bodies, smoothed.
  /// `largest`: how many of them hang together, at most: what would go elsewhere as one.
  Told tell(Tick now, double awake, double largest = 0);
  /// The same for levels that stand for something else: `choose` turns the one before into the
  /// next.
  Told tell(Tick now, const std::function<std::uint16_t(std::uint16_t before)>& choose);
  /// Whether the next tell() chooses.
  bool is_to_choose(Tick now) const;
  void hear(RegionId from, Tick told_at, Told told);
  /// Whether it has been told, or chosen here, at which level a server is now.
  bool knows(RegionId region, Tick now) const;
  /// Of all servers.
  bool knows_all(Tick now) const;
  /// Whether anything has been told of a server, or chosen here, since the first term.
  bool has_heard(RegionId region) const { return known_[region.value].front().term > 0; }
  /// Whether no server has told, or chosen here, of a load that counts, for as long as is kept.
  bool none_loaded() const;
  /// Whether every server has told the same, or chosen here, for as long as is kept.
  bool unchanged() const;
  /// Whether so many bodies awake would be at a level of their own.
  bool counts(double awake) const { return awake > awake_min_; }

  /// By region. Valid until the next call.
  std::span<const std::uint16_t> in_force(Tick now);
  /// The same a second ago (long_stay_ticks). Valid until the next call.
  std::span<const std::uint16_t> in_force_before(Tick now);

 private:
  /// The newest first. Three: who is a moment behind still goes by the one before.
  struct Announced {
    std::int64_t term = 0;
    std::uint16_t level = 0;
  };
  using Known = std::array<Announced, 3>;
  static void note(Known& known, Announced announced);
  static std::uint16_t level_in(const Known& known, std::int64_t term);
  std::uint16_t level_for(double awake, double largest, std::uint16_t before) const;
  void look_up(Tick at, std::vector<std::uint16_t>& levels) const;

  std::vector<Known> known_;
  RegionId self_;
  double step_;
  double awake_min_ = awake_min;
  std::vector<std::uint16_t> in_force_, in_force_before_;
};

}  // namespace aureole
