// Writes ReplicaUpdates the way a region does, in as few words as a test can read.
#pragma once

#include <vector>

#include "protocol/quantise.h"
#include "protocol/wire_values.h"
#include "server/base/ids.h"
#include "server/base/tick.h"
#include "server/base/world_position.h"

namespace aureole::test {

inline const BodyId ball = BodyId::world(7);
inline const BodyId box = BodyId::world(3);
inline constexpr RegionId r0{0};
inline constexpr RegionId r1{1};
inline constexpr RegionId r2{2};

constexpr Version version_of(RegionId region, std::uint32_t epoch, std::uint64_t incarnation = 1) {
  return {epoch, Incarnation{incarnation}, region};
}

/// Everything about a key that a test may want to spoil; valid as it stands.
struct Key {
  BodyId id = ball;
  Version version = version_of(r0, 1);
  std::uint32_t slot = 0;
  WorldPosition position{};
  std::uint16_t prototype = 0;
  std::uint8_t activation = 0;
  Eigen::Quaternionf orientation{Eigen::Quaternionf::Identity()};
  Eigen::Vector3f linear_velocity{0, 0, 0};
  Eigen::Vector3f angular_velocity{0, 0, 0};
  float deactivation_time_s = 0;
};

inline wire::ReplicaVersion wire_of(const Version& v) {
  return {v.epoch, v.region.value, v.incarnation.value};
}
inline wire::Vec3 wire_of(const Eigen::Vector3f& v) {
  return {v.x(), v.y(), v.z()};
}

class Update {
 public:
  explicit Update(std::int64_t tick) : tick_(tick) {}

  Update& key(const Key& k) {
    const Eigen::Quaternionf& q = k.orientation;
    keys_.emplace_back(k.id.value, wire_of(k.version), k.slot, k.prototype, k.activation,
                       wire::Vec3d(k.position.x, k.position.y, k.position.z),
                       wire::Quat(q.x(), q.y(), q.z(), q.w()), wire_of(k.linear_velocity),
                       wire_of(k.angular_velocity), k.deactivation_time_s);
    return *this;
  }
  Update& motion(std::uint32_t slot, const WorldPosition& at,
                 const Eigen::Quaternionf& turned = Eigen::Quaternionf::Identity()) {
    motions_.push_back(motion_of(slot, QuantisedPose(at, orientation_bits(turned))));
    return *this;
  }
  Update& removed(BodyId id, const Version& version) {
    removed_.emplace_back(id.value, wire_of(version));
    return *this;
  }
  Update& player(std::uint32_t player, std::uint32_t session, std::uint32_t applied,
                 BodyId carried = {}, bool connected = true) {
    players_.emplace_back(player, session, applied, connected, carried.value);
    return *this;
  }
  Update& complete() {
    complete_ = true;
    return *this;
  }

  /// The payload of the frame, as the gateway gets it.
  Bytes bytes() const {
    flatbuffers::FlatBufferBuilder builder;
    const auto keys = builder.CreateVectorOfStructs(keys_);
    const auto motions = builder.CreateVectorOfStructs(motions_);
    const auto removed = builder.CreateVectorOfStructs(removed_);
    const auto players = builder.CreateVectorOfStructs(players_);
    const Bytes frame = finish_frame(
        builder,
        wire::CreateReplicaUpdate(builder, tick_, complete_, keys, motions, removed, players),
        FrameType::replica_update);
    return {frame.begin() + sizeof(FrameHeader), frame.end()};
  }

 private:
  std::int64_t tick_;
  bool complete_ = false;
  std::vector<wire::ReplicaKey> keys_;
  std::vector<wire::ReplicaMotion> motions_;
  std::vector<wire::ReplicaRemoved> removed_;
  std::vector<wire::PlayerStatus> players_;
};

/// World time of a tick (µs).
constexpr std::int64_t at_tick(double tick) {
  return static_cast<std::int64_t>(tick * tick_us);
}

}  // namespace aureole::test
