// Which bodies a region that died and has started anew may claim: everything that is known of each
// body, from its own snapshot and from everyone who answers, and the rule that decides.
//
// Pure bookkeeping; RegionCore carries the messages. The argument is in docs/recovery.md.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/tick.h"
#include "server/region/handoff/handoff.h"
#include "server/region/recovery/answer.h"
#include "server/region/recovery/snapshot.h"

namespace aureole {

class Recovery {
 public:
  struct Setup {
    RegionId self;
    Incarnation incarnation;  ///< Of this start.
    std::size_t regions = 0, prototypes = 0, statics = 0;
  };
  Recovery(const Setup& setup, std::optional<Snapshot> snapshot);

  void peer_up(PeerId peer, Incarnation incarnation);
  void peer_down(PeerId peer);
  /// A group that a neighbour sends again, or sends first. An Error as with hear_answer().
  Status hear_group(const HandoffGroup& group);
  /// A payload of FrameType::recovery_answer. An Error means that the link must be closed; nothing
  /// of it has been taken.
  Status hear_answer(PeerId from, std::span<const std::byte> payload);

  /// Call once a step: who is to be asked now, for round().
  std::vector<PeerId> ask(Tick now);
  std::uint64_t round() const { return round_; }
  /// Everyone who might hold something newer has answered.
  bool may_decide(Tick now) const { return waits_for(now).empty(); }
  /// Who has not, as words: "region r2", "gateway 0".
  std::vector<std::string> waits_for(Tick now) const;

  /// What this region itself could claim, for others that recover at the same time.
  std::vector<KnownState> candidates() const;

  struct Outcome {
    std::vector<HandoffGroup::Body> bodies;  ///< Ascending; with the epochs to be hosted under.
    std::vector<Avatar> avatars;             ///< Of those bodies.
    std::set<BodyId> known;                  ///< Everything anybody has ever told of.
    bool nobody_knew = false;                ///< No snapshot, no store: the world begins anew here.
    Tick heard{-1};                   ///< Newest tick that any store had heard of this region.
    std::uint64_t without_state = 0;  ///< Should be claimed, but nobody knew where they were.
  };
  Outcome decide(Tick now) const;
  const std::optional<Snapshot>& snapshot() const { return snapshot_; }

  /// A claim is this many epochs above the newest version known: what went on unseen in the
  /// moments before the death is never above it, at two changes of owner a second.
  static constexpr std::uint32_t claimed_epochs_ahead = 8;
  /// Gateways that were linked when the snapshot was written have this long to come again; they
  /// dial at least every 2 s.
  static constexpr std::int64_t named_gateways_ticks = ticks_from_ms(2'500);
  /// Without a snapshot at least one gateway is waited for so long, and so is the answer of any
  /// that is linked.
  static constexpr std::int64_t any_gateway_ticks = ticks_from_ms(5'000);
  /// More bodies or players than twice this are refused: somebody makes names up.
  static constexpr std::size_t known_max = 400'000;

 private:
  struct Peer {
    bool up = false;
    Incarnation incarnation;
    std::uint64_t asked = 0;     ///< Round.
    std::uint64_t answered = 0;  ///< Round of which everything has come.
    bool recovering = false;     ///< By its newest answer.
    bool has_ever_answered = false;
    Tick asked_at;
    std::map<BodyId, Version> candidates;  ///< While it recovers.
  };
  struct Known {
    Version newest;
    std::optional<Version> removed;
    std::optional<HandoffGroup::Body> state;  ///< The newest there is; `state_of` is its version.
    Version state_of;
    std::optional<Version> own;  ///< What this region could claim.
  };

  Status check_room(std::size_t bodies, std::size_t players) const;
  void note_state(const HandoffGroup::Body& body, const Version& version, bool own);
  void note_group(const HandoffGroup& group, Incarnation incarnation, std::uint32_t epochs_on);
  void note_avatar(const Avatar& avatar);
  bool is_ours(BodyId id, const Known& known) const;
  bool has_best_candidate(BodyId id, const Known& known) const;
  std::vector<Avatar> avatars_of(const Outcome& outcome, Tick now) const;
  bool all_regions_up() const;

  Setup setup_;
  std::optional<Snapshot> snapshot_;
  std::map<PeerId, Peer> peers_;
  std::map<BodyId, Known> known_;
  std::map<PlayerId, Avatar> avatars_;
  std::map<PlayerId, KnownPlayer> players_;  ///< As stores have it.
  Tick heard_{-1};
  std::uint64_t round_ = 0;
  bool new_round_ = true;
  std::optional<Tick> began_;
};

}  // namespace aureole
