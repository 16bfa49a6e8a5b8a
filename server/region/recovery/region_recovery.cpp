// RegionCore and death: writing itself down, answering those who recover, and recovering.
#include <algorithm>

#include "protocol/wire.h"
#include "server/base/check.h"
#include "server/region/region_core.h"
#include "server/worlds/injector.h"

namespace aureole {
namespace {

/// Blasts that were sent shortly before the death are sent again; receivers remember them longer.
constexpr std::int64_t blasts_again_ticks = 64;
/// Snapshots that were made and not reported as written; more means that nobody writes.
constexpr std::size_t unwritten_max = 64;

}  // namespace

// ---- Snapshots ---------------------------------------------------------------------------------

SnapshotOwner RegionCore::snapshot_owner() const {
  return {world_.hash,
          self_,
          world_.regions.size(),
          hosting_.definitions().size(),
          hosting_.statics().size(),
          world_.injectors.size()};
}

void RegionCore::make_snapshot(Tick now) {
  if (!snapshots_ || now - last_snapshot_ < snapshot_interval_ticks) return;
  last_snapshot_ = now;
  Snapshot snapshot;
  snapshot.incarnation = incarnation_;
  snapshot.tick = now;
  const PhysicsWorld& physics = hosting_.physics();
  const auto ids = physics.ids();
  for (std::size_t from = 0; from < ids.size(); from += max_handoff_bodies) {
    HandoffGroup& group = snapshot.hosted.emplace_back();
    group.tick = now;
    const auto piece = ids.subspan(from, std::min(max_handoff_bodies, ids.size() - from));
    group.bodies.reserve(piece.size());
    for (BodyId id : piece)
      group.bodies.push_back({{id, physics.prototype(id), physics.state(id)},
                              hosting_.epoch(id),
                              hosting_.still_ticks(id, now)});
    for (const Avatar* avatar : players_.avatars())
      if (std::binary_search(piece.begin(), piece.end(), avatar->body()))
        group.avatars.push_back(*avatar);
  }
  Unwritten unwritten{now, {}};
  for (const auto& [id, peer] : peers_) {
    if (!id.is_region()) {
      snapshot.gateways.push_back(static_cast<std::uint16_t>(id.value - PeerId::first_gateway));
      continue;
    }
    Snapshot::Peer& entry = snapshot.peers.emplace_back();
    entry.region = id.as_region();
    for (const Journal::Entry& message : peer.journal.unacknowledged())
      entry.journal.emplace_back(message.type, message.payload);
    for (const Arrived& arrived : arrived_groups_)
      if (arrived.from == id.as_region()) entry.waiting.push_back(arrived.group);
    unwritten.taken[id] = {peer.journal.peer(), peer.journal.taken()};
  }
  snapshot.injected = injected_;
  const std::size_t kept = std::min(blasts_.size(), EffectsMessage::max_of_a_kind);
  snapshot.blasts.assign(blasts_.end() - static_cast<std::ptrdiff_t>(kept), blasts_.end());
  snapshot.removals.assign(pending_removals_.begin(), pending_removals_.end());
  snapshot_ = std::make_shared<const Bytes>(encode_snapshot(snapshot, snapshot_owner()));
  unwritten_.push_back(std::move(unwritten));
  if (unwritten_.size() > unwritten_max) unwritten_.pop_front();
}

void RegionCore::snapshot_written(Tick of) {
  while (!unwritten_.empty() && unwritten_.front().tick <= of) {
    for (const auto& [id, taken] : unwritten_.front().taken) {
      Journal& journal = peers_.at(id).journal;
      // Numbers of an incarnation that has ended since mean nothing any more.
      if (journal.peer() == taken.first) journal.note_durable(taken.second);
    }
    unwritten_.pop_front();
  }
  if (unwritten_.empty()) snapshot_.reset();
}

// ---- Answering those who recover ---------------------------------------------------------------

Status RegionCore::receive_recovery(PeerId from, Peer& peer, const FrameView& frame) {
  if (frame.type == FrameType::recovery_query) {
    if (!from.is_region()) return Error{"a gateway asked for what only regions may know"};
    const auto round = decode_recovery_query(frame.payload);
    if (!round) return round.error();
    peer.asked_round = *round;
    peer.recovering = true;
    return Ok{};
  }
  if (recovery_) {
    if (auto heard = recovery_->hear_answer(from, frame.payload); !heard) return heard;
  }
  const auto answer =
      decode_recovery_answer(frame.payload, map_.size(), hosting_.definitions().size());
  if (!answer) return answer.error();
  // Round 0 says that its sender simulates again.
  if (from.is_region() && answer->round == 0) {
    peer.recovering = false;
    note_neighbour_is_back(from.as_region());
  }
  return Ok{};
}

void RegionCore::note_traces(Tick now) {
  for (const RemovedBody& removed : hosting_.take_removed())
    traces_.remember({removed.id, removed.version, true}, now);
  traces_.prune(now);
}

RecoveryAnswer RegionCore::answer_to(const Peer& peer) const {
  RecoveryAnswer answer;
  answer.round = peer.asked_round;
  answer.recovering = recovery_ != nullptr;
  if (recovery_) {
    answer.states = recovery_->candidates();
    return answer;
  }
  answer.traces = traces_.all();
  for (BodyId id : hosting_.physics().ids())
    answer.traces.push_back({id, hosting_.version(id), false});
  for (const Arrived& arrived : arrived_groups_)
    for (const auto& b : arrived.group.bodies)
      answer.traces.push_back({b.body.id, {b.epoch + 1, incarnation_, self_}, false});
  for (const auto& [id, other] : peers_) {
    for (const Journal::Entry& entry : other.journal.unacknowledged()) {
      if (entry.type != FrameType::handoff) continue;
      const auto group =
          decode_handoff(entry.payload, hosting_.definitions().size(), hosting_.statics().size());
      AUREOLE_CHECK(group, "what was encoded here can be read back");
      for (const auto& b : group->bodies)
        answer.traces.push_back(
            {b.body.id, {b.epoch + 1, other.journal.peer(), id.as_region()}, false});
    }
  }
  return answer;
}

// ---- Recovering --------------------------------------------------------------------------------

Status RegionCore::recover(std::span<const std::byte> snapshot) {
  AUREOLE_CHECK(!started_ && !recovery_, "a region recovers before its first step");
  std::optional<Snapshot> read;
  Status status = Ok{};
  if (!snapshot.empty()) {
    // Copied, so that the bytes lie aligned whatever they come from.
    auto decoded = decode_snapshot(Bytes(snapshot.begin(), snapshot.end()), snapshot_owner());
    if (!decoded)
      status = decoded.error();
    else if (decoded->incarnation >= incarnation_)
      status = Error{"the snapshot is of a later start of this region"};
    else
      read = std::move(*decoded);
  }
  recovery_ = std::make_unique<Recovery>(
      Recovery::Setup{self_, incarnation_, map_.size(), hosting_.definitions().size(),
                      hosting_.statics().size()},
      std::move(read));
  for (const auto& [id, peer] : peers_)
    if (peer.up) recovery_->peer_up(id, peer.incarnation);
  for (const Arrived& arrived : arrived_groups_)
    if (auto heard = recovery_->hear_group(arrived.group); !heard) status = heard;
  arrived_groups_.clear();
  return status;
}

std::vector<std::string> RegionCore::recovery_waits_for() const {
  return recovery_ ? recovery_->waits_for(last_tick_) : std::vector<std::string>();
}

bool RegionCore::stays_frozen(Tick now, const ShellMeasurements& measured) {
  last_tick_ = now;
  const std::vector<PeerId> asked = recovery_->ask(now);
  if (recovery_->may_decide(now)) {
    end_recovery(now);
    return false;
  }
  const SharedBytes query = encode_recovery_query(std::max<std::uint64_t>(1, recovery_->round()));
  SharedBytes status;
  if (now.value % status_interval_ticks == 0) status = status_frame(now, measured);
  for (auto& [id, peer] : peers_) {
    if (!peer.up) continue;
    if (std::find(asked.begin(), asked.end(), id) != asked.end()) outbox_.push_back({id, query});
    if (id.is_region()) {
      if (SharedBytes frame = acknowledgement(peer)) outbox_.push_back({id, std::move(frame)});
      if (peer.asked_round != 0)
        for (SharedBytes& frame : encode_recovery_answer(answer_to(peer)))
          outbox_.push_back({id, std::move(frame)});
      peer.asked_round = 0;
    }
    if (status || peer.wants_status)
      outbox_.push_back({id, status ? status : status_frame(now, measured)});
    peer.wants_status = false;
  }
  return true;
}

void RegionCore::end_recovery(Tick now) {
  Recovery::Outcome outcome = recovery_->decide(now);
  const std::unique_ptr<Recovery> recovery = std::move(recovery_);
  extra_.unrecoverable += outcome.without_state;
  hosting_.claim(outcome.bodies, now);
  std::vector<BodyId> claimed;
  for (const auto& body : outcome.bodies) claimed.push_back(body.body.id);
  std::set<std::uint16_t> gateways;
  for (const Avatar& avatar : outcome.avatars) gateways.insert(avatar.gateway);
  players_.accept(std::move(outcome.avatars), claimed, now, has_room(1), player_output_);
  for (std::uint16_t gateway : gateways)
    if (!peers_.contains(PeerId::gateway(gateway))) players_.gateway_down(gateway, now);

  last_tick_ = now - 1;
  if (const auto& snapshot = recovery->snapshot()) {
    injected_ = snapshot->injected;
    blasts_.assign(snapshot->blasts.begin(), snapshot->blasts.end());
    for (const auto& [id, since] : snapshot->removals) pending_removals_[id] = now;
    // Blasts of the ticks between are still due.
    last_tick_ = std::min(last_tick_, snapshot->tick);
    send_again(*snapshot, now);
  } else {
    // Stores know all that was made up to the tick that they heard last.
    const Tick heard = outcome.heard.value >= 0 ? outcome.heard : now;
    for (std::size_t i = 0; i < injected_.size(); ++i)
      injected_[i] = injected_count(world_.injectors[i], std::min(heard, now));
  }
  if (outcome.nobody_knew) begin_anew(outcome.known);
  stand_ins_.look_around();
  for (BodyId id : outcome.known)
    if (id.kind() == BodyId::Kind::injected) made_before_.insert(id);
  started_ = true;
  players_.hold_all(now);
  last_snapshot_ = now - snapshot_interval_ticks;

  // To all: those who hold their bodies back, and those who recover and wait for us.
  RecoveryAnswer done;
  done.round = 0;
  for (const auto& [id, peer] : peers_)
    if (id.is_region() && peer.up)
      for (SharedBytes& frame : encode_recovery_answer(done))
        outbox_.push_back({id, std::move(frame)});
}

/// What the earlier start had to say that does not do harm when it is said twice. Its handoffs are
/// not among it: the receiver may have passed those bodies on.
void RegionCore::send_again(const Snapshot& snapshot, Tick now) {
  for (const Snapshot::Peer& peer : snapshot.peers) {
    Journal& journal = peers_.at(PeerId::region(peer.region)).journal;
    for (const auto& [type, payload] : peer.journal) {
      if (type == FrameType::commands) journal.append(type, payload);
      if (type != FrameType::effects) continue;
      auto effects = decode_effects(payload);
      AUREOLE_CHECK(effects, "a snapshot's journal is checked when it is read");
      // Whoever reached for a body has to reach again.
      effects->requests.clear();
      std::erase_if(effects->blasts,
                    [&](const BlastEffect& b) { return now - b.tick > blasts_again_ticks; });
      if (!effects->empty()) journal.append(type, encode_effects(*effects));
    }
  }
}

/// Neither a disk nor a store knows of this region: its part of the world file is all that is left.
void RegionCore::begin_anew(const std::set<BodyId>& known) {
  std::vector<NewBody> born;
  for (std::size_t i = 0; i < world_.bodies.size(); ++i) {
    const WorldBody& body = world_.bodies[i];
    const BodyId id = BodyId::world(static_cast<std::uint32_t>(i));
    const WorldPosition& at = body.state.position;
    const RegionId home = body.host ? *body.host : map_.region_at(at.x, at.z);
    if (home == self_ && !known.contains(id)) born.push_back({id, body.prototype, body.state});
  }
  hosting_.spawn(born, 1 + Recovery::claimed_epochs_ahead);
}

}  // namespace aureole
