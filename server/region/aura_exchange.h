// Auras between servers: ours told to whom they concern, theirs kept as they were told.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "protocol/frame.h"
#include "server/aura/migration_policy.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/tick.h"

namespace aureole {

/// An aura is sent when it is new or has changed and withdrawn when it concerns the receiver no
/// longer; one that stays as it is costs nothing (section 3.2 of the paper). When a link ends, all
/// that was told over it is forgotten on both sides.
class AuraExchange {
 public:
  void link_up(RegionId peer);
  void link_down(RegionId peer);

  /// Checks a FrameType::auras payload and remembers what it says until take_in(), in room that
  /// does not grow with the number of messages; nothing of a bad one is taken. Returns the sender's
  /// tick.
  Result<Tick> receive(RegionId from, std::span<const std::byte> payload);
  /// From now on what has arrived counts. Returns what others asked us to hand over, ascending by
  /// body.
  std::vector<HandoverRequest> take_in();
  /// What others project to us now, ascending by body; one entry a body: of two servers that both
  /// claim it the lower number's.
  std::span<const RemoteAura> remote() const { return remote_; }
  /// Whether anything was heard, or a link came or went, since the last announce().
  bool has_changed() const { return changed_; }

  /// Prepares this tick's frames from what the policy decided.
  void announce(Tick now, const MigrationDecision& decision);
  /// The frame for one linked peer, or nothing if there is nothing to say of auras.
  SharedBytes take_frame(RegionId peer);
  /// A message without auras: that we have stepped. In each step every peer hears one or the other,
  /// so that silence means something.
  static SharedBytes sign_of_life(Tick now);

  /// Auras in one message at most; far more than a boundary can hold.
  static constexpr std::size_t max_auras = 65'536;

 private:
  /// As it travels: equal bytes need not be sent again.
  struct Sent {
    std::array<std::uint8_t, 9> position{};
    std::array<std::uint16_t, 3> half_extents{};
    bool asleep = false;
    friend bool operator==(const Sent&, const Sent&) = default;
  };
  struct Told {
    std::vector<RemoteAura> auras;
    std::vector<BodyId> removed;
    std::vector<BodyId> pulls;
  };
  struct Peer {
    bool up = false;
    std::map<BodyId, Sent> projected;     ///< What the peer knows of us.
    std::map<BodyId, RemoteAura> theirs;  ///< What we know of the peer.
    std::vector<BodyId> pulls;            ///< Of the newest message, until take_in().
    SharedBytes frame;
  };
  std::map<RegionId, Peer> peers_;
  std::vector<RemoteAura> remote_;
  bool changed_ = true;
};

}  // namespace aureole
