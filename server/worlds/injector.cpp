// A counter-based stream: random bits are a hash of seed, body number and what they are for.
#include "server/worlds/injector.h"

#include <algorithm>
#include <cmath>

#include "server/base/check.h"

namespace aureole {
namespace {

/// The finaliser of SplitMix64. Source: Steele, Lea, Flood, OOPSLA 2014.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58'476d'1ce4'e5b9u;
  x = (x ^ (x >> 27)) * 0x94d0'49bb'1331'11ebu;
  return x ^ (x >> 31);
}

enum class Use : std::uint64_t { x, y, z, velocity_x, velocity_y, velocity_z, prototype };

/// In [0, 1), 53 bits.
double uniform(std::uint64_t seed, std::uint64_t n, Use use) {
  constexpr std::uint64_t golden = 0x9e37'79b9'7f4a'7c15u;
  // Hashed one after the other: sums of the three would make streams of neighbouring seeds overlap.
  const std::uint64_t bits = mixed(mixed(mixed(seed + golden) + n * golden) +
                                   (static_cast<std::uint64_t>(use) + 1) * golden);
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

PrototypeId chosen(const Injector& injector, double where) {
  double sum = 0;
  for (const auto& share : injector.mix) sum += share.weight;
  double left = where * sum;
  for (const auto& share : injector.mix) {
    if (left < share.weight) return share.prototype;
    left -= share.weight;
  }
  return injector.mix.back().prototype;
}

}  // namespace

InjectedBody injected_body(const Injector& injector, std::uint64_t n) {
  AUREOLE_CHECK(!injector.mix.empty(), "an injector has something to make");
  const auto between = [&](double min, double max, Use use) {
    return min + (max - min) * uniform(injector.seed, n, use);
  };
  InjectedBody body;
  body.n = n;
  body.prototype = chosen(injector, uniform(injector.seed, n, Use::prototype));
  const Eigen::Vector3d &low = injector.volume.min, &high = injector.volume.max;
  body.state.position = {between(low.x(), high.x(), Use::x), between(low.y(), high.y(), Use::y),
                         between(low.z(), high.z(), Use::z)};
  const Eigen::Vector3d slow = injector.velocity_min.cast<double>(),
                        fast = injector.velocity_max.cast<double>();
  body.state.linear_velocity = Eigen::Vector3d(between(slow.x(), fast.x(), Use::velocity_x),
                                               between(slow.y(), fast.y(), Use::velocity_y),
                                               between(slow.z(), fast.z(), Use::velocity_z))
                                   .cast<float>();
  return body;
}

std::uint64_t injected_count(const Injector& injector, Tick now) {
  const double time_s = std::clamp(now.seconds() - injector.start_s, 0.0, injector.duration_s);
  // A millionth of a body: 160/s × 0.4 s is 64, whatever the roundings on the way.
  return static_cast<std::uint64_t>(std::floor(injector.rate_per_s * time_s + 1e-6));
}

}  // namespace aureole
