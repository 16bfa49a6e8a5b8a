// Encodes a region's bodies for the gateways.
#include "server/region/replica_publisher.h"

#include <algorithm>
#include <limits>

#include "protocol/wire_values.h"
#include "server/base/check.h"
#include "server/base/merge_in.h"

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

SharedBytes frame_of(flatbuffers::FlatBufferBuilder& builder, Tick now, bool complete,
                     std::span<const wire::ReplicaKey> keys,
                     std::span<const wire::ReplicaMotion> motions,
                     std::span<const wire::ReplicaRemoved> removed,
                     std::span<const wire::PlayerStatus> players) {
  builder.Clear();
  const auto keys_at = builder.CreateVectorOfStructs(keys.data(), keys.size());
  const auto motions_at = builder.CreateVectorOfStructs(motions.data(), motions.size());
  const auto removed_at = builder.CreateVectorOfStructs(removed.data(), removed.size());
  const auto players_at = builder.CreateVectorOfStructs(players.data(), players.size());
  return std::make_shared<const Bytes>(
      finish_frame(builder,
                   wire::CreateReplicaUpdate(builder, now.value, complete, keys_at, motions_at,
                                             removed_at, players_at),
                   FrameType::replica_update));
}

}  // namespace

std::uint32_t ReplicaPublisher::take_slot() {
  AUREOLE_CHECK(next_slot_ < slot_codes, "no world has so many bodies");
  if (free_slots_.empty()) return next_slot_++;
  const std::uint32_t slot = free_slots_.back();
  free_slots_.pop_back();
  return slot;
}

void ReplicaPublisher::body_gained(BodyId id, Version version) {
  auto [it, fresh] = bodies_.try_emplace(id);
  AUREOLE_CHECK(fresh, "a body is published once");
  it->second = {take_slot(), version};
  due_.push_back(id);
}

void ReplicaPublisher::body_lost(BodyId id) {
  const auto it = bodies_.find(id);
  AUREOLE_CHECK(it != bodies_.end(), "only published bodies are lost");
  free_slots_.push_back(it->second.slot);
  bodies_.erase(it);
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
  std::vector<Followed> woken{};  ///< To be followed from now on; ascending.
  std::vector<BodyId> still_due{};
  std::vector<wire::ReplicaKey>& keys;
  std::vector<wire::ReplicaMotion>& motions;
};

/// False: there is no room left. More would not fit a frame together with everybody's motion; the
/// rest comes a tick later.
bool ReplicaPublisher::send_key(Round& round, const NewBody& body, const Published& as) {
  if (round.keys.size() >= keys_per_update) return false;
  round.keys.push_back(make_key(body, as.version, as.slot));
  return true;
}

bool ReplicaPublisher::send_key(Round& round, BodyId id) const {
  return round.keys.size() < keys_per_update &&
         send_key(round, NewBody{id, round.world.prototype(id), round.world.state(id)},
                  bodies_.at(id));
}

/// The next of those followed stays among them. In its place: in nearly every step all of them do,
/// and a second list would be as much memory again to wait for.
ReplicaPublisher::Followed& ReplicaPublisher::keep_next(Round& round) {
  const std::size_t from = round.next_followed++;
  const std::size_t to = round.kept++;
  if (from != to) followed_[to] = followed_[from];
  return followed_[to];
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
      if (send_key(round, followed->id))
        ++next_followed;
      else
        keep_next(round);
    } else if (due) {
      const BodyId id = due_[next_due++];
      // It may have gone before anybody was told that it came.
      if (bodies_.contains(id) && !send_key(round, id)) round.still_due.push_back(id);
    } else {
      return;
    }
  }
}

/// A body that is awake, and known to be.
void ReplicaPublisher::follow(Round& round, const NewBody& body, Followed& followed) {
  const auto position = quantise(body.state.position);
  const auto orientation = quantise(body.state.orientation);
  if ((round.now.value + followed.as.slot) % key_interval_ticks == 0) {
    if (!send_key(round, body, followed.as)) return;
  } else if (position != followed.position || orientation != followed.orientation) {
    const std::array<std::uint8_t, 3> slot = wire_slot(followed.as.slot);
    flatbuffers::span<const std::uint8_t, 3> s(slot.data(), 3);
    flatbuffers::span<const std::uint8_t, 9> p(position.data(), 9);
    flatbuffers::span<const std::uint8_t, 6> q(orientation.data(), 6);
    round.motions.emplace_back(s, p, q);
  }
  followed.position = position;
  followed.orientation = orientation;
}

SharedBytes ReplicaPublisher::update(Tick now, const PhysicsWorld& world,
                                     std::span<const Avatar* const> avatars) {
  keys_.clear();
  motions_.clear();
  Round round{.now = now, .world = world, .keys = keys_, .motions = motions_};
  std::size_t& next_followed = round.next_followed;
  std::size_t& next_due = round.next_due;
  std::sort(due_.begin(), due_.end());
  due_.erase(std::unique(due_.begin(), due_.end()), due_.end());
  for (const NewBody& body : world.awake()) {
    const auto is_followed = [&] {
      return next_followed < followed_.size() && followed_[next_followed].id == body.id &&
             !followed_[next_followed].lost;
    };
    // Seldom is anybody between one who is awake and the next.
    if (!is_followed() || next_due < due_.size()) look_at_sleepers(round, body.id);
    if (is_followed()) {
      follow(round, body, keep_next(round));
      continue;
    }
    const bool due = next_due < due_.size() && due_[next_due] == body.id;
    if (due) ++next_due;
    // It is new, or it has woken up: then it is in neither list.
    const Published& as = bodies_.at(body.id);
    if (send_key(round, body, as))
      round.woken.push_back({body.id, as, false, quantise(body.state.position),
                             quantise(body.state.orientation)});
    else if (due)
      round.still_due.push_back(body.id);
  }
  look_at_sleepers(round, BodyId{std::numeric_limits<std::uint64_t>::max()});
  followed_.erase(followed_.begin() + static_cast<std::ptrdiff_t>(round.kept), followed_.end());
  followed_.insert(followed_.end(), round.woken.begin(), round.woken.end());
  merge_in(followed_, static_cast<std::ptrdiff_t>(round.kept),
           [](const Followed& a, const Followed& b) { return a.id < b.id; });
  std::swap(due_, round.still_due);

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
  return frame_of(builder_, now, true, keys_, motions_, removed, players);
}

std::vector<SharedBytes> ReplicaPublisher::whole_state(Tick now, const PhysicsWorld& world,
                                                       std::span<const VersionedBody> passive,
                                                       std::span<const Avatar* const> avatars) {
  std::vector<wire::ReplicaKey> keys;
  for (BodyId id : world.ids()) {
    const Published& published = bodies_.at(id);
    keys.push_back(
        make_key({id, world.prototype(id), world.state(id)}, published.version, published.slot));
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
    frames.push_back(frame_of(builder, now, last, std::span(keys).subspan(at, count), {}, {},
                              last ? std::span<const wire::PlayerStatus>(players)
                                   : std::span<const wire::PlayerStatus>()));
    at += count;
  } while (at < keys.size());
  return frames;
}

}  // namespace aureole
