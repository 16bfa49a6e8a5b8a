// Taking in the streams of all regions, where the higher version of a body always wins.
#include "server/replica/replica_store.h"

#include <algorithm>

#include "protocol/wire_values.h"
#include "server/base/check.h"
#include "server/replica/replica_wire.h"

namespace aureole {
namespace {

/// How long a body may be unheard of (while it changes its server, or while a server skips ticks)
/// and still be drawn as moving evenly from its last pose to the next. Longer than any handoff
/// takes.
constexpr std::int64_t glide_ticks_max = 16;

/// The same way that motions take, so that key and motion give the same pose bit for bit.
GridPose grid_pose(const BodyState& state) {
  return GridPose::from(quantise(state.position), quantise(state.orientation));
}

GridPose grid_pose(const wire::ReplicaMotion& motion) {
  QuantisedPosition position{};
  QuantisedOrientation orientation{};
  std::copy_n(motion.position()->Data(), position.size(), position.begin());
  std::copy_n(motion.orientation()->Data(), orientation.size(), orientation.begin());
  return GridPose::from(position, orientation);
}

}  // namespace

Status ReplicaStore::apply(RegionId from, std::span<const std::byte> payload) {
  Status status = take(from, payload);
  tidy();
  return status;
}

Status ReplicaStore::take(RegionId from, std::span<const std::byte> payload) {
  const auto* update = verified<wire::ReplicaUpdate>(payload);
  if (update == nullptr)
    return Error::format("{} bytes from region {} are not a ReplicaUpdate", payload.size(),
                         from.value);
  const auto known = regions_.find(from);
  if (known == regions_.end() || !known->second.up)
    return Error::format("replica update of region {}, which is not up", from.value);
  Region& region = known->second;

  if (auto ok = check_tick(update->tick()); !ok) return ok;
  const Tick tick{update->tick()};
  if (region.newest && tick < *region.newest)
    return Error::format("region {} went back from tick {} to {}", from.value, region.newest->value,
                         tick.value);
  if (region.newest != tick) region.previous = std::exchange(region.newest, tick);
  region.heard = tick;

  if (const auto* keys = update->keys())
    for (const wire::ReplicaKey* key : *keys)
      if (auto ok = take_key(*key, from, region); !ok) return ok;
  if (const auto* motions = update->motions())
    for (const wire::ReplicaMotion* motion : *motions)
      if (auto ok = take_motion(*motion, region); !ok) return ok;
  if (const auto* all_removed = update->removed())
    for (const wire::ReplicaRemoved* removed : *all_removed) {
      if (auto ok = check_removed(*removed, from); !ok) return ok;
      take_removed(BodyId{removed->id()}, version_of(removed->version()));
    }
  if (const auto* players = update->players())
    for (const wire::PlayerStatus* player : *players) {
      if (auto ok = check_player(*player); !ok) return ok;
      take_player(*player, from);
    }
  if (update->complete() && !region.complete) {
    region.complete = true;
    drop_untold(from, region);
  }
  return Ok{};
}

/// What was removed while the link was down is told by nobody: it shows in what its owner leaves
/// out.
void ReplicaStore::drop_untold(RegionId from, const Region& region) {
  for (const Place& place : order_) {
    const Body& body = bodies_[place.body];
    if (body.id == place.id && body.key.version.region == from && body.link != region.link)
      drop(place.id, place.body);
  }
}

void ReplicaStore::drop(BodyId id, std::uint32_t place) {
  Body& body = bodies_[place];
  count(body, -1);
  body = Body{};
  freed_.push_back(place);
  index_.erase(id);
  if (id.kind() == BodyId::Kind::avatar) players_.erase(id.player());
}

Status ReplicaStore::take_key(const wire::ReplicaKey& key, RegionId from, Region& region) {
  if (auto ok = check_key(key, from, prototype_count_); !ok) return ok;
  const BodyId id{key.id()};
  const Version version = version_of(key.version());
  const Tick tick = *region.newest;

  const auto found = index_.find(id);
  const bool is_new = found == index_.end();
  if (is_new ? tombstones_.covers(id, version) : version < bodies_[found->second].key.version) {
    // Somebody knows better. The slot is known all the same: its motions are no fault of the
    // sender.
    region.slots.bind(key.slot(), 0, 0);
    return Ok{};
  }
  if (is_new && index_.size() >= replica_bodies_max)
    return Error::format("region {} told of body {:#x} when there were {} already", from.value,
                         id.value, replica_bodies_max);

  const std::uint32_t place = is_new ? add_body(id) : found->second;
  Body& body = bodies_[place];
  const bool same_owner = !is_new && body.key.version == version;
  if (!same_owner) set_owner(body, version);
  region.slots.bind(key.slot(), place, body.stamp);
  body.link = region.link;
  // The state that an owner told on an earlier link may be newer than what a new link begins with.
  if (same_owner && tick < body.history.newest_tick()) return Ok{};

  const BodyState state = state_of(key);
  move(body, region, grid_pose(state), same_owner);
  body.key = {version, tick, PrototypeId{key.prototype()}, state};
  set_asleep(body, state.activation == Activation::asleep);
  return Ok{};
}

Status ReplicaStore::take_motion(const wire::ReplicaMotion& motion, Region& region) {
  const std::uint32_t slot = slot_of(motion);
  const SlotTable::Binding* binding = region.slots.find(slot);
  if (binding == nullptr)
    return Error::format("motion of slot {}, to which no body was bound", slot);
  if (binding->stamp == 0) return Ok{};
  Body& body = bodies_[binding->body];
  if (body.stamp != binding->stamp || *region.newest < body.history.newest_tick()) return Ok{};
  move(body, region, grid_pose(motion), true);
  set_asleep(body, false);
  return Ok{};
}

void ReplicaStore::move(Body& body, const Region& region, const GridPose& pose, bool same_owner) {
  const Tick tick = *region.newest;
  if (!body.history.empty() && tick - body.history.newest_tick() > 1) {
    // A body that is not told of lies still, so it starts from its old pose one tick ago. It was on
    // its way all the time only if nothing was told of anybody since (skipped ticks), or if it was
    // changing its server.
    const Tick last = body.history.newest_tick();
    const bool on_its_way = same_owner ? region.previous == last : !body.asleep;
    if (!on_its_way || tick - last > glide_ticks_max) body.history.hold_until(tick - 1);
  }
  body.history.push(tick, pose);
}

void ReplicaStore::take_removed(BodyId id, const Version& version) {
  const auto found = index_.find(id);
  if (found != index_.end()) {
    if (version < bodies_[found->second].key.version) return;
    drop(id, found->second);
  }
  tombstones_.remember(id, version);
}

void ReplicaStore::take_player(const wire::PlayerStatus& status, RegionId from) {
  const PlayerId id{status.player()};
  const Body* avatar = find(BodyId::avatar(id));
  if (avatar == nullptr || avatar->key.version.region != from) return;
  const auto held = players_.find(id);
  if (held != players_.end() && status.session() < held->second.session) return;
  players_[id] = {id,
                  from,
                  status.session(),
                  status.applied_sequence(),
                  status.connected(),
                  BodyId{status.carried()}};
}

void ReplicaStore::region_up(RegionId from) {
  region_down(from);
  regions_[from].up = true;
}

void ReplicaStore::region_down(RegionId from) {
  Region& region = regions_[from];
  const OwnerCounts counts = region.counts;
  const std::optional<Tick> heard = region.heard;
  region = Region{};
  region.counts = counts;
  region.heard = heard;
  region.link = ++last_link_;
}

std::uint32_t ReplicaStore::add_body(BodyId id) {
  std::uint32_t place = static_cast<std::uint32_t>(bodies_.size());
  if (free_.empty()) {
    bodies_.emplace_back();
  } else {
    place = free_.back();
    free_.pop_back();
  }
  bodies_[place].id = id;
  index_.emplace(id, place);
  order_.push_back({id, place});
  ++added_;
  return place;
}

void ReplicaStore::set_owner(Body& body, const Version& version) {
  if (body.stamp != 0) count(body, -1);
  body.key.version = version;
  body.stamp = ++last_stamp_;
  count(body, 1);
}

void ReplicaStore::set_asleep(Body& body, bool asleep) {
  if (body.asleep == asleep) return;
  count(body, -1);
  body.asleep = asleep;
  count(body, 1);
}

void ReplicaStore::count(const Body& body, std::ptrdiff_t change) {
  OwnerCounts& counts = regions_[body.key.version.region].counts;
  counts.bodies += static_cast<std::size_t>(change);
  if (!body.asleep) counts.awake += static_cast<std::size_t>(change);
}

void ReplicaStore::tidy() {
  const auto by_id = [](const Place& a, const Place& b) { return a.id < b.id; };
  if (added_ > 0) {
    const auto middle = order_.end() - static_cast<std::ptrdiff_t>(added_);
    std::sort(middle, order_.end(), by_id);
    std::inplace_merge(order_.begin(), middle, order_.end(), by_id);
    added_ = 0;
  }
  if (!freed_.empty()) {
    // A freed place has no name; it is given away again only after this.
    std::erase_if(order_, [this](const Place& p) { return !bodies_[p.body].id.valid(); });
    free_.insert(free_.end(), freed_.begin(), freed_.end());
    freed_.clear();
  }
}

}  // namespace aureole
