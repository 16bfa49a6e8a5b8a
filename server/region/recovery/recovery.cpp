// Collecting what is known of every body, waiting for those who might know more, and claiming.
#include "server/region/recovery/recovery.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "server/base/check.h"

namespace aureole {
namespace {

std::uint32_t epochs_later(std::uint32_t epoch, std::uint32_t count) {
  return epoch + std::min(count, std::numeric_limits<std::uint32_t>::max() - epoch);
}

std::string name_of(PeerId peer) {
  return peer.is_region() ? fmt::format("region r{}", peer.value)
                          : fmt::format("gateway {}", peer.value - PeerId::first_gateway);
}

/// A player's commands are applied at most once: what a store has seen applied is not applied
/// again, although the avatar is taken from an older copy.
void bring_up_to(Avatar& avatar, const KnownPlayer& seen) {
  if (seen.session > avatar.session) {
    avatar.session = seen.session;
    avatar.applied_sequence = seen.applied_sequence;
    avatar.carried = seen.carried;
    avatar.keys = 0;
    avatar.waiting.clear();
  } else if (seen.session == avatar.session && seen.applied_sequence > avatar.applied_sequence) {
    avatar.applied_sequence = seen.applied_sequence;
    avatar.carried = seen.carried;
    std::erase_if(avatar.waiting,
                  [&](const auto& waiting) { return waiting.first <= seen.applied_sequence; });
  }
}

/// The next body that the player throws must not be named like one that is known already.
void raise_thrown(Avatar& avatar, const std::set<BodyId>& known) {
  auto it = known.lower_bound(BodyId::thrown(avatar.player, 0));
  const BodyId last = BodyId::thrown(avatar.player, 0xff'ffffu);
  for (; it != known.end() && *it <= last; ++it) {
    const std::uint32_t ahead =
        (static_cast<std::uint32_t>(it->value) - avatar.thrown) & 0xff'ffffu;
    if (ahead < 0x80'0000u) avatar.thrown += ahead + 1;
  }
}

}  // namespace

Recovery::Recovery(const Setup& setup, std::optional<Snapshot> snapshot)
    : setup_(setup), snapshot_(std::move(snapshot)) {
  for (std::size_t i = 0; i < setup.regions; ++i)
    if (i != setup.self.value) peers_[PeerId::region(RegionId{static_cast<std::uint16_t>(i)})];
  if (!snapshot_) return;
  for (const HandoffGroup& group : snapshot_->hosted) note_group(group, snapshot_->incarnation, 0);
  for (const Snapshot::Peer& peer : snapshot_->peers) {
    // Where the receiver took it, the receiver's answer names a higher version than the sender's.
    for (const auto& [type, payload] : peer.journal) {
      if (type != FrameType::handoff) continue;
      const auto group = decode_handoff(payload, setup.prototypes, setup.statics);
      AUREOLE_CHECK(group, "a snapshot's journal is checked when it is read");
      note_group(*group, snapshot_->incarnation, 0);
    }
    for (const HandoffGroup& group : peer.waiting) note_group(group, snapshot_->incarnation, 1);
  }
}

void Recovery::peer_up(PeerId id, Incarnation incarnation) {
  Peer& peer = peers_[id];
  peer = Peer{};
  peer.up = true;
  peer.incarnation = incarnation;
  if (id.is_region()) new_round_ = true;
}

void Recovery::peer_down(PeerId id) {
  if (id.is_region()) {
    peers_[id].up = false;
    new_round_ = true;
  } else {
    peers_.erase(id);
  }
}

Status Recovery::check_room(std::size_t bodies, std::size_t players) const {
  if (known_.size() + bodies > 2 * known_max || players_.size() + players > 2 * known_max)
    return Error::format("servers tell a recovering region of more than {} bodies or players",
                         2 * known_max);
  return Ok{};
}

Status Recovery::hear_group(const HandoffGroup& group) {
  if (auto ok = check_room(group.bodies.size(), 0); !ok) return ok;
  note_group(group, setup_.incarnation, 1);
  return Ok{};
}

Status Recovery::hear_answer(PeerId from, std::span<const std::byte> payload) {
  auto answer = decode_recovery_answer(payload, setup_.regions, setup_.prototypes);
  if (!answer) return answer.error();
  Peer& peer = peers_.at(from);
  if (answer->round == 0) {
    // It has claimed what is its own; what others said before that may have moved on since.
    peer.recovering = false;
    new_round_ = true;
    return Ok{};
  }
  if (auto ok = check_room(answer->traces.size() + answer->states.size(), answer->players.size());
      !ok)
    return ok;
  // Versions that have existed stay true, whichever round they come from.
  for (const Trace& trace : answer->traces) {
    Known& known = known_[trace.id];
    if (!trace.removed)
      known.newest = std::max(known.newest, trace.version);
    else if (!known.removed || *known.removed < trace.version)
      known.removed = trace.version;
  }
  for (const KnownState& state : answer->states) {
    note_state({state.body, state.version.epoch, 0}, state.version, false);
    if (from.is_region() && answer->recovering) {
      Version& candidate = peer.candidates[state.body.id];
      candidate = std::max(candidate, state.version);
    }
  }
  if (!from.is_region()) {
    heard_ = std::max(heard_, answer->heard);
    for (const KnownPlayer& player : answer->players) {
      KnownPlayer& held = players_[player.player];
      if (std::pair(player.session, player.applied_sequence) >=
          std::pair(held.session, held.applied_sequence))
        held = player;
    }
  }
  if (answer->complete) {
    peer.answered = std::max(peer.answered, answer->round);
    peer.has_ever_answered = true;
    if (peer.recovering && !answer->recovering) new_round_ = true;
    peer.recovering = from.is_region() && answer->recovering;
  }
  return Ok{};
}

bool Recovery::all_regions_up() const {
  return std::all_of(peers_.begin(), peers_.end(),
                     [](const auto& entry) { return !entry.first.is_region() || entry.second.up; });
}

std::vector<PeerId> Recovery::ask(Tick now) {
  if (!began_) began_ = now;
  if (!all_regions_up()) return {};
  if (new_round_) {
    // Answers of one round are given while all regions are there, so that a body that moves
    // between them is in one of the answers or its trace is.
    ++round_;
    new_round_ = false;
  }
  std::vector<PeerId> asked;
  for (auto& [id, peer] : peers_) {
    if (!peer.up || peer.asked == round_) continue;
    peer.asked = round_;
    peer.asked_at = now;
    asked.push_back(id);
  }
  return asked;
}

std::vector<std::string> Recovery::waits_for(Tick now) const {
  std::vector<std::string> names;
  const std::int64_t waited = began_ ? now - *began_ : 0;
  bool a_store_answered = false;
  for (const auto& [id, peer] : peers_) {
    a_store_answered |= !id.is_region() && peer.has_ever_answered;
    if (id.is_region()) {
      const bool answered = peer.up && round_ > 0 && !new_round_ && peer.answered == round_;
      // Of those that recover at the same time the lower number decides first, and the others see
      // what it has claimed.
      const bool goes_first = peer.recovering && id.as_region() < setup_.self;
      if (!answered || goes_first) names.push_back(name_of(id));
    } else if (peer.answered != round_) {
      const bool has_given_up = peer.asked == round_ && now - peer.asked_at >= any_gateway_ticks;
      if (!has_given_up) names.push_back(name_of(id));
    }
  }
  if (snapshot_) {
    for (std::uint16_t gateway : snapshot_->gateways)
      if (!peers_.contains(PeerId::gateway(gateway)) && waited < named_gateways_ticks)
        names.push_back(name_of(PeerId::gateway(gateway)));
  } else if (!a_store_answered && waited < any_gateway_ticks) {
    names.push_back("any gateway");
  }
  // Nothing is decided before the first step, even where there is nobody to ask.
  if (names.empty() && round_ == 0) names.push_back("the first step");
  return names;
}

void Recovery::note_state(const HandoffGroup::Body& body, const Version& version, bool own) {
  Known& known = known_[body.body.id];
  known.newest = std::max(known.newest, version);
  if (!known.state || known.state_of < version) {
    known.state = body;
    known.state_of = version;
  }
  if (own && (!known.own || *known.own < version)) known.own = version;
}

void Recovery::note_group(const HandoffGroup& group, Incarnation incarnation,
                          std::uint32_t epochs_on) {
  for (const HandoffGroup::Body& body : group.bodies)
    note_state(body, {epochs_later(body.epoch, epochs_on), incarnation, setup_.self}, true);
  for (const Avatar& avatar : group.avatars) note_avatar(avatar);
}

void Recovery::note_avatar(const Avatar& avatar) {
  const auto [it, fresh] = avatars_.try_emplace(avatar.player, avatar);
  if (fresh) return;
  if (std::pair(it->second.session, it->second.applied_sequence) <
      std::pair(avatar.session, avatar.applied_sequence))
    it->second = avatar;
}

std::vector<KnownState> Recovery::candidates() const {
  std::vector<KnownState> all;
  for (const auto& [id, known] : known_)
    if (known.own && known.state) all.push_back({known.state->body, *known.own});
  return all;
}

bool Recovery::has_best_candidate(BodyId id, const Known& known) const {
  if (!known.own) return false;
  return std::none_of(peers_.begin(), peers_.end(), [&](const auto& entry) {
    const Peer& peer = entry.second;
    if (!peer.recovering) return false;
    const auto candidate = peer.candidates.find(id);
    return candidate != peer.candidates.end() && *known.own < candidate->second;
  });
}

bool Recovery::is_ours(BodyId id, const Known& known) const {
  if (known.removed && *known.removed >= known.newest) return false;
  const RegionId holder = known.newest.region;
  if (holder == setup_.self) return true;
  const Peer& peer = peers_.at(PeerId::region(holder));
  if (peer.recovering) return false;
  // A holder that lives has it, or knows itself where it went.
  if (known.newest.incarnation >= peer.incarnation) return false;
  // The holder has died and recovered without claiming it: it knew less than we do.
  return has_best_candidate(id, known);
}

Recovery::Outcome Recovery::decide(Tick now) const {
  Outcome outcome;
  outcome.heard = heard_;
  outcome.nobody_knew = !snapshot_ && heard_.value < 0;
  for (const auto& [id, known] : known_) {
    outcome.known.insert(id);
    if (!is_ours(id, known)) continue;
    if (!known.state) {
      ++outcome.without_state;
      continue;
    }
    HandoffGroup::Body body = *known.state;
    body.epoch = epochs_later(known.newest.epoch, claimed_epochs_ahead);
    outcome.bodies.push_back(body);
  }
  outcome.avatars = avatars_of(outcome, now);
  return outcome;
}

std::vector<Avatar> Recovery::avatars_of(const Outcome& outcome, Tick now) const {
  std::vector<Avatar> all;
  for (const HandoffGroup::Body& body : outcome.bodies) {
    const BodyId id = body.body.id;
    if (id.kind() != BodyId::Kind::avatar) continue;
    Avatar avatar;
    if (const auto held = avatars_.find(id.player()); held != avatars_.end()) {
      avatar = held->second;
    } else {
      // Whoever it belongs to is here again with the next command; else it goes as the lost do.
      avatar.player = id.player();
      avatar.connected = false;
      avatar.lost_since = now;
    }
    if (!avatar.connected && avatar.lost_since > now) avatar.lost_since = now;
    if (const auto seen = players_.find(id.player()); seen != players_.end())
      bring_up_to(avatar, seen->second);
    raise_thrown(avatar, outcome.known);
    all.push_back(std::move(avatar));
  }
  return all;
}

}  // namespace aureole
