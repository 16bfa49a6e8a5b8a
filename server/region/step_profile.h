// Where the time of one server's tick goes, told apart by clock readings at the borders of its
// parts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace aureole {

/// Sums the time between calls of enter() for the part that was entered. The clock comes from
/// outside: a region reads none.
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

  explicit StepProfile(Clock clock) : clock_(clock) {}

  /// Forgets what was measured. Nothing is measured until a part is entered.
  void clear() { spent_ns_ = {}; }
  /// From now on time goes to this part.
  void enter(Part part) {
    stop();
    part_ = static_cast<std::size_t>(part);
    running_ = true;
  }
  /// From now on time goes nowhere.
  void stop() {
    const std::int64_t now = clock_();
    if (running_) spent_ns_[part_] += now - since_ns_;
    since_ns_ = now;
    running_ = false;
  }
  /// By part, since clear().
  const std::array<std::int64_t, parts>& spent_ns() const { return spent_ns_; }

 private:
  Clock clock_;
  std::array<std::int64_t, parts> spent_ns_{};
  std::size_t part_ = 0;
  std::int64_t since_ns_ = 0;
  bool running_ = false;
};

}  // namespace aureole
