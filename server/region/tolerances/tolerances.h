// Section 3.3's tolerances as they are kept: speed, latency, frame time, and word from every peer.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "server/aura/shapes/aura_radius.h"
#include "server/base/ids.h"
#include "server/base/tick.h"

namespace aureole {

/// Outside of a tolerance consistency is no longer promised, and the server says so.
struct ToleranceEvent {
  enum class Kind : std::uint8_t { speed, latency, frame_time, link };
  static constexpr std::size_t kinds = 4;
  Kind kind{};
  bool outside = false;  ///< True when it is left, false when it holds again.
  Tick tick;             ///< The step that noticed.
  RegionId peer;         ///< latency, link
  BodyId body;           ///< speed: the fastest
  double value = 0;      ///< m/s, ms; link: the age of the newest word, in ticks
  double limit = 0;      ///< The tolerance.
};

/// "speed", "latency", "frame_time", "link".
std::string_view name_of(ToleranceEvent::Kind kind);

/// The fastest awake body of a step.
struct FastestBody {
  BodyId body;
  double speed_mps = 0;  ///< Of its centre; R_o covers how it spins.
};

/// Watches what the auras' sizes rely on. A tolerance is left in the step in which it is exceeded;
/// it holds again when it has been kept for settle_ticks(), because auras that were told before
/// then may have come too late. At most two events for each peer and two more in one step.
///
/// Two things are watched of each link. Its latency, as the shell measures it (the paper's historic
/// monitoring): the estimate is the longest of the last latency_window_ticks. And the age of the
/// newest word: a server says something to its peers in each of its steps, to those far away in
/// some (signs_of_life.h), and equation (1) gives a message ceil((2 T_F + T_L) / T_P) steps; if
/// none is younger, something between there and here has taken longer than permitted, be it the
/// network, the peer or its end.
class Tolerances {
 public:
  static constexpr std::int64_t latency_window_ticks = 125;  ///< 2 s

  /// All `region_count` regions but `self` are peers.
  Tolerances(const AuraTolerances& limits, RegionId self, std::size_t region_count);

  /// From the next step on these are kept.
  void set_limits(const AuraTolerances& limits);
  const AuraTolerances& limits() const { return limits_; }
  /// The longest estimate of any link; 0 while nothing has been measured.
  double longest_latency_ms() const;

  /// From its newest word on the peer says something in one of so many steps at least; 1 until this
  /// is called.
  void expect_word(RegionId peer, std::int64_t every_ticks);
  void link_up(RegionId peer);
  void link_down(RegionId peer);
  /// One way. Finite, ≥ 0.
  void link_measured(RegionId peer, double latency_ms);
  /// A word from the peer's step `tick`.
  void heard(RegionId peer, Tick tick);
  /// Judges one step of this server. `now` is later than at the last call; ticks in between were
  /// left out, and their time counts as frame time. `frame_ms` is that of the step before.
  void step(Tick now, double frame_ms, const FastestBody& fastest);

  /// Of the last step. Valid until the next one.
  std::span<const ToleranceEvent> events() const { return events_; }
  /// What is outside now, for each kind at most one: that which exceeds its limit by most, with the
  /// tick at which it was left. Ascending by kind.
  std::vector<ToleranceEvent> outside() const;
  /// How often any was left.
  std::uint64_t left_count() const { return left_count_; }

  /// T_T in ticks, but so long that a status that is sent now and then cannot miss it.
  std::int64_t settle_ticks() const { return settle_ticks_; }

 private:
  /// One tolerance as it is kept towards one peer, or by this server.
  struct Kept {
    bool outside = false;
    Tick exceeded;         ///< When last.
    ToleranceEvent event;  ///< As it was left, with the worst value since.
  };
  /// What every step looks at comes first, and is one line of the cache: a world has many peers.
  struct alignas(64) Link {
    bool up = false;
    bool broke = false;    ///< Since the last step, however short.
    bool counts = false;   ///< `newest` is known.
    bool outside = false;  ///< `latency` or `word` is.
    Tick newest;           ///< The peer's newest step that we have word of.
    std::int64_t word_every_ticks = 1;
    double measured_ms = -1;  ///< Longest since the last step.
    /// The first of `latency_ms`; 0 while there is none.
    double estimate_ms = 0;
    Tick estimate_until = never_ends;  ///< Then the next one of them counts; never: it is the last.
    Kept latency, word;
    std::deque<std::pair<Tick, double>> latency_ms;  ///< Falling values; the first is the longest.
  };
  static constexpr Tick never_ends{std::numeric_limits<std::int64_t>::max()};
  static void take_estimate(Link& link);

  void judge(Kept& kept, const ToleranceEvent& seen, bool exceeds);
  void judge(Link& link, Kept& kept, const ToleranceEvent& seen, bool exceeds);
  void judge_latency(RegionId peer, Link& link, Tick now);
  void judge_word(RegionId peer, Link& link, Tick now);

  AuraTolerances limits_;
  std::int64_t flight_ticks_ = 0;
  std::int64_t settle_ticks_ = 0;
  Link& link(RegionId peer);
  RegionId self_;
  std::vector<Link> links_;  ///< By region; our own is not used.
  Kept speed_, frame_time_;
  Tick last_;
  bool started_ = false;
  std::vector<ToleranceEvent> events_;
  std::uint64_t left_count_ = 0;
};

}  // namespace aureole
