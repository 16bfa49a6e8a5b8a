// Bytes of messages, and how many things that move they are shared by.
#include "server/measure/wire_census.h"

#include <nlohmann/json.hpp>

#include "protocol/wire.h"
#include "protocol/wire_values.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr int gateway = 2;

wire::Aura aura(std::uint64_t id, std::uint8_t flags) {
  const std::array<std::uint8_t, 9> position{};
  const std::array<std::int8_t, 3> half_spine{};
  return {id,
          10.0f,
          static_cast<std::uint16_t>(id),
          0,
          0,
          0,
          flatbuffers::span<const std::uint8_t, 9>(position.data(), 9),
          flatbuffers::span<const std::int8_t, 3>(half_spine.data(), 3),
          flags,
          0};
}

wire::AuraMotion moved(std::uint64_t id, std::uint8_t flags) {
  const std::array<std::uint8_t, 9> position{};
  const std::array<std::int8_t, 3> half_spine{};
  return {static_cast<std::uint16_t>(id),
          0,
          0,
          0,
          flatbuffers::span<const std::uint8_t, 9>(position.data(), 9),
          flatbuffers::span<const std::int8_t, 3>(half_spine.data(), 3),
          flags,
          0};
}

Bytes moved_auras(const std::vector<wire::AuraMotion>& list) {
  flatbuffers::FlatBufferBuilder builder;
  const auto at = builder.CreateVectorOfStructs(list);
  return finish_frame(builder, wire::CreateAuras(builder, 1, 0, 0, 0, 0, 0, 0, at),
                      FrameType::auras);
}

Bytes auras(const std::vector<wire::Aura>& list, const std::vector<std::uint64_t>& removed = {},
            const std::vector<wire::Resting>& resting = {}) {
  flatbuffers::FlatBufferBuilder builder;
  const auto auras_at = builder.CreateVectorOfStructs(list);
  const auto resting_at = builder.CreateVectorOfStructs(resting);
  const auto removed_at = builder.CreateVector(removed);
  return finish_frame(builder, wire::CreateAuras(builder, 1, auras_at, resting_at, removed_at),
                      FrameType::auras);
}

wire::ReplicaMotion motion(std::uint32_t slot, std::uint8_t where) {
  return motion_of(slot, QuantisedPose(WorldPosition{where * position_grid_m, 0, 0}, 0));
}

wire::ReplicaKey key(std::uint32_t slot, double x) {
  return {slot + 1u,
          wire::ReplicaVersion{1, 0, 1},
          slot,
          0,
          0,
          to_wire(WorldPosition{x, 0, 0}),
          to_wire(Eigen::Quaternionf::Identity()),
          to_wire(Eigen::Vector3f(0, 0, 0)),
          to_wire(Eigen::Vector3f(0, 0, 0)),
          0};
}

Bytes update(const std::vector<wire::ReplicaKey>& keys,
             const std::vector<wire::ReplicaMotion>& motions) {
  flatbuffers::FlatBufferBuilder builder;
  const auto keys_at = builder.CreateVectorOfStructs(keys);
  const auto motions_at = builder.CreateVectorOfStructs(motions);
  return finish_frame(builder, wire::CreateReplicaUpdate(builder, 1, true, keys_at, motions_at),
                      FrameType::replica_update);
}

std::uint64_t payload(const Bytes& frame) {
  return frame.size() - sizeof(FrameHeader);
}

}  // namespace

TEST_CASE("an aura that moves counts in each tick until it rests, sleeps or is told of no more") {
  WireCensus census(gateway);
  const Bytes first = auras({aura(1, 0), aura(2, 0), aura(3, 1), aura(4, 2)}), nothing = auras({});
  census.note(0, 1, first);
  CHECK(census.counts().moving_auras == 2);
  CHECK(census.counts().aura_bytes == payload(first));
  census.note(0, 1, nothing);
  CHECK(census.counts().moving_auras == 4);
  CHECK(census.counts().aura_bytes == payload(first));
  CHECK(census.counts().sign_of_life_bytes == payload(nothing));
  census.note(1, 0, nothing);  // The other way knows nothing.
  CHECK(census.counts().moving_auras == 4);
  census.note(0, 1, moved_auras({moved(2, 2)}));
  CHECK(census.counts().moving_auras == 5);
  census.note(0, 1, auras({}, {1}));
  CHECK(census.counts().moving_auras == 5);
  // Again, so that it counts once only.
  census.note(0, 1, auras({aura(1, 0)}));
  census.note(0, 1, auras({aura(1, 0)}));
  CHECK(census.counts().moving_auras == 7);
}

TEST_CASE("where resting bodies lie is counted apart from auras") {
  WireCensus census(gateway);
  const std::vector<wire::Resting> resting{
      {4, to_wire(WorldPosition{1, 2, 3}), to_wire(Eigen::Quaternionf::Identity()), 0}};
  const Bytes frame = auras({aura(4, 2)}, {}, resting);
  census.note(0, 1, frame);
  CHECK(census.counts().resting_bytes == sizeof(wire::Resting));
  CHECK(census.counts().aura_bytes == payload(frame) - sizeof(wire::Resting));
}

TEST_CASE("a replica moves when its pose does, told in a motion or in a key; keys are apart") {
  WireCensus census(gateway);
  const Bytes first = update({key(0, 1), key(1, 2)}, {});
  census.note(0, gateway, first);
  CHECK(census.counts().key_bytes == 2 * sizeof(wire::ReplicaKey));
  CHECK(census.counts().replica_bytes == payload(first) - census.counts().key_bytes);
  CHECK(census.counts().moving_replicas == 2);
  census.note(0, gateway, update({key(0, 1)}, {motion(1, 5)}));
  CHECK(census.counts().moving_replicas == 3);  // The first lies where it lay.
  census.note(0, gateway, update({key(0, 1.5)}, {motion(1, 6)}));
  CHECK(census.counts().moving_replicas == 5);
  // Another region's slots are others.
  census.note(1, gateway, update({}, {motion(1, 6)}));
  CHECK(census.counts().moving_replicas == 6);
}

TEST_CASE("bytes for each that moves are a bucket's own, and nothing when nothing moves") {
  WireCounts before, now;
  before.aura_bytes = 1000;
  now.aura_bytes = 1320;
  before.moving_auras = 5;
  now.moving_auras = 15;
  now.replica_bytes = 200;
  now.key_bytes = 20;
  const nlohmann::json json = to_json(now - before);
  CHECK(json["aura_bytes_per_moving_tick"].get<double>() == Approx(32));
  CHECK(json["replica_bytes_per_moving_tick"].is_null());
  CHECK(json["replica_key_share"].get<double>() == Approx(0.1));
}
