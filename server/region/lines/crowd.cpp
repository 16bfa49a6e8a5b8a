// Bins of bodies, and what a byte says of each.
#include "server/region/lines/crowd.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

/// Between two codes of a bin; code 0 is nothing.
const double code_step = std::log(1.05);

}  // namespace

double Crowd::between(double from, double to) const {
  double sum = 0;
  for (int i = 0; i < bins; ++i) {
    const double low = from_m + i * bin_m;
    const double covered_m = std::min(to, low + bin_m) - std::max(from, low);
    if (covered_m > 0) sum += awake[static_cast<std::size_t>(i)] * covered_m / bin_m;
  }
  return sum;
}

std::vector<std::uint8_t> Crowd::encoded() const {
  std::vector<std::uint8_t> bytes;
  for (const double n : awake)
    bytes.push_back(static_cast<std::uint8_t>(
        std::min(std::round(std::log1p(std::max(n, 0.0)) / code_step), 255.0)));
  return bytes;
}

Result<Crowd> Crowd::decoded(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != static_cast<std::size_t>(bins))
    return Error::format("a crowd of {} bins; expected {}", bytes.size(), bins);
  Crowd crowd;
  for (std::size_t i = 0; i < bytes.size(); ++i) crowd.awake[i] = std::expm1(bytes[i] * code_step);
  return crowd;
}

void Crowd::follow(const Crowd& now, double share) {
  for (std::size_t i = 0; i < awake.size(); ++i) awake[i] += (now.awake[i] - awake[i]) * share;
}

}  // namespace aureole
