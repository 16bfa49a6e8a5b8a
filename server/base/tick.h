// World time: whole steps of 16 ms, the same number on every server.
#pragma once

#include <compare>
#include <cstdint>

namespace aureole {

/// Length of one physics step T_P (unit: µs). Source: Brown et al. 2019, section 5.
inline constexpr std::int64_t tick_us = 16'000;
/// The same in seconds, as Bullet takes it.
inline constexpr float tick_s = 0.016f;

/// The number of a step; world time is tick × 16 ms.
struct Tick {
  std::int64_t value{};
  friend constexpr auto operator<=>(Tick, Tick) = default;
  constexpr Tick operator+(std::int64_t n) const { return {value + n}; }
  constexpr Tick operator-(std::int64_t n) const { return {value - n}; }
  constexpr std::int64_t operator-(Tick other) const { return value - other.value; }
  constexpr double seconds() const { return static_cast<double>(value) * (tick_us / 1e6); }
};

/// Ticks that last at least `ms` milliseconds.
constexpr std::int64_t ticks_from_ms(std::int64_t ms) {
  return (ms * 1000 + tick_us - 1) / tick_us;
}

}  // namespace aureole
