// One step of a region, in the order that the design lays down.
#include <algorithm>
#include <cmath>
#include <set>

#include "protocol/wire.h"
#include "server/aura/adaptive/outlook/aura_size.h"
#include "server/base/check.h"
#include "server/base/prefetch.h"
#include "server/region/closed_boundary.h"
#include "server/region/handoff/catch_up.h"
#include "server/region/region_core.h"
#include "server/region/signs_of_life.h"
#include "server/worlds/injector.h"

namespace aureole {
namespace {

/// Of one injector; far more than any that runs evenly makes.
constexpr std::uint64_t injected_per_step_max = 4096;
/// Blasts are remembered this long for groups that arrive late.
constexpr std::int64_t remember_blasts_ticks = 128;
/// A removal waits this long for a body that may be in flight.
constexpr std::int64_t remember_removals_ticks = 128;
/// Blasts are planned ahead by the aura tolerances, at most 30 s in any world file; what claims to
/// come later would only pile up.
constexpr std::int64_t blast_ahead_ticks_max = 2048;
/// Effects and commands that may wait for a region that is away. Whoever is away for so long has
/// more to catch up with than blasts; handoffs are not sent to it in the first place.
constexpr std::size_t waiting_messages_max = 4096;

/// The n-th piece of `size` elements, empty past the end.
template <class T>
std::span<const T> piece(const std::vector<T>& all, std::size_t n, std::size_t size) {
  const std::size_t from = std::min(n * size, all.size());
  return std::span(all).subspan(from, std::min(size, all.size() - from));
}

}  // namespace

void RegionCore::step(Tick now, const ShellMeasurements& measured) {
  AUREOLE_CHECK(!started_ || now > last_tick_, "time goes forwards");
  outbox_.clear();
  if (recovery_ && stays_frozen(now, measured)) return;
  // A region that was held up leaves ticks out; its bodies are then where they were at the last
  // one, which is the present as far as arriving groups are concerned.
  take_in(now);
  enter(StepProfile::Part::physics);
  spawn(now);
  apply_blasts(now);
  players_.drive(now, has_room(1), player_output_);
  ClosedBoundary closed(close_areas());
  closed.before_step(hosting_.physics(), tick_s);
  hosting_.physics().step(tick_s);
  closed.after_step(hosting_.physics());
  enter(StepProfile::Part::aura);
  fetch_peers();
  watch_stand_ins(now);
  enter(StepProfile::Part::physics);
  remove_strays(now);
  enter(StepProfile::Part::wire);
  // Gateways hear of this step from the server that took it, also of bodies that leave now: their
  // new owner speaks of the next step first, and without this one they would be seen to falter.
  const SharedBytes update =
      hosting_.publisher().update(now, hosting_.physics(), players_.avatars());
  enter(StepProfile::Part::decide);
  migrate(now);
  enter(StepProfile::Part::wire);
  send_player_output();
  note_traces(now);
  judge_tolerances(now, measured);
  publish(now, update, measured);
  last_tick_ = now;
  started_ = true;
  make_snapshot(now);
}

/// Each of them is asked several things in what follows, and a step of physics has put them far
/// away.
void RegionCore::fetch_peers() const {
  prefetch_beginning(peers_, 64 * cache_line);
  aura_exchange_.fetch();
}

void RegionCore::judge_tolerances(Tick now, const ShellMeasurements& measured) {
  tolerances_.step(now, measured.last_frame_ms, fastest_);
  if (!followed_latency_) return;
  const auto changed = followed_latency_->step(now, tolerances_.longest_latency_ms());
  if (!changed) return;
  tolerances_.set_limits(*changed);
  policy_->set_tolerances(*changed);
}

void RegionCore::take_in(Tick now) {
  enter(StepProfile::Part::wire);
  take_in_groups(now);
  take_in_effects(now);
  take_in_commands(now);
  enter(StepProfile::Part::aura);
  stand_ins_.take(aura_exchange_.take_resting_news(), now);
  if (!decides_at(now)) return;
  handover_requests_ = aura_exchange_.take_in();
  stand_ins_.tidy(aura_exchange_.remote(), now);
}

void RegionCore::take_in_groups(Tick now) {
  if (arrived_groups_.empty()) return;
  const Tick present = now - 1;
  std::int64_t budget = catch_up_budget;
  std::deque<Arrived> waiting;
  for (Arrived& arrived : arrived_groups_) {
    HandoffGroup& group = arrived.group;
    const std::int64_t behind = present - group.tick;
    const std::int64_t steps = std::clamp<std::int64_t>(behind, 0, catch_up_ticks_max);
    const std::int64_t work = steps * static_cast<std::int64_t>(group.bodies.size());
    // From our future: waits, unless it is so far ahead that the sender's clock must be wrong. Too
    // much for this step: waits too, unless nothing else has been done.
    const bool early = behind < 0 && behind >= -catch_up_ticks_max;
    if (early || (work > budget && budget < catch_up_budget)) {
      waiting.push_back(std::move(arrived));
      continue;
    }
    budget -= work;
    group.tick = present - steps;
    extra_.catch_up_steps += static_cast<std::uint64_t>(steps);
    const std::vector<BlastEffect> recent(blasts_.begin(), blasts_.end());
    std::vector<NewBody> coming;
    for (const auto& b : group.bodies) coming.push_back(b.body);
    stand_ins_.note_ours(coming);
    catch_up(group, {hosting_.definitions(), hosting_.physics(), present, recent, AvatarTuning{}});
    stand_ins_.came_along(group.stand_ins, arrived.from, now);
    const std::vector<BodyId> taken = hosting_.accept(group, arrived.from, now);
    stand_ins_.arrived(taken);
    std::set<std::uint16_t> gateways;
    for (const Avatar& avatar : group.avatars) gateways.insert(avatar.gateway);
    players_.accept(std::move(group.avatars), taken, now, has_room(1), player_output_);
    // A gateway that went while its player was on the way took the player along.
    for (std::uint16_t gateway : gateways)
      if (!peers_.contains(PeerId::gateway(gateway))) players_.gateway_down(gateway, now);
    for (BodyId id : taken)
      if (pending_removals_.erase(id) > 0) remove_somewhere(id, now);
  }
  arrived_groups_ = std::move(waiting);
}

void RegionCore::take_in_effects(Tick now) {
  for (auto& [from, effects] : arrived_effects_) {
    for (const BlastEffect& blast : effects.blasts) schedule_blast(blast, now);
    for (BodyId id : effects.removals) remove_somewhere(id, now);
    for (const BodyRequest& request : effects.requests) {
      const bool ours_to_give = hosting_.hosts(request.body) &&
                                request.body.kind() != BodyId::Kind::avatar &&
                                players_.carrier_of(request.body) == BodyId{};
      if (ours_to_give && is_up(from)) emigrate(std::span(&request.body, 1), from, now - 1);
    }
  }
  arrived_effects_.clear();
  std::erase_if(pending_removals_,
                [&](const auto& r) { return now - r.second > remember_removals_ticks; });
}

void RegionCore::take_in_commands(Tick now) {
  for (const PlayerCommand& command : arrived_commands_)
    players_.command(command, now, has_room(1), player_output_);
  arrived_commands_.clear();
  // Our own blasts take effect here as they do elsewhere.
  for (const BlastEffect& blast : player_output_.effects.blasts) schedule_blast(blast, now);
}

void RegionCore::schedule_blast(const BlastEffect& blast, Tick now) {
  // A region that has recovered sends again what it had sent before.
  const auto is_known = [&](const BlastEffect& b) {
    return b.id == blast.id && b.position == blast.position;
  };
  if (std::any_of(blasts_.begin(), blasts_.end(), is_known)) return;
  BlastEffect timely = blast;
  if (timely.tick < now) {
    ++extra_.late_effects;
    timely.tick = now;
  }
  timely.tick = std::min(timely.tick, now + blast_ahead_ticks_max);
  const auto at = std::upper_bound(blasts_.begin(), blasts_.end(), timely,
                                   [](const BlastEffect& a, const BlastEffect& b) {
                                     return std::pair(a.tick, a.id) < std::pair(b.tick, b.id);
                                   });
  blasts_.insert(at, timely);
}

void RegionCore::apply_blasts(Tick now) {
  // Those of ticks that were left out count too, late as they are.
  for (const BlastEffect& blast : blasts_) {
    const bool due = blast.tick == now || (started_ && blast.tick > last_tick_ && blast.tick < now);
    if (due) apply_blast(hosting_.physics(), blast);
  }
  while (!blasts_.empty() && now - blasts_.front().tick > remember_blasts_ticks)
    blasts_.pop_front();
}

void RegionCore::remove_somewhere(BodyId body, Tick now) {
  if (hosting_.hosts(body)) {
    hosting_.remove(std::span(&body, 1));
    players_.forget(body);
  } else {
    pending_removals_[body] = now;
  }
}

void RegionCore::spawn(Tick now) {
  std::vector<NewBody> born;
  if (!started_) {
    for (std::size_t i = 0; i < world_.bodies.size(); ++i) {
      const WorldBody& body = world_.bodies[i];
      const WorldPosition& at = body.state.position;
      const RegionId home = body.host ? *body.host : map_.region_at(at.x, at.z);
      if (home == self_)
        born.push_back({BodyId::world(static_cast<std::uint32_t>(i)), body.prototype, body.state});
    }
  }
  for (std::size_t i = 0; i < world_.injectors.size(); ++i) {
    if (!may_inject_here_[i]) continue;
    const Injector& injector = world_.injectors[i];
    // After a leap of world time the bodies of the time between come bit by bit.
    const std::uint64_t made =
        std::min(injected_count(injector, now), injected_[i] + injected_per_step_max);
    // A world that starts again from older states of others may be behind ours.
    if (made <= injected_[i]) continue;
    for (std::uint64_t n = injected_[i]; n < made; ++n) {
      const InjectedBody body = injected_body(injector, n);
      if (map_.region_at(body.state.position.x, body.state.position.z) != self_) continue;
      if (made_before_.contains(BodyId::injected(static_cast<std::uint16_t>(i), n))) continue;
      if (!has_room(born.size() + 1)) {
        ++extra_.refused_bodies;
        continue;
      }
      born.push_back(
          {BodyId::injected(static_cast<std::uint16_t>(i), n), body.prototype, body.state});
    }
    injected_[i] = made;
  }
  stand_ins_.note_ours(born);
  hosting_.spawn(born);
}

void RegionCore::remove_strays(Tick) {
  std::vector<BodyId> strays;
  std::vector<PlayerId> fallen;
  fastest_ = {};
  float fastest_squared = 0;
  const Box3& bounds = world_.bounds;
  for (const auto& [id, prototype, state] : hosting_.physics().awake()) {
    if (const float squared = state.linear_velocity.squaredNorm(); squared > fastest_squared) {
      fastest_squared = squared;
      fastest_.body = id;
    }
    const Eigen::Vector3d p = state.position.vector();
    // Written so that a position that is not a number counts as outside. No other server would take
    // a state whose numbers have burst.
    const bool inside = (p.array() >= bounds.min.array()).all() &&
                        (p.array() <= bounds.max.array()).all() && may_travel(state);
    if (inside) continue;
    if (id.kind() == BodyId::Kind::avatar && players_.is_avatar_here(id.player()))
      fallen.push_back(id.player());
    else
      strays.push_back(id);
  }
  fastest_.speed_mps = double{std::sqrt(fastest_squared)};
  for (PlayerId player : fallen) players_.respawn(player, static_cast<std::uint16_t>(player.value));
  hosting_.remove(strays);
  for (BodyId id : strays) players_.forget(id);
  extra_.removed_strays += strays.size();
}

void RegionCore::send_player_output() {
  const auto has_place = [](const Peer& peer) {
    return peer.up || peer.journal.unacknowledged().size() < waiting_messages_max;
  };
  // Cut as receivers want it: a message that they refuse would be sent again for ever.
  const EffectsMessage& all = player_output_.effects;
  constexpr std::size_t most = EffectsMessage::max_of_a_kind;
  for (std::size_t n = 0;; ++n) {
    const auto blasts = piece(all.blasts, n, most);
    const auto removals = piece(all.removals, n, most);
    const auto requests = piece(all.requests, n, most);
    const EffectsMessage part{{blasts.begin(), blasts.end()},
                              {removals.begin(), removals.end()},
                              {requests.begin(), requests.end()}};
    if (part.empty()) break;
    const Bytes payload = encode_effects(part);
    for (auto& [id, peer] : peers_)
      if (id.is_region() && has_place(peer)) peer.journal.append(FrameType::effects, payload);
  }
  for (const auto& [to, commands] : player_output_.forwarded) {
    Peer& peer = peers_.at(PeerId::region(to));
    for (std::size_t n = 0; n * max_commands < commands.size() && has_place(peer); ++n)
      peer.journal.append(FrameType::commands, encode_commands(piece(commands, n, max_commands)));
  }
  player_output_ = {};
}

std::vector<VersionedBody> RegionCore::passive_copies() const {
  std::vector<VersionedBody> copies;
  for (const auto& [id, peer] : peers_) {
    for (const Journal::Entry& entry : peer.journal.unacknowledged()) {
      // What the receiver has taken it tells itself; it may have removed it since.
      if (entry.type != FrameType::handoff || peer.journal.is_taken(entry)) continue;
      auto group =
          decode_handoff(entry.payload, hosting_.definitions().size(), hosting_.statics().size());
      AUREOLE_CHECK(group, "what was encoded here can be read back");
      for (const auto& b : group->bodies)
        if (!hosting_.hosts(b.body.id)) copies.push_back({b.body, {b.epoch, incarnation_, self_}});
    }
  }
  for (const Arrived& arrived : arrived_groups_)
    for (const auto& b : arrived.group.bodies)
      if (!hosting_.hosts(b.body.id)) copies.push_back({b.body, {b.epoch, incarnation_, self_}});
  return copies;
}

LoadLevels::Told RegionCore::tell_level(Tick now) {
  // In rows the order never changes.
  if (map_.has_corners() && hearing_ticks(tolerances_.limits()) > decision_ticks)
    return load_levels_.tell(now, [](std::uint16_t) { return LoadLevels::last; });
  return load_levels_.tell(now, awake_everywhere_[self_.value],
                           static_cast<double>(largest_cluster_));
}

SharedBytes RegionCore::status_frame(Tick now, const ShellMeasurements& measured) {
  const RegionStatistics s = statistics();
  const LoadLevels::Told level = tell_level(now);
  const LineNews lines = home_lines_.tell(now, awake_everywhere_[self_.value]);
  flatbuffers::FlatBufferBuilder builder(256);
  std::vector<wire::ToleranceMark> outside;
  for (const ToleranceEvent& e : tolerances_.outside())
    outside.emplace_back(e.tick.value, e.value, e.limit, e.peer.value,
                         static_cast<std::uint8_t>(e.kind));
  const auto outside_at = builder.CreateVectorOfStructs(outside);
  const auto crowd_at = home_lines_.rule() == HomeLines::Rule::quiet_places
                            ? builder.CreateVector(lines.crowd_below.encoded())
                            : 0;
  return std::make_shared<const Bytes>(finish_frame(
      builder,
      wire::CreateRegionStatus(builder, now.value, static_cast<std::uint32_t>(s.bodies),
                               static_cast<std::uint32_t>(s.awake), measured.frame_us_p50,
                               measured.frame_us_max, s.migrations_in, s.migrations_out,
                               measured.overruns, measured.skipped_ticks, s.removed_strays,
                               static_cast<std::uint32_t>(s.unacknowledged), recovering(),
                               outside_at, s.tolerance_events, s.struck_stand_ins, s.whole_looks,
                               level.now, level.next, lines.level.now, lines.level.next,
                               lines.level_below, crowd_at, lines.gain),
      FrameType::region_status));
}

/// Null if none is due.
SharedBytes RegionCore::acknowledgement(Peer& peer) {
  if (!snapshots_ && !recovery_) peer.journal.note_durable(peer.journal.taken());
  if (!peer.journal.take_acknowledgement_due()) return nullptr;
  flatbuffers::FlatBufferBuilder builder(64);
  return std::make_shared<const Bytes>(finish_frame(
      builder, wire::CreateAcknowledge(builder, peer.journal.taken(), peer.journal.durable()),
      FrameType::acknowledge));
}

void RegionCore::publish(Tick now, const SharedBytes& update, const ShellMeasurements& measured) {
  const auto avatars = players_.avatars();
  SharedBytes status, sign_of_life;
  if (now.value % status_interval_ticks == 0) {
    note_awake(self_, hosting_.physics().awake_count());
    home_lines_.note_awake(hosting_.physics().awake(), awake_everywhere_);
    status = status_frame(now, measured);
  }
  for (auto& [id, peer] : peers_) {
    if (!peer.up) continue;
    if (id.is_region()) {
      if (SharedBytes frame = acknowledgement(peer)) outbox_.push_back({id, std::move(frame)});
      for (SharedBytes& frame : peer.journal.take_unsent())
        outbox_.push_back({id, std::move(frame)});
      // Behind the groups: who recovers has them when it hears what we know.
      if (peer.asked_round != 0)
        for (SharedBytes& frame : encode_recovery_answer(answer_to(peer)))
          outbox_.push_back({id, std::move(frame)});
      peer.asked_round = 0;
      if (SharedBytes auras = aura_exchange_.take_frame(id.as_region())) {
        outbox_.push_back({id, std::move(auras)});
      } else if (!started_ || is_word_due(last_tick_, now, peer.word_every_ticks) ||
                 aura_exchange_.tells(id.as_region())) {
        if (!sign_of_life) sign_of_life = aura_exchange_.sign_of_life(now);
        outbox_.push_back({id, sign_of_life});
      }
    } else if (peer.wants_whole_state) {
      peer.wants_whole_state = false;
      for (SharedBytes& frame :
           hosting_.publisher().whole_state(now, hosting_.physics(), passive_copies(), avatars))
        outbox_.push_back({id, std::move(frame)});
    } else {
      outbox_.push_back({id, update});
    }
    if (status || peer.wants_status)
      outbox_.push_back({id, status ? status : status_frame(now, measured)});
    peer.wants_status = false;
  }
}

}  // namespace aureole
