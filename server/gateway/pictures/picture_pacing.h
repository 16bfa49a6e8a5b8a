// How many pictures one browser gets and how large they are: a window, and a quality that follows
// its pace.
#pragma once

#include <cstdint>
#include <deque>

namespace aureole {

/// Pure: the caller reads the clock (µs). Pictures are numbered by the caller, growing. A browser
/// that acknowledges late gets fewer pictures (the window is full), then ones that cost it less
/// (JPEG quality, then size); never older ones. What it takes well is offered again, and a trial
/// that failed is repeated later and later.
class PicturePacing {
 public:
  static constexpr int quality_min = 40, quality_max = 90, quality_start = 80;
  static constexpr int window_min = 3, window_max = 12;
  /// A picture is due so often (unit: µs): 60 in a second.
  static constexpr std::int64_t interval_us = 1'000'000 / 60;

  /// True if one more picture may be on its way now.
  bool has_room() const { return in_flight_.size() < static_cast<std::size_t>(window_); }

  /// The first byte of picture `number` has been given to the connection.
  void sent(std::uint32_t number, std::int64_t now_us);
  /// The browser has decoded picture `number`; older ones that it skipped count as done too.
  void acknowledged(std::uint32_t number, std::int64_t now_us);
  /// A picture was due, but the window was full or the connection was still writing.
  void held_back() { ++held_back_; }
  /// Called about 60 times a second; adapts every half second.
  void tick(std::int64_t now_us);

  int window() const { return window_; }
  int in_flight() const { return static_cast<int>(in_flight_.size()); }
  int quality() const { return quality_; }
  /// Of both edges of the picture: 1, 0.75 or 0.5.
  double scale() const;
  /// Pictures sent in the last second.
  double fps(std::int64_t now_us) const;
  /// From sending to acknowledgement: shortest of the last ten seconds or so, 0 if unknown (µs).
  std::int64_t shortest_round_trip_us() const;

 private:
  struct InFlight {
    std::uint32_t number;
    std::int64_t sent_us;
  };
  void adapt(std::int64_t now_us);
  void lower(std::int64_t now_us, double acknowledged_per_s);
  void raise(std::int64_t now_us);

  std::deque<InFlight> in_flight_;      ///< At most `window_` (a few more while it shrinks).
  std::deque<std::int64_t> sent_us_;    ///< Of the last second.
  std::deque<std::int64_t> floors_us_;  ///< Shortest round trip of each of the last periods.
  int window_ = window_min;
  int quality_ = quality_start;
  int scale_step_ = 0;

  // Since the last adaptation.
  std::int64_t period_start_us_ = 0;
  std::int64_t period_floor_us_ = 0;
  std::int64_t round_trips_us_ = 0;
  int acknowledged_ = 0;
  int held_back_ = 0;

  std::int64_t calm_since_us_ = 0;
  std::int64_t raised_at_us_ = 0;
  std::int64_t patience_us_;

 public:
  PicturePacing();
};

}  // namespace aureole
