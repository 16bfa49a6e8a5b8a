// One region's state machine: messages in, messages out, time as an argument.
//
// No sockets, threads, clocks, files or global random numbers. The TCP server and the simulation
// run this same object, so that what is tested under faults is what runs in production.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "protocol/frame.h"
#include "server/aura/migration_policy.h"
#include "server/aura/partition_map.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/tick.h"
#include "server/region/aura_exchange.h"
#include "server/region/handoff/handoff.h"
#include "server/region/handoff/journal.h"
#include "server/region/hosting.h"
#include "server/region/players/effects.h"
#include "server/region/players/players.h"
#include "server/worlds/world.h"

namespace aureole {

/// How it is decided which body is hosted where.
enum class MigrationMode : std::uint8_t {
  naive,  ///< On crossing the boundary; bodies of two servers never meet.
  aura,   ///< What may soon touch is brought together first.
};

struct Outgoing {
  PeerId to;
  SharedBytes frame;
};

/// What the shell measured (or the simulation modelled) of earlier steps; passed on to gateways.
struct ShellMeasurements {
  std::uint32_t frame_us_p50 = 0;
  std::uint32_t frame_us_max = 0;
  std::uint64_t overruns = 0;
  std::uint64_t skipped_ticks = 0;
};

struct RegionStatistics {
  std::uint64_t bodies = 0, awake = 0;
  std::uint64_t spawned = 0, removed = 0, removed_strays = 0;
  std::uint64_t migrations_in = 0, migrations_out = 0;
  std::uint64_t version_conflicts =
      0;  ///< Bodies that arrived while held here; 0 unless something is wrong.
  std::uint64_t late_effects = 0;    ///< Blasts that came after their tick.
  std::uint64_t catch_up_steps = 0;  ///< Steps made up for groups that came late.
  std::uint64_t refused_bodies = 0;  ///< Not made because the world is full.
  std::uint64_t unacknowledged = 0;  ///< Messages in the journals.
};

class RegionCore {
 public:
  /// `world` must outlive the core. `self` is one of its regions.
  RegionCore(const WorldDefinition& world, RegionId self, Incarnation incarnation,
             MigrationMode mode = MigrationMode::aura);

  void peer_up(PeerId peer, Incarnation incarnation);
  void peer_down(PeerId peer);
  /// Validates and queues, does nothing else. After an Error the link must be closed; nothing of
  /// the message has been taken.
  Status receive(PeerId from, const Frame& frame);
  /// Exactly one step of 16 ms, to tick `now`, which must be later than the step before.
  void step(Tick now, const ShellMeasurements& measured = {});
  /// What the last step wants sent, in order. Valid until the next step.
  std::span<const Outgoing> outbox() const { return outbox_; }

  std::uint64_t state_hash() const;
  RegionStatistics statistics() const;
  const PhysicsWorld& physics() const { return hosting_.physics(); }
  const Hosting& hosting() const { return hosting_; }
  const Journal& journal(RegionId peer) const { return peers_.at(PeerId::region(peer)).journal; }
  const PartitionMap& partition() const { return map_; }

  /// Work per step to bring late groups to the present: bodies × steps. What is above it waits.
  static constexpr std::int64_t catch_up_budget = 4000;
  /// Older groups are brought on by this many ticks only (1 s), and counted.
  static constexpr std::int64_t catch_up_ticks_max = 62;
  static constexpr std::int64_t status_interval_ticks = 16;
  /// A sleeping region decides again at least this often (islands wait their time before they go).
  static constexpr std::int64_t decision_interval_ticks = 16;

 private:
  struct Peer {
    bool up = false;
    bool wants_whole_state = false;  ///< Gateways, after link up.
    Journal journal;                 ///< Regions.
    std::uint32_t bodies = 0;        ///< Last heard.
  };
  struct Arrived {
    RegionId from;
    HandoffGroup group;
  };

  void take_in(Tick now);
  void take_in_groups(Tick now);
  void take_in_effects(Tick now);
  void take_in_commands(Tick now);
  void spawn(Tick now);
  void apply_blasts(Tick now);
  void remove_strays(Tick now);
  void migrate(Tick now);
  bool nothing_stirs(Tick now) const;
  void emigrate(std::span<const BodyId> bodies, RegionId to, Tick now);
  void schedule_blast(const BlastEffect& blast, Tick now);
  void remove_somewhere(BodyId body, Tick now);
  void send_player_output();
  void publish(Tick now, const SharedBytes& update, const ShellMeasurements& measured);
  std::vector<VersionedBody> passive_copies() const;
  bool has_room(std::size_t more) const;
  bool is_up(RegionId region) const;

  const WorldDefinition& world_;
  RegionId self_;
  Incarnation incarnation_;
  PartitionMap map_;
  std::unique_ptr<MigrationPolicy> policy_;
  Hosting hosting_;
  Players players_;
  std::map<PeerId, Peer> peers_;

  AuraExchange aura_exchange_;
  std::vector<HandoverRequest> handover_requests_;
  std::deque<Arrived> arrived_groups_;
  std::deque<std::pair<RegionId, EffectsMessage>> arrived_effects_;
  std::vector<PlayerCommand> arrived_commands_;
  std::deque<BlastEffect> blasts_;           ///< To come and recent, by tick.
  std::map<BodyId, Tick> pending_removals_;  ///< Of bodies that may be on their way here.
  PlayerOutput player_output_;
  std::vector<Outgoing> outbox_;
  std::vector<std::uint64_t> injected_;  ///< For each injector, how many it had made.
  Tick last_tick_;
  Tick last_decision_{-decision_interval_ticks};
  std::uint64_t changes_at_decision_ = 0;
  bool started_ = false;
  RegionStatistics extra_;  ///< Only the counts that nobody else keeps.
};

}  // namespace aureole
