// ReplicaStore::apply: a hostile region can spoil no number in the store, and nobody else's bodies.
#include <cmath>

#include "protocol/quantise.h"
#include "server/replica/replica_store.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/unit/replica/update.h"

using namespace aureole;
using namespace aureole::test;

namespace {

constexpr std::size_t prototypes = 3;

/// A store in which region 1 owns a body and region 0 another, with slots 0 to 2 bound for region
/// 0.
ReplicaStore a_store() {
  ReplicaStore store(prototypes);
  store.region_up(r0);
  store.region_up(r1);
  Update own(5);
  own.key({.id = box, .slot = 0}).key({.id = BodyId::world(1), .slot = 1});
  own.key({.id = BodyId::avatar(PlayerId{7}), .slot = 2}).player(7, 1, 1);
  FUZZ_EXPECT(store.apply(r0, own.bytes()));
  FUZZ_EXPECT(store.apply(
      r1, Update(5)
              .key({.id = ball, .version = version_of(r1, ~0u, ~0ull), .position = {1, 2, 3}})
              .bytes()));
  return store;
}

void check(const ReplicaStore& store, std::int64_t world_us) {
  std::vector<ReplicaPose> poses;
  store.sample(world_us, poses);
  FUZZ_EXPECT(poses.size() == store.size());
  std::size_t awake = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const ReplicaPose& pose = poses[i];
    FUZZ_EXPECT(i == 0 || poses[i - 1].id < pose.id);
    FUZZ_EXPECT(pose.id.valid() && pose.prototype.value < prototypes);
    FUZZ_EXPECT(pose.position.vector().cwiseAbs().maxCoeff() <= position_limit_m);
    FUZZ_EXPECT(std::abs(pose.orientation.norm() - 1) < 1e-5f);
    const auto key = store.key_state(pose.id);
    FUZZ_EXPECT(key && key->version.region == pose.owner && key->state.position.is_finite());
    FUZZ_EXPECT(key->state.linear_velocity.allFinite() && key->state.angular_velocity.allFinite());
    if (!pose.asleep) ++awake;
  }
  FUZZ_EXPECT(awake >= store.awake_count());
  FUZZ_EXPECT(store.owner_counts(r0).bodies + store.owner_counts(r1).bodies == store.size());
  FUZZ_EXPECT(store.owner_counts(r0).awake + store.owner_counts(r1).awake == store.awake_count());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // As it comes out of FrameReader: aligned, a multiple of 8.
  const auto input = std::as_bytes(std::span(data, size - size % 8));
  const Bytes payload(input.begin(), input.end());

  ReplicaStore store = a_store();
  const bool taken = bool(store.apply(r0, payload));
  check(store, at_tick(5.5));
  // Region 1's body has the highest version there is, and region 0 may not speak in its name.
  const auto held = store.key_state(ball);
  FUZZ_EXPECT(held && held->version == version_of(r1, ~0u, ~0ull));
  FUZZ_EXPECT(store.sample_body(ball, at_tick(5))->position == (WorldPosition{1, 2, 3}));

  // The same again changes nothing that shows, and the link may break and come back.
  const std::size_t bodies = store.size();
  FUZZ_EXPECT(bool(store.apply(r0, payload)) == taken);
  FUZZ_EXPECT(!taken || store.size() == bodies);
  if (const auto tick = store.newest_tick(r0)) check(store, tick->value * tick_us - tick_us / 3);
  store.region_up(r0);
  (void)bool(store.apply(r0, payload));
  check(store, at_tick(5));
  return 0;
}

std::vector<Bytes> aureole_fuzz_seeds() {
  Key spinning{.id = ball, .slot = 3, .position = {-4, 5, 6}, .prototype = 2, .activation = 1};
  spinning.orientation = Eigen::Quaternionf(1, 2, 3, 4).normalized();
  spinning.angular_velocity = {1, 2, 3};
  const Key returned{.id = box, .version = version_of(r0, 2), .slot = 0, .activation = 2};
  Update many(9);
  for (std::uint32_t n = 0; n < 40; ++n) many.key({.id = BodyId::world(n), .slot = 100 + n});
  for (std::uint32_t n = 0; n < 40; ++n) many.motion(100 + n, {double(n), 1, 1});
  return {
      Update(6).bytes(),
      Update(6).key(spinning).complete().bytes(),
      Update(7).motion(0, {1, 1, 1}).motion(1, {2, 2, 2}, spinning.orientation).bytes(),
      Update(6)
          .key(returned)
          .motion(2, {3, 3, 3})
          .removed(BodyId::world(1), version_of(r0, 1))
          .bytes(),
      Update(8).player(7, 2, 3, box).removed(ball, version_of(r0, 9)).bytes(),
      many.bytes(),
  };
}
