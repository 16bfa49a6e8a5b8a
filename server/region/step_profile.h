// Where the time of one server's tick goes, told apart by clock readings at the borders of its
// parts.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace aureole {

/// Sums the time between calls of enter() for the part that was entered. The clocks come from
/// outside: a region reads none. A thread's CPU time costs a call of the kernel, 0.3 to 3 µs, and a
/// step has a dozen borders: it is asked only when a stretch begins and ends, and shared out by a
/// clock that is quick to read.
class StepProfile {
 public:
  enum class Part : std::uint8_t {
    physics,  ///< New bodies, players, Bullet's step, strays.
    aura,     ///< What is told and heard of auras, stand-ins.
    decide,   ///< What is hosted, how far it reaches, who gets what.
    wire,     ///< Messages read and written, groups packed, unpacked and caught up.
  };
  static constexpr std::size_t parts = 4;
  /// Nanoseconds since whenever.
  using Clock = std::int64_t (*)();
  struct Clocks {
    Clock whole = nullptr;    ///< How long a stretch from enter() to stop() took.
    Clock borders = nullptr;  ///< How it is shared out among its parts.
    Clocks() = default;
    Clocks(Clock both) : whole(both), borders(both) {}
    Clocks(Clock of_whole, Clock of_borders) : whole(of_whole), borders(of_borders) {}
  };

  explicit StepProfile(Clocks clocks) : clocks_(clocks) {}

  /// Forgets what was measured. Nothing is measured until a part is entered.
  void clear() { spent_ns_ = {}; }
  /// From now on time goes to this part.
  void enter(Part part) {
    if (running_)
      reach_border();
    else
      begin();
    part_ = static_cast<std::size_t>(part);
  }
  /// From now on time goes nowhere.
  void stop() {
    if (!running_) return;
    reach_border();
    running_ = false;
    const std::int64_t whole = clocks_.whole() - began_ns_;
    const std::int64_t shared = std::accumulate(shares_ns_.begin(), shares_ns_.end(), 0ll);
    for (std::size_t part = 0; part < parts; ++part)
      spent_ns_[part] += shared > 0 ? std::llround(static_cast<double>(whole) *
                                                   static_cast<double>(shares_ns_[part]) /
                                                   static_cast<double>(shared))
                                    : 0;
  }
  /// By part, since clear(), of stretches that are over.
  const std::array<std::int64_t, parts>& spent_ns() const { return spent_ns_; }

 private:
  void begin() {
    running_ = true;
    shares_ns_ = {};
    began_ns_ = clocks_.whole();
    since_ns_ = clocks_.borders();
  }
  void reach_border() {
    const std::int64_t now = clocks_.borders();
    shares_ns_[part_] += now - since_ns_;
    since_ns_ = now;
  }

  Clocks clocks_;
  std::array<std::int64_t, parts> spent_ns_{};
  std::array<std::int64_t, parts> shares_ns_{};  ///< Of the stretch so far, by `borders`.
  std::size_t part_ = 0;
  std::int64_t began_ns_ = 0;  ///< By `whole`.
  std::int64_t since_ns_ = 0;  ///< By `borders`.
  bool running_ = false;
};

}  // namespace aureole
