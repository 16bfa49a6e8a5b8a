// Which of a frame's TCP segments are lost, and what their loss costs those who wait for them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "server/experiment/random.h"

namespace aureole {

/// A frame travels in segments of `segment_bytes`; each is lost with the same chance, each time
/// that it is sent. TCP delivers nothing of what comes after it before it has come, so that a loss
/// is seen as a stall of the whole channel:
///  - The sender knows that a segment is lost when something that it sent later has been
///    acknowledged, and a quarter of a round trip has passed in which it might just have been
///    overtaken: 5/4 round trips after the later one left (fast retransmit by time; RFC 8985).
///    Servers near each other send in each tick, so that something follows within 16 ms.
///  - If nothing follows, and whenever what was sent again is lost too, the retransmission timer
///    ends it: a round trip and 200 ms, the least that Linux allows for the variance; twice as
///    long each time (RFC 6298).
/// Acknowledgements are not lost: the next one says the same. There is no congestion window: what a
/// server sends in a round trip fits the smallest, and nobody's rate is what is studied.
class PacketLoss {
 public:
  using Micros = std::int64_t;
  static constexpr std::size_t segment_bytes = 1448;
  static constexpr Micros timer_us_min = 200'000;
  /// The timer is doubled so often at most.
  static constexpr int doublings_max = 6;

  struct Fate {
    bool lost = false;  ///< Any segment.
    /// The last one, so that the sender does not know before it sends something else.
    bool last_lost = false;
    Micros again_us = 0;  ///< For what was lost again when it was sent again.
  };

  /// \param share  of segments, 0 … 1
  PacketLoss(double share, Micros round_trip_us, std::uint64_t seed)
      : share_(share), round_trip_us_(round_trip_us), random_(seed, 3) {}

  bool any() const { return share_ > 0; }
  Fate draw(std::size_t frame_bytes);
  /// From when something later was sent until what was lost is sent again.
  Micros noticed_after_us() const { return round_trip_us_ * 5 / 4; }
  /// The same if nothing is sent later.
  Micros timer_us() const { return round_trip_us_ + timer_us_min; }

 private:
  double share_;
  Micros round_trip_us_;
  Random random_;
};

}  // namespace aureole
