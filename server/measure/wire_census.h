// What servers tell each other of auras and the gateway of bodies, in bytes for each that moves.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <unordered_map>
#include <vector>

#include "protocol/frame.h"
#include "protocol/quantise.h"

namespace aureole {

/// Payload: without the 16 bytes of a frame's header, with all else that a message carries.
struct WireCounts {
  /// Messages of auras that say anything, less `resting_bytes`.
  std::uint64_t aura_bytes = 0;
  /// Of these messages: where the resting bodies lie that others lean on.
  std::uint64_t resting_bytes = 0;
  /// Messages that say no more than that a server has taken its step.
  std::uint64_t sign_of_life_bytes = 0;
  /// For each tick and each server that is told, those auras it knows that neither rest nor sleep,
  /// whether or not anything new was said of them.
  std::uint64_t moving_auras = 0;
  /// Updates for the gateway, less `key_bytes`.
  std::uint64_t replica_bytes = 0;
  /// Of these: full states, for recovery or because something is new, falls asleep or wakes.
  std::uint64_t key_bytes = 0;
  /// For each tick, the bodies whose pose on the grid of the wire is another one than before.
  std::uint64_t moving_replicas = 0;

  WireCounts operator-(const WireCounts& before) const;
};

/// `aura_bytes_per_moving_tick` and `replica_bytes_per_moving_tick` (null if nothing moved), and
/// with them the share of full states on top, and the counts.
nlohmann::json to_json(const WireCounts& counts);

/// Reads along. What it is shown comes from cores in this process.
class WireCensus {
 public:
  /// `gateway`: the number of the one end that is no region.
  explicit WireCensus(int gateway) : gateway_(gateway) {}

  void note(int from, int to, const Bytes& frame);
  const WireCounts& counts() const { return counts_; }

 private:
  struct Link {
    std::unordered_map<std::uint64_t, bool> moves;           ///< By body, what the receiver knows.
    std::unordered_map<std::uint16_t, std::uint64_t> slots;  ///< Bodies by what names them.
    std::uint64_t moving = 0;
  };
  struct Pose {
    QuantisedPosition position{};
    QuantisedOrientation orientation{};
    friend bool operator==(const Pose&, const Pose&) = default;
  };
  void note_auras(Link& link, const FrameView& frame);
  void note_replicas(int from, const FrameView& frame);
  void moved(Pose& known, const Pose& now);

  int gateway_;
  WireCounts counts_;
  std::map<std::pair<int, int>, Link> links_;
  std::map<int, std::unordered_map<std::uint32_t, Pose>> poses_;  ///< By region and slot.
};

}  // namespace aureole
