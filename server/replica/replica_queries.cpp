// What the replica store answers.
#include <numeric>

#include "server/replica/replica_store.h"

namespace aureole {

void ReplicaStore::sample(std::int64_t world_us, std::vector<ReplicaPose>& out) const {
  out.resize(order_.size());
  for (std::size_t i = 0; i < order_.size(); ++i)
    out[i] = pose_of(bodies_[order_[i].body], world_us);
}

std::optional<ReplicaPose> ReplicaStore::sample_body(BodyId id, std::int64_t world_us) const {
  const Body* body = find(id);
  if (body == nullptr) return std::nullopt;
  return pose_of(*body, world_us);
}

ReplicaPose ReplicaStore::pose_of(const Body& body, std::int64_t world_us) const {
  ReplicaPose pose;
  pose.id = body.id;
  pose.prototype = body.key.prototype;
  pose.owner = body.key.version.region;
  pose.asleep = body.asleep && world_us >= body.history.newest_tick().value * tick_us;
  body.history.at(world_us, pose.position, pose.orientation);
  return pose;
}

bool ReplicaStore::is_complete(RegionId from) const {
  const auto region = regions_.find(from);
  return region != regions_.end() && region->second.complete;
}

std::optional<Tick> ReplicaStore::newest_tick(RegionId from) const {
  const auto region = regions_.find(from);
  return region == regions_.end() ? std::nullopt : region->second.newest;
}

const ReplicaStore::Body* ReplicaStore::find(BodyId id) const {
  const auto found = index_.find(id);
  return found == index_.end() ? nullptr : &bodies_[found->second];
}

std::optional<ReplicaStore::KeyState> ReplicaStore::key_state(BodyId id) const {
  const Body* body = find(id);
  return body == nullptr ? std::nullopt : std::optional(body->key);
}

std::optional<Version> ReplicaStore::version(BodyId id) const {
  const Body* body = find(id);
  return body == nullptr ? std::nullopt : std::optional(body->key.version);
}

std::size_t ReplicaStore::size() const {
  return index_.size();
}

std::size_t ReplicaStore::awake_count() const {
  return std::accumulate(
      regions_.begin(), regions_.end(), std::size_t{0},
      [](std::size_t sum, const auto& region) { return sum + region.second.counts.awake; });
}

OwnerCounts ReplicaStore::owner_counts(RegionId owner) const {
  const auto region = regions_.find(owner);
  return region == regions_.end() ? OwnerCounts{} : region->second.counts;
}

std::optional<ReplicaPlayer> ReplicaStore::player(PlayerId id) const {
  const auto player = players_.find(id);
  return player == players_.end() ? std::nullopt : std::optional(player->second);
}

}  // namespace aureole
