// What `aureole experiment` takes. Runs that figures are drawn from say what they were given, and
// nothing else can have been.
#pragma once

#include <initializer_list>
#include <string>

namespace aureole::run_ranges {

/// Both ends included.
struct Range {
  double from, to;
};
inline constexpr Range servers{1, 64};
inline constexpr Range seconds{0.5, 3600};
inline constexpr Range rate_per_s{1, 10'000};
inline constexpr Range repeats{1, 100};
/// Ten of the widest side by side still lie where positions can be told.
inline constexpr Range region_m{50, 800};
inline constexpr Range message_ms{0, 1000};  ///< Latency and jitter.
inline constexpr Range loss_pct{0, 20};
inline constexpr Range speed_tolerance_mps{0.1, 1000};
inline constexpr Range latency_tolerance_ms{0, 1000};
inline constexpr Range frame_time_tolerance_ms{0.1, 1000};
inline constexpr Range cold_caches_s{0, 3600};

inline constexpr std::initializer_list<const char*> layouts{"column", "corner", "grid"};
inline constexpr std::initializer_list<const char*> modes{"single",   "naive", "paper",
                                                          "adaptive", "ideal", "cut"};

}  // namespace aureole::run_ranges
