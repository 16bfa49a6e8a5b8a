// One region's state machine: messages in, messages out, time as an argument.
//
// No sockets, threads, clocks, files or global random numbers. The TCP server and the simulation
// run this same object, so that what is tested under faults is what runs in production.
#pragma once

#include <boost/container/flat_map.hpp>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "protocol/frame.h"
#include "server/aura/migration_policy.h"
#include "server/aura/partition/partition_map.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/tick.h"
#include "server/region/auras/aura_exchange.h"
#include "server/region/handoff/handoff.h"
#include "server/region/handoff/journal.h"
#include "server/region/hosting.h"
#include "server/region/lines/home_lines.h"
#include "server/region/loads/load_levels.h"
#include "server/region/players/effects.h"
#include "server/region/players/players.h"
#include "server/region/recovery/recovery.h"
#include "server/region/recovery/traces.h"
#include "server/region/stand_ins/stand_in_watch.h"
#include "server/region/stand_ins/stand_ins.h"
#include "server/region/step_profile.h"
#include "server/region/tolerances/followed_latency.h"
#include "server/region/tolerances/tolerances.h"
#include "server/region/view/hosted_bodies.h"
#include "server/worlds/world.h"

namespace aureole {

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
  /// Of the step before this one: from the time of its tick until its messages were given away.
  double last_frame_ms = 0;
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
  std::uint64_t whole_looks = 0;     ///< Decisions made over the whole region.
  std::uint64_t unacknowledged = 0;  ///< Messages in the journals.
  /// Messages that journals let go before they were durable (Journal::let_go()).
  std::uint64_t let_go = 0;
  std::uint64_t stand_ins = 0;  ///< Resting bodies of others that ours can lean on.
  /// Stand-ins whose load rose above its value at the cut by more than mass × 0.15 m/s:
  /// interactions that were missed.
  std::uint64_t struck_stand_ins = 0;
  std::uint64_t tolerance_events = 0;  ///< Times that a tolerance was left.
  std::uint64_t recovered = 0;         ///< Bodies claimed after the death of an earlier start.
  /// Bodies that should have been claimed, but of which nobody knew a state; 0 unless disks and
  /// gateways were lost together.
  std::uint64_t unrecoverable = 0;
};

class RegionCore {
 public:
  /// `world` must outlive the core. `self` is one of its regions.
  RegionCore(const WorldDefinition& world, RegionId self, Incarnation incarnation);

  void peer_up(PeerId peer, Incarnation incarnation);
  void peer_down(PeerId peer);
  /// Validates and queues, does nothing else. After an Error the link must be closed; nothing of
  /// the message has been taken.
  Status receive(PeerId from, const FrameView& frame);
  /// Exactly one step of 16 ms, to tick `now`, which must be later than the step before.
  void step(Tick now, const ShellMeasurements& measured = {});
  /// One way, measured by the shell or modelled by the simulation; call whenever there is news.
  void link_measured(RegionId peer, double latency_ms);
  /// Tolerances left and entered in the last step. Valid until the next step.
  std::span<const ToleranceEvent> tolerance_events() const { return tolerances_.events(); }
  /// What is outside its tolerance now, the worst of each kind.
  std::vector<ToleranceEvent> outside_tolerances() const { return tolerances_.outside(); }

  /// From now on the latency tolerance is not the world's but follows what links measure. What
  /// players do is still announced as early as the world's tolerances ask for.
  void follow_latency() { followed_latency_.emplace(world_.tolerances); }
  /// What auras are sized by now.
  const AuraTolerances& tolerances_in_force() const { return tolerances_.limits(); }

  /// Servers of a world with corners are ordered by their loads from so many bodies awake on; see
  /// LoadLevels::awake_min; in a row lines move from half as many on. Fewer than that are for
  /// tests: lines then leave any crowd, whoever gets it, and come back if that is far too much for
  /// it. `crowd_share`: they leave those of at most this share of all that is awake instead, and
  /// share out the others. All servers of a world must agree.
  void level_from(double awake, std::optional<double> crowd_share = {});

  /// From now on what has been taken counts as durable only once it is in a snapshot that has been
  /// written. Without snapshots it counts as durable at once, and is lost if this process dies.
  void enable_snapshots() { snapshots_ = true; }
  /// The state to be written after the last step to where it survives this process; null if none is
  /// due. What has been written is told by snapshot_written().
  SharedBytes snapshot_due() const { return snapshot_; }
  /// The snapshot of tick `of` is where it survives.
  void snapshot_written(Tick of);
  static constexpr std::int64_t snapshot_interval_ticks = 6;

