// Encodes a region's bodies for the gateways.
#include "server/region/replica_publisher.h"

#include <algorithm>
#include <limits>

#include "protocol/wire_values.h"
#include "server/base/check.h"
#include "server/base/merge_in.h"
#include "server/base/prefetch.h"

namespace aureole {
namespace {

using aureole::to_wire;

wire::ReplicaVersion to_wire(const Version& v) {
  return {v.epoch, v.region.value, v.incarnation.value};
}

wire::ReplicaKey make_key(const NewBody& b, const Version& version, std::uint32_t slot) {
  const BodyState& s = b.state;
  return {b.id.value,
          to_wire(version),
          slot,
          b.prototype.value,
          static_cast<std::uint8_t>(s.activation),
          to_wire(s.position),
          to_wire(s.orientation),
          to_wire(s.linear_velocity),
          to_wire(s.angular_velocity),
          s.deactivation_time_s};
}

wire::PlayerStatus to_wire(const Avatar& a) {
  return {a.player.value, a.session, a.applied_sequence, a.connected, a.carried.value};
}

flatbuffers::Offset<wire::ReplicaUpdate> write(flatbuffers::FlatBufferBuilder& builder, Tick now,
                                               bool complete,
                                               std::span<const wire::ReplicaKey> keys,
                                               std::span<const wire::ReplicaMotion> motions,
                                               std::span<const wire::ReplicaRemoved> removed,
                                               std::span<const wire::PlayerStatus> players) {
  builder.Clear();
  const auto keys_at = builder.CreateVectorOfStructs(keys.data(), keys.size());
  const auto motions_at = builder.CreateVectorOfStructs(motions.data(), motions.size());
  const auto removed_at = builder.CreateVectorOfStructs(removed.data(), removed.size());
  const auto players_at = builder.CreateVectorOfStructs(players.data(), players.size());
  return wire::CreateReplicaUpdate(builder, now.value, complete, keys_at, motions_at, removed_at,
                                   players_at);
}

/// No body has a name that comes behind this one.
constexpr BodyId behind_all{std::numeric_limits<std::uint64_t>::max()};

}  // namespace

std::uint32_t ReplicaPublisher::take_slot() {
  AUREOLE_CHECK(next_slot_ < slot_codes, "no world has so many bodies");
  if (free_slots_.empty()) {
    versions_.emplace_back();
    return next_slot_++;
  }
  const std::uint32_t slot = free_slots_.back();
  free_slots_.pop_back();
  return slot;
}

void ReplicaPublisher::body_gained(BodyId id, Version version) {
  const std::uint32_t slot = take_slot();
  const bool fresh = slots_.emplace(id, slot).second;
  AUREOLE_CHECK(fresh, "a body is published once");
  versions_[slot] = version;
  due_.push_back(id);
}

void ReplicaPublisher::body_lost(BodyId id) {
  const auto it = slots_.find(id);
  AUREOLE_CHECK(it != slots_.end(), "only published bodies are lost");
  free_slots_.push_back(it->second);
  slots_.erase(it);
  const auto followed = std::lower_bound(followed_.begin(), followed_.end(), id,
                                         [](const Followed& f, BodyId key) { return f.id < key; });
  if (followed != followed_.end() && followed->id == id) followed->lost = true;
}

void ReplicaPublisher::body_removed(BodyId id, Version version) {
  body_lost(id);
  removed_.push_back({id, version});
}

struct ReplicaPublisher::Round {
  Tick now;
  const PhysicsWorld& world;
  std::size_t next_followed = 0, next_due = 0;  ///< Places in the lists that are walked.
  std::size_t kept = 0;           ///< So many of those followed before have been looked at and stay.
  std::vector<Followed>& woken;
  std::vector<BodyId>& still_due;
  std::vector<wire::ReplicaKey>& keys;
  std::size_t motions = 0;  ///< How many have been told of.
};

/// False: there is no room left. More would not fit a frame together with everybody's motion; the
/// rest comes a tick later.
bool ReplicaPublisher::send_key(Round& round, const NewBody& body, std::uint32_t slot) const {
  if (round.keys.size() >= keys_per_update) return false;
  round.keys.push_back(make_key(body, versions_[slot], slot));
  return true;
}

bool ReplicaPublisher::send_key(Round& round, BodyId id, std::uint32_t slot) const {
  if (round.keys.size() >= keys_per_update) return false;
  const BodyGlance seen = round.world.glance(id);
  return send_key(round, NewBody{id, seen.prototype(), seen.state()}, slot);
}

/// The next of those followed stays among them. In its place: in nearly every step all of them do,
/// and a second list would be as much memory again to wait for.
void ReplicaPublisher::keep_next(Round& round) {
  followed_[round.kept++] = followed_[round.next_followed++];
}

/// Tells of those below `before` that have fallen asleep or came asleep.
void ReplicaPublisher::look_at_sleepers(Round& round, BodyId before) {
  std::size_t& next_followed = round.next_followed;
  std::size_t& next_due = round.next_due;
  while (true) {
    while (next_followed < followed_.size() && followed_[next_followed].lost) ++next_followed;
    const Followed* followed =
        next_followed < followed_.size() && followed_[next_followed].id < before
            ? &followed_[next_followed]
            : nullptr;
    const bool due = next_due < due_.size() && due_[next_due] < before;
    if (followed != nullptr && (!due || followed->id < due_[next_due])) {
      if (send_key(round, followed->id, followed->slot))
        ++next_followed;
      else
        keep_next(round);
    } else if (due) {
      const BodyId id = due_[next_due++];
      // It may have gone before anybody was told that it came.
      const auto known = slots_.find(id);
      if (known != slots_.end() && !send_key(round, id, known->second))
        round.still_due.push_back(id);
    } else {
      return;
    }
  }
}

/// Four at a time. What they are compared with, and where motions go, comes near meanwhile.
void ReplicaPublisher::quantise_awake(std::span<const NewBody> awake) {
  poses_.resize(awake.size());
  motions_.resize(std::max(motions_.size(), awake.size() + 1));
  constexpr std::size_t at_once = 4;
  for (std::size_t n = 0; n < awake.size(); n += at_once) {
    if (n < followed_.size()) prefetch(&followed_[n], at_once * sizeof(Followed));
    prefetch(&motions_[n], at_once * sizeof(wire::ReplicaMotion));
    std::array<const Eigen::Quaternionf*, at_once> orientations;
    for (std::size_t k = 0; k < at_once; ++k)
      orientations[k] = &awake[std::min(n + k, awake.size() - 1)].state.orientation;
    const std::array<std::uint64_t, at_once> bits = orientation_bits(orientations);
    for (std::size_t k = 0; k < at_once && n + k < awake.size(); ++k)
      poses_[n + k] = QuantisedPose(awake[n + k].state.position, bits[k]);
  }
}

/// Those of `awake` from `first` on that are followed, one after the other, up to the first that
/// is not, or that somebody who sleeps may come before: the place of that one. Nearly all are.
std::size_t ReplicaPublisher::follow_from(Round& round, std::span<const NewBody> awake,
                                          std::size_t first) {
  const BodyId due = round.next_due < due_.size() ? due_[round.next_due] : behind_all;
  const std::size_t most = std::min(awake.size() - first, followed_.size() - round.next_followed);
  const QuantisedPose* const poses = &poses_[first];
  const Followed* const from = followed_.data() + round.next_followed;
  Followed* const to = followed_.data() + round.kept;
  wire::ReplicaMotion* motion = motions_.data() + round.motions;
  const auto key_is_due = [&](const Followed& of) {
    return (round.now.value + of.slot) % key_interval_ticks == 0;
  };
  constexpr std::size_t ahead = 32;
  std::size_t n = 0;
  for (; n < most; ++n) {
    if (n + ahead < most && key_is_due(from[n + ahead])) prefetch(&versions_[from[n + ahead].slot]);
    const BodyId id = awake[first + n].id;
    Followed followed = from[n];
    if (followed.id != id || followed.lost || due < id) break;
    if (key_is_due(followed)) {
      // Without room for it gateways are to hear of this pose later.
      if (send_key(round, awake[first + n], followed.slot)) followed.pose = poses[n];
    } else {
      // Whether it has moved as far as a cell nobody can foretell: written, and kept if it has.
      *motion = motion_of(followed.slot, poses[n]);
      motion += poses[n] != followed.pose ? 1 : 0;
      followed.pose = poses[n];
    }
    to[n] = followed;
  }
  round.motions = static_cast<std::size_t>(motion - motions_.data());
  round.next_followed += n;
  round.kept += n;
  return first + n;
}

/// One that is awake and was not: it is new, or has woken up.
void ReplicaPublisher::greet(Round& round, const NewBody& body, const QuantisedPose& pose) {
  const bool due = round.next_due < due_.size() && due_[round.next_due] == body.id;
  if (due) ++round.next_due;
  const std::uint32_t slot = slots_.at(body.id);
  if (send_key(round, body, slot))
    round.woken.push_back({body.id, slot, false, pose});
  else if (due)
    round.still_due.push_back(body.id);
}

SharedBytes ReplicaPublisher::update(Tick now, const PhysicsWorld& world,
                                     std::span<const Avatar* const> avatars) {
  keys_.clear();
  woken_.clear();
  still_due_.clear();
  Round round{
      .now = now, .world = world, .woken = woken_, .still_due = still_due_, .keys = keys_};
  std::sort(due_.begin(), due_.end());
  due_.erase(std::unique(due_.begin(), due_.end()), due_.end());
  const std::span<const NewBody> awake = world.awake();
  quantise_awake(awake);
  for (std::size_t n = 0; n < awake.size();) {
    n = follow_from(round, awake, n);
    if (n == awake.size()) break;
    look_at_sleepers(round, awake[n].id);
    const bool is_followed = round.next_followed < followed_.size() &&
                             followed_[round.next_followed].id == awake[n].id;
    if (!is_followed) {
      greet(round, awake[n], poses_[n]);
      ++n;
    }
  }
  look_at_sleepers(round, behind_all);
  followed_.erase(followed_.begin() + static_cast<std::ptrdiff_t>(round.kept), followed_.end());
  followed_.insert(followed_.end(), round.woken.begin(), round.woken.end());
  merge_in(followed_, static_cast<std::ptrdiff_t>(round.kept),
           [](const Followed& a, const Followed& b) { return a.id < b.id; });
  due_.swap(still_due_);

  std::vector<wire::ReplicaRemoved> removed;
  for (const auto& r : removed_) removed.push_back({r.id.value, to_wire(r.version)});
  removed_.clear();

  std::vector<wire::PlayerStatus> players;
  std::unordered_map<PlayerId, PlayerSent> now_known;
  for (const Avatar* a : avatars) {
    const PlayerSent sent{a->session, a->applied_sequence, a->connected, a->carried};
    const auto before = players_.find(a->player);
    if (before == players_.end() || !(before->second == sent)) players.push_back(to_wire(*a));
    now_known.emplace(a->player, sent);
  }
  players_ = std::move(now_known);
  const auto root = write(builder_, now, true, keys_, std::span(motions_).first(round.motions),
                          removed, players);
  return frames_.finish(builder_, root, FrameType::replica_update);
}

std::vector<SharedBytes> ReplicaPublisher::whole_state(Tick now, const PhysicsWorld& world,
                                                       std::span<const VersionedBody> passive,
                                                       std::span<const Avatar* const> avatars) {
  std::vector<wire::ReplicaKey> keys;
  for (BodyId id : world.ids()) {
    const std::uint32_t slot = slots_.at(id);
    const BodyGlance seen = world.glance(id);
    keys.push_back(make_key({id, seen.prototype(), seen.state()}, versions_[slot], slot));
  }
  // Copies in flight get slots that no motion will ever name.
  std::uint32_t spare = next_slot_;
  for (const auto& body : passive) keys.push_back(make_key(body.body, body.version, spare++));

  std::vector<wire::PlayerStatus> players;
  for (const Avatar* a : avatars) players.push_back(to_wire(*a));

  std::vector<SharedBytes> frames;
  flatbuffers::FlatBufferBuilder builder;  // Its memory is much, and seldom wanted.
  std::size_t at = 0;
  do {
    const std::size_t count = std::min(keys_per_frame, keys.size() - at);
    const bool last = at + count == keys.size();
    const auto root = write(builder, now, last, std::span(keys).subspan(at, count), {}, {},
                            last ? std::span<const wire::PlayerStatus>(players)
                                 : std::span<const wire::PlayerStatus>());
    frames.push_back(std::make_shared<const Bytes>(
        finish_frame(builder, root, FrameType::replica_update)));
    at += count;
  } while (at < keys.size());
  return frames;
}

}  // namespace aureole
