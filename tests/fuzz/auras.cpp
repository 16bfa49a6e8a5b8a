// AuraExchange: whatever a region projects, what is taken in can be simulated with and is bounded.
#include <cmath>

#include "protocol/wire.h"
#include "server/region/auras/aura_exchange.h"
#include "server/region/handoff/handoff.h"
#include "tests/fuzz/fuzz_target.h"

using namespace aureole;

namespace {

constexpr std::size_t prototypes = 3, regions = 4;
constexpr RegionId hostile{1}, honest{2};

/// Bodies of which the even ones rest a little apart from each other.
class SomeBodies : public AuraBodies {
 public:
  double mass_kg(BodyId) const override { return 2.5; }
  NewBody resting_body(BodyId id) const override {
    NewBody body{id, PrototypeId{1}, {}};
    body.state.position = {static_cast<double>(id.value & 0xff), creep_m, -1};
    body.state.activation = Activation::asleep;
    return body;
  }
  bool was_handed_over(BodyId id) const override { return id.value % 3 == 0; }
  double creep_m = 0;
};

MigrationDecision decision(std::uint32_t from, std::uint32_t until, bool asks = false,
                           double height_m = 1) {
  MigrationDecision made;
  RegionSet told;
  told.add(RegionId{0});
  for (std::uint32_t n = from; n < until; ++n)
    made.projected.push_back({BodyId::world(n),
                              {{double(n), height_m, -1}, {0.5, 1, 2}},
                              n % 4 == 0,
                              n % 2 == 0,
                              double(n % 7),
                              {},
                              told});
  if (asks)
    made.pulls = {{RegionId{0}, RegionId{2}, {BodyId::world(100)}},
                  {RegionId{0}, RegionId{1}, {BodyId::world(100), BodyId::world(101)}}};
  return made;
}

/// What a region says to region 0 when it decides so, one after the other.
std::vector<Bytes> messages(std::initializer_list<MigrationDecision> decisions) {
  AuraExchange sender;
  sender.link_up(RegionId{0});
  SomeBodies bodies;
  std::vector<Bytes> payloads;
  for (const MigrationDecision& made : decisions) {
    sender.announce(Tick{7}, made, bodies);
    if (const SharedBytes frame = sender.take_frame(RegionId{0}))
      payloads.emplace_back(frame->begin() + sizeof(FrameHeader), frame->end());
    bodies.creep_m += 0.1;
  }
  return payloads;
}

AuraExchange a_receiver() {
  AuraExchange exchange;
  exchange.link_up(hostile);
  exchange.link_up(honest);
  const auto told =
      exchange.receive(honest, messages({decision(1, 4)}).front(), prototypes, regions);
  FUZZ_EXPECT(told && told->value == 7);
  FUZZ_EXPECT(exchange.take_in().empty() && exchange.take_resting_news().size() == 2);
  return exchange;
}

void check(std::span<const RemoteAura> remote) {
  for (std::size_t i = 0; i < remote.size(); ++i) {
    const RemoteAura& aura = remote[i];
    FUZZ_EXPECT(i == 0 || remote[i - 1].id < aura.id);
    FUZZ_EXPECT(aura.id.valid() && (aura.host == hostile || aura.host == honest));
    FUZZ_EXPECT(aura.mass_kg > 0 && std::isfinite(aura.mass_kg) && aura.speed_mps < 1024.001);
    FUZZ_EXPECT(aura.room.centre.cwiseAbs().maxCoeff() <= position_limit_m);
    FUZZ_EXPECT(aura.room.half_spine.cwiseAbs().maxCoeff() <= 8.001);
    FUZZ_EXPECT(aura.room.girth_m >= 0 && aura.room.girth_m < 1024.001);
    FUZZ_EXPECT(aura.company.size_class <= Company::size_class_max);
    FUZZ_EXPECT(aura.company.changes <= Company::changes_max);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes payload = payload_of(data, size);

  AuraExchange exchange = a_receiver();
  const auto told = exchange.receive(hostile, payload, prototypes, regions);
  FUZZ_EXPECT(told || !told.error().message.empty());
  // Ticks are compared with each other: their differences must not overflow.
  FUZZ_EXPECT(!told || is_wire_tick(told->value));
  const auto requests = exchange.take_in();
  check(exchange.remote());
  // What the honest region says stays, as far as it is not said twice.
  FUZZ_EXPECT(exchange.remote().size() >= 3 && exchange.remote().size() <= 3 + size / 8);
  FUZZ_EXPECT(told || (exchange.remote().size() == 3 && requests.empty()));
  for (std::size_t i = 0; i < requests.size(); ++i) {
    FUZZ_EXPECT(requests[i].to.value < regions);
    FUZZ_EXPECT(i == 0 || requests[i - 1].body < requests[i].body);
  }
  const auto news = exchange.take_resting_news();
  FUZZ_EXPECT(news.size() <= 1 + size / 8 && (told || news.empty()));
  for (const RestingNews& item : news) {
    FUZZ_EXPECT(item.from == hostile);
    if (item.kind != RestingNews::Kind::rests) continue;
    FUZZ_EXPECT(item.body.id.valid() && item.body.prototype.value < prototypes);
    FUZZ_EXPECT(may_travel(item.body.state));
  }

  // The same again changes nothing; with the link it goes. (Nothing that was never told can move.)
  const auto* message = verified<wire::Auras>(payload);
  const bool moves = message != nullptr && message->moved() != nullptr && message->moved()->size();
  FUZZ_EXPECT(!moves || !told);
  const std::size_t known = exchange.remote().size();
  FUZZ_EXPECT(bool(exchange.receive(hostile, payload, prototypes, regions)) == bool(told));
  exchange.take_in();
  FUZZ_EXPECT(exchange.remote().size() == known);
  exchange.link_down(hostile);
  exchange.take_in();
  FUZZ_EXPECT(exchange.remote().size() == 3 && !exchange.has_heard(hostile));

  // Behind an honest message there is something to move.
  AuraExchange moving = a_receiver();
  FUZZ_EXPECT(moving.receive(hostile, messages({decision(10, 14)}).front(), prototypes, regions));
  const auto moved = moving.receive(hostile, payload, prototypes, regions);
  moving.take_in();
  check(moving.remote());
  FUZZ_EXPECT(moved || moving.remote().size() == 7);
  return 0;
}

std::vector<Bytes> aureole_fuzz_seeds() {
  std::vector<Bytes> seeds = messages({decision(1, 8), decision(1, 8), decision(5, 6, true)});
  for (Bytes& more : messages({{}, decision(0, 200), decision(0, 2)})) seeds.push_back(more);
  for (Bytes& more : messages({decision(10, 14), decision(10, 14, false, 2)}))
    seeds.push_back(more);
  for (const std::int64_t tick : {std::int64_t{8}, INT64_MAX, INT64_MIN}) {
    const SharedBytes life = AuraExchange().sign_of_life(Tick{tick});
    seeds.emplace_back(life->begin() + sizeof(FrameHeader), life->end());
  }
  return seeds;
}