  /// Makes this core the successor of an earlier start of the same region that died. `snapshot` is
  /// what the earlier one had written last; empty if it is gone. Call before the first step: the
  /// core then hosts nothing until everyone who might hold something newer has said what they
  /// hold. An Error (the snapshot is not one of this region and world, or is damaged) says why it
  /// counts as none; the core recovers from what others know.
  Status recover(std::span<const std::byte> snapshot);
  bool recovering() const { return recovery_ != nullptr; }
  /// Who has not answered yet, for people; empty unless recovering.
  std::vector<std::string> recovery_waits_for() const;

  /// From now on steps tell `profile` which part they are in; null: nobody asks, and no clock is
  /// read. It must outlive the core or the next call.
  void profile_steps(StepProfile* profile) { profile_ = profile; }

  /// What the last step wants sent, in order. Valid until the next step.
  std::span<const Outgoing> outbox() const { return outbox_; }

  std::uint64_t state_hash() const;
  RegionStatistics statistics() const;
  const PhysicsWorld& physics() const { return hosting_.physics(); }
  const Hosting& hosting() const { return hosting_; }
  const Journal& journal(RegionId peer) const { return peers_.at(PeerId::region(peer)).journal; }
  const PartitionMap& partition() const { return map_; }
  /// Where regions end now as far as homes are concerned; see home_lines.h.
  const HomeLines& home_lines() const { return home_lines_; }
  const StandInWatch& stand_in_watch() const { return stand_in_watch_; }

  /// Work per step to bring late groups to the present: bodies × steps. What is above it waits.
  static constexpr std::int64_t catch_up_budget = 4000;
  /// Older groups are brought on by this many ticks only (1 s), and counted.
  static constexpr std::int64_t catch_up_ticks_max = 62;
  static constexpr std::int64_t status_interval_ticks = 16;
  /// A sleeping region decides again at least this often (islands wait their time before they go).
  static constexpr std::int64_t decision_interval_ticks = 8;
  /// After a link came up its peer is handed nothing before it has told its auras, or this has
  /// passed: whoever decides without them sends bodies where they cannot stay. What meets at other
  /// servers cannot wait for it.
  static constexpr std::int64_t await_auras_ticks = 8;

 private:
  struct Peer {
    bool up = false;
    Tick up_since;
    bool wants_whole_state = false;  ///< Gateways, after link up.
    bool wants_status = false;       ///< Regions, the same: our level may have changed.
    Journal journal;                 ///< Regions.
    std::uint32_t bodies = 0;        ///< Last heard.
    Incarnation incarnation;
    bool met = false;                   ///< Has been up once.
    bool recovering = false;            ///< Simulates nothing yet; it has asked us what we know.
    std::optional<Rectangle> closed;    ///< Its home when it went down, until it is back.
    std::uint64_t asked_round = 0;      ///< Of a recovery query that waits for its answer; 0: none.
    std::int64_t word_every_ticks = 1;  ///< Regions: see signs_of_life.h.
  };
  struct Arrived {
    RegionId from;
    HandoffGroup group;
    std::size_t bytes = 0;  ///< That it came in.
  };

  void enter(StepProfile::Part part) {
    if (profile_ != nullptr) profile_->enter(part);
  }
  void fetch_peers() const;
  void take_in(Tick now);
  void take_in_groups(Tick now);
  void take_in_effects(Tick now);
  void take_in_commands(Tick now);
  void spawn(Tick now);
  void apply_blasts(Tick now);
  void remove_strays(Tick now);
  bool decides_at(Tick now) const;
  void find_remote_auras();
  void migrate(Tick now);
  std::vector<BodyId> stirred_bodies(Tick now) const;
  std::span<const HostedBody> look_at_hosted(Tick now);
  const MigrationDecision& decide(Tick now);
  void foresee_blasts(std::vector<HostedBody>& hosted, Tick now) const;
  void foresee_deeds(std::vector<HostedBody>& hosted, Tick now);
  void watch_stand_ins(Tick now);
  Hosting::Cut cut() const;
  bool nothing_stirs(Tick now) const;
  void emigrate(std::span<const BodyId> bodies, RegionId to, Tick now);
  void schedule_blast(const BlastEffect& blast, Tick now);
  void remove_somewhere(BodyId body, Tick now);
  void send_player_output();
  void publish(Tick now, const SharedBytes& update, const ShellMeasurements& measured);
  std::vector<VersionedBody> passive_copies() const;
  void note_awake(RegionId region, std::size_t awake);
  bool has_room(std::size_t more) const;
  bool is_up(RegionId region) const;
  bool waits_for_auras(RegionId region, const Peer& peer, Tick now) const;
  void note_neighbour_is_back(RegionId region);
  std::vector<Rectangle> close_areas();
  LoadLevels::Told tell_level(Tick now);
  SharedBytes status_frame(Tick now, const ShellMeasurements& measured);
  SharedBytes acknowledgement(Peer& peer);
  void judge_tolerances(Tick now, const ShellMeasurements& measured);

