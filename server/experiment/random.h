// The one source of chance in the simulation: a seeded stream that is the same on every machine.
#pragma once

#include <cstdint>

namespace aureole {

/// Everything in a simulated run is derived from its seed through streams like this one; streams
/// with different purposes do not disturb each other.
/// Source: SplitMix64; Steele, Lea, Flood, OOPSLA 2014.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// An own stream for one purpose.
  Random(std::uint64_t seed, std::uint64_t purpose) : state_(seed * 0x9e37'79b9'7f4a'7c15u) {
    state_ ^= bits() + purpose * 0xd134'2543'de82'ef95u;
    static_cast<void>(bits());
  }

  std::uint64_t bits() {
    std::uint64_t x = state_ += 0x9e37'79b9'7f4a'7c15u;
    x = (x ^ (x >> 30)) * 0xbf58'476d'1ce4'e5b9u;
    x = (x ^ (x >> 27)) * 0x94d0'49bb'1331'11ebu;
    return x ^ (x >> 31);
  }
  /// In [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// 0 … n - 1; n > 0.
  int below(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }
  bool chance(double share) { return unit() < share; }

 private:
  std::uint64_t state_;
};

}  // namespace aureole
