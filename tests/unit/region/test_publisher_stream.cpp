// The publisher against a store: whatever bodies do and however they come and go, gateways have
// them where they are.
#include <map>
#include <random>

#include "protocol/wire_values.h"
#include "server/region/replica_publisher.h"
#include "server/replica/replica_store.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

constexpr RegionId self{0};

/// A publisher, the bodies that it speaks of, and a gateway that listens.
class Publishing {
 public:
  Publishing()
      : world_(flat_world(1)),
        definitions_{world_.prototypes[0].body, world_.prototypes[1].body},
        statics_{world_.statics[0].body},
        physics_(world_.physics, definitions_, statics_, 256),
        store_(world_.prototypes.size()) {
    store_.region_up(self);
  }
  PhysicsWorld& physics() { return physics_; }
  const ReplicaStore& store() const { return store_; }

  void gain(std::uint32_t n, WorldPosition at, Activation activation, Eigen::Vector3f velocity) {
    NewBody body{BodyId::world(n), PrototypeId{static_cast<PrototypeId::rep>(n % 2)}, {}};
    body.state.position = at;
    body.state.linear_velocity = velocity;
    body.state.activation = activation;
    physics_.add({&body, 1});
    publisher_.body_gained(body.id, {++epochs_[body.id], Incarnation{1}, self});
  }
  /// Its new owner has not been heard of.
  void lose(BodyId id) {
    physics_.remove({&id, 1});
    publisher_.body_lost(id);
  }
  void remove(BodyId id) {
    physics_.remove({&id, 1});
    publisher_.body_removed(id, {epochs_[id], Incarnation{1}, self});
  }
  /// How many keys and motions the tick cost.
  std::pair<std::size_t, std::size_t> step() {
    physics_.step(tick_s);
    const SharedBytes bytes = publisher_.update(++now_, physics_, {});
    const Frame frame = *decode_frame(*bytes);
    const auto* update = verified<wire::ReplicaUpdate>(frame.payload);
    const Status taken = store_.apply(self, frame.payload);
    INFO((taken ? "" : taken.error().message));
    REQUIRE(taken);
    for (flatbuffers::uoffset_t i = 1; i < update->keys()->size(); ++i)
      REQUIRE(update->keys()->Get(i - 1)->id() < update->keys()->Get(i)->id());
    return {update->keys()->size(), update->motions()->size()};
  }
  /// Every body where it is, asleep if it sleeps.
  void judge() const {
    for (BodyId id : physics_.ids()) {
      const auto pose = store_.sample_body(id, now_.value * tick_us);
      CAPTURE(id.value, now_.value);
      REQUIRE(pose);
      REQUIRE(pose->position == dequantise(quantise(physics_.position(id))));
      REQUIRE(pose->asleep == physics_.is_asleep(id));
      REQUIRE(store_.version(id)->epoch == epochs_.at(id));
    }
  }

 private:
  struct Counter {
    std::int64_t value = 0;
    Tick operator++() { return Tick{++value}; }
  };
  WorldDefinition world_;
  std::vector<BodyDefinition> definitions_;
  std::vector<StaticDefinition> statics_;
  PhysicsWorld physics_;
  ReplicaPublisher publisher_;
  ReplicaStore store_;
  std::map<BodyId, std::uint32_t> epochs_;
  Counter now_;
};

}  // namespace

TEST_CASE("bodies that come, go, come again, wake and sleep are where gateways have them") {
  Publishing here;
  std::mt19937 random(5);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  for (int tick = 0; tick < 900; ++tick) {
    for (std::uint32_t times = below(3); times > 0 && tick < 500; --times) {
      const std::uint32_t n = below(60);
      const BodyId id = BodyId::world(n);
      const WorldPosition at{2.0 * (n % 8), 0.6 + below(3), 2.0 * (n / 8)};
      const auto activation = below(2) == 0 ? Activation::asleep : Activation::awake;
      if (!here.physics().contains(id)) {
        here.gain(n, at, activation, {1, 0, 0});
      } else if (const std::uint32_t what = below(5); what == 0) {
        here.lose(id);
      } else if (what == 1) {
        // In the same tick, so that it is another body under the same name.
        here.lose(id);
        here.gain(n, at, activation, {0, 0, 1});
      } else if (what == 2) {
        here.physics().wake(id);
      } else if (what == 3) {
        here.physics().set_velocity(id, {0, 2, 0}, {1, 1, 1});
      } else {
        here.remove(id);
        here.gain(n, at, activation, {0, 0, 0});
      }
    }
    here.step();
    here.judge();
  }
  // Then all sleeps, and costs nothing any more.
  for (int tick = 0; tick < 2000 && here.physics().awake_count() > 0; ++tick) here.step();
  REQUIRE(here.physics().awake_count() == 0);
  here.step();
  here.judge();
  CHECK(here.step() == std::pair<std::size_t, std::size_t>{0, 0});
}