  // region/recovery/: snapshots, answers to those who recover, and our own recovery.
  SnapshotOwner snapshot_owner() const;
  void make_snapshot(Tick now);
  Status receive_recovery(PeerId from, Peer& peer, const FrameView& frame);
  /// Whether so much more may wait for the next step.
  Status check_room(const EffectsMessage& effects) const;
  void note_traces(Tick now);
  RecoveryAnswer answer_to(const Peer& peer) const;
  bool stays_frozen(Tick now, const ShellMeasurements& measured);
  void end_recovery(Tick now);
  void send_again(const Snapshot& snapshot, Tick now);
  void begin_anew(const std::set<BodyId>& known);

  const WorldDefinition& world_;
  RegionId self_;
  Incarnation incarnation_;
  PartitionMap map_;
  std::unique_ptr<MigrationPolicy> policy_;
  Hosting hosting_;
  Players players_;
  boost::container::flat_map<PeerId, Peer> peers_;  ///< Side by side: see fetch_peers().

  AuraExchange aura_exchange_;
  StandIns stand_ins_;
  StandInWatch stand_in_watch_;
  std::set<BodyId> handed_over_;  ///< Since auras were announced last.
  std::vector<HandoverRequest> handover_requests_;
  std::deque<Arrived> arrived_groups_;
  std::deque<std::pair<RegionId, EffectsMessage>> arrived_effects_;
  std::vector<PlayerCommand> arrived_commands_;
  std::deque<BlastEffect> blasts_;           ///< To come and recent, by tick.
  std::map<BodyId, Tick> pending_removals_;  ///< Of bodies that may be on their way here.
  HostedBodies hosted_bodies_;
  std::vector<double> awake_everywhere_;  ///< By region, smoothed; 0: not heard of.
  LoadLevels load_levels_;
  std::vector<std::uint16_t> neighbours_;  ///< How many each region has (precedence.h).
  HomeLines home_lines_;
  std::size_t largest_cluster_ = 0;  ///< As of the last decision, if it was asked.
  /// Of bodies that are not hosted here; valid within migrate().
  std::span<const RemoteAura> remote_auras_;
  std::vector<RemoteAura> others_auras_;  ///< Kept for its memory, like the next one.
  std::vector<bool> linked_;              ///< By region; valid within decide().
  PlayerOutput player_output_;
  std::vector<Outgoing> outbox_;
  /// For each injector, how many it had made; not counted if it may not inject here.
  std::vector<std::uint64_t> injected_;
  std::vector<bool> may_inject_here_;  ///< For each: whether any of its volume is in our region.
  Tick last_tick_;
  Tick last_decision_{-decision_interval_ticks};
  std::uint64_t changes_at_decision_ = 0;
  bool started_ = false;
  bool snapshots_ = false;
  SharedBytes snapshot_;
  Tick last_snapshot_{-snapshot_interval_ticks};
  /// What was taken of whom when snapshots were made that have not been written yet.
  struct Unwritten {
    Tick tick;
    std::map<PeerId, std::pair<Incarnation, std::uint64_t>> taken;
  };
  std::deque<Unwritten> unwritten_;
  Traces traces_;
  std::unique_ptr<Recovery> recovery_;
  std::set<BodyId> made_before_;  ///< Injected by an earlier start after its last snapshot.
  Tolerances tolerances_;
  std::optional<FollowedLatency> followed_latency_;
  FastestBody fastest_;     ///< Of the last step.
  RegionStatistics extra_;  ///< Only the counts that nobody else keeps.
  StepProfile* profile_ = nullptr;
};

}  // namespace aureole
