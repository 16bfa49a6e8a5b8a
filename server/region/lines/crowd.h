// Who is awake near a line, by distance.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/base/result.h"

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
  /// Takes in who is awake now, with this share of all that is remembered.
  void follow(const Crowd& now, double share);
  /// A byte for each bin, in steps of 5 %.
  std::vector<std::uint8_t> encoded() const;
  /// Errors: not as many bytes as there are bins.
  static Result<Crowd> decoded(std::span<const std::uint8_t> bytes);
};

}  // namespace aureole
