// Auras between two exchanges: whole at first, in short while they change, always the same in the
// end.
#include <map>
#include <random>

#include "protocol/wire.h"
#include "server/region/auras/aura_exchange.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr RegionId teller{0}, hearer{1};
constexpr std::size_t prototypes = 3, regions = 2;

/// Nobody rests; every third body has gone to another server when it is gone.
class SomeBodies : public AuraBodies {
 public:
  double mass_kg(BodyId id) const override { return 1 + static_cast<double>(id.value & 7); }
  NewBody resting_body(BodyId id) const override { return {id, PrototypeId{0}, {}}; }
  bool was_handed_over(BodyId id) const override { return id.value % 3 == 0; }
};

/// Two servers and the wire between them.
struct Wire {
  Wire() {
    from.link_up(hearer);
    to.link_up(teller);
  }
  /// Says what is decided; the message's payload, empty if there was nothing to say.
  Bytes tell(const MigrationDecision& decision) {
    from.announce(Tick{++tick}, decision, SomeBodies{});
    const SharedBytes frame = from.take_frame(hearer);
    if (!frame) return {};
    const Bytes payload = Frame(*decode_frame(*frame)).payload;
    const auto told = to.receive(teller, payload, prototypes, regions);
    INFO((told ? "" : told.error().message));
    REQUIRE(told);
    to.take_in();
    return payload;
  }
  AuraExchange from, to;
  std::int64_t tick = 0;
};

ProjectedAura aura(std::uint32_t n, double x) {
  ProjectedAura made;
  made.id = BodyId::world(n);
  made.room = {{x, 2, -3}, {0.3, -0.51, 0.7}, 0.4};
  made.company = {static_cast<std::uint16_t>(n + 1), 3, 2, n % 2 == 0, n % 4 < 2};
  made.speed_mps = std::abs(x);
  made.to.add(hearer);
  return made;
}

MigrationDecision auras(std::uint32_t from, std::uint32_t until, double x) {
  MigrationDecision made;
  for (std::uint32_t n = from; n < until; ++n) made.projected.push_back(aura(n, x));
  return made;
}

bool is_as_decided(const RemoteAura& heard, const ProjectedAura& told) {
  // The room that was heard holds the one that was told, and is hardly larger.
  const double off = (heard.room.centre - told.room.centre).norm() +
                     (heard.room.half_spine - told.room.half_spine).norm();
  const double larger = heard.room.girth_m - told.room.girth_m;
  return heard.id == told.id && heard.host == teller && heard.asleep == told.asleep &&
         heard.company == told.company && heard.mass_kg == SomeBodies{}.mass_kg(told.id) &&
         heard.speed_mps >= told.speed_mps && heard.speed_mps < told.speed_mps + 0.016 &&
         larger >= off && larger < 0.1;
}

}  // namespace

TEST_CASE("an aura that changes costs 22 bytes, one that does not costs nothing") {
  Wire wire;
  const std::size_t whole = wire.tell(auras(0, 400, 1)).size();
  CHECK(whole >= 400 * sizeof(wire::Aura));
  const std::size_t in_short = wire.tell(auras(0, 400, 2)).size();
  CHECK(in_short >= 400 * 22);
  CHECK(in_short < 400 * 22 + 96);
  CHECK(wire.tell(auras(0, 400, 2)).empty());
  MigrationDecision one = auras(0, 400, 2);
  one.projected[7].room.centre.z() += 1;
  CHECK(wire.tell(one).size() < 22 + 96);
  CHECK(is_as_decided(wire.to.remote()[7], one.projected[7]));
}

TEST_CASE("auras that come, change, sleep and go are known as they were told") {
  Wire wire;
  std::mt19937 random(11);
  std::map<std::uint32_t, ProjectedAura> now;
  for (int round = 0; round < 400; ++round) {
    for (int change = 0; change < 12; ++change) {
      const std::uint32_t n = random() % 50;
      if (random() % 3 == 0)
        now.erase(n);
      else
        now[n] = aura(n, static_cast<double>(random() % 4000) / 64);
      if (!now.contains(n)) continue;
      now[n].asleep = random() % 2 == 0;
      now[n].company.lately = random() % 2 == 0;
    }
    MigrationDecision decision;
    for (const auto& [n, projected] : now) decision.projected.push_back(projected);
    wire.tell(decision);
    const auto remote = wire.to.remote();
    REQUIRE(remote.size() == decision.projected.size());
    for (std::size_t i = 0; i < remote.size(); ++i)
      REQUIRE(is_as_decided(remote[i], decision.projected[i]));
    if (round % 97 == 96) {
      wire.from.link_down(hearer);
      wire.to.link_down(teller);
      wire.from.link_up(hearer);
      wire.to.link_up(teller);
    }
  }
}

TEST_CASE("a slot that nobody was bound to, or whose body is gone, is refused") {
  Wire wire;
  wire.tell(auras(0, 4, 1));
  const Bytes moves = wire.tell(auras(0, 4, 2));
  AuraExchange fresh;
  fresh.link_up(teller);
  const auto unknown = fresh.receive(teller, moves, prototypes, regions);
  REQUIRE_FALSE(unknown);
  CHECK(unknown.error().message == "an aura in slot 0 moves, in which there is none");
  CHECK(wire.to.receive(teller, moves, prototypes, regions));
  wire.tell(auras(1, 4, 2));
  CHECK_FALSE(wire.to.receive(teller, moves, prototypes, regions));
}

TEST_CASE("what is asked for is heard with all that the asker knows, or refused") {
  Wire wire;
  MigrationDecision decision;
  for (const auto hold :
       {Company::Hold::none, Company::Hold::lately_come, Company::Hold::changed_twice})
    decision.pulls.push_back(
        {hearer, teller, {BodyId::world(static_cast<std::uint32_t>(hold))}, hold});
  wire.from.announce(Tick{1}, decision, SomeBodies{});
  const SharedBytes frame = wire.from.take_frame(hearer);
  Bytes payload = Frame(*decode_frame(*frame)).payload;
  REQUIRE(wire.to.receive(teller, payload, prototypes, regions));
  const auto heard = wire.to.take_in();
  REQUIRE(heard.size() == decision.pulls.size());
  for (std::size_t i = 0; i < heard.size(); ++i) {
    CHECK(heard[i].body == decision.pulls[i].bodies[0]);
    CHECK(heard[i].to == teller);
    CHECK(heard[i].asker == teller);
    CHECK(heard[i].known == decision.pulls[i].known);
  }
  const auto refusal = [&](const std::vector<std::uint8_t>& known) {
    flatbuffers::FlatBufferBuilder builder;
    const auto ids = builder.CreateVector(std::vector<std::uint64_t>{1, 2});
    const auto to = builder.CreateVector(std::vector<std::uint16_t>{0, 1});
    const auto known_at = builder.CreateVector(known);
    const Bytes made = finish_frame(
        builder, wire::CreateAuras(builder, 1, 0, 0, 0, 0, ids, to, 0, known_at), FrameType::auras);
    const auto taken =
        wire.to.receive(teller, Frame(*decode_frame(made)).payload, prototypes, regions);
    return taken ? "" : taken.error().message;
  };
  CHECK(refusal({0, 2}) == "");
  CHECK(refusal({0}) == "an auras message asks for bodies without saying what it knows of them");
  CHECK(refusal({0, 3}) == "an auras message asks for a body of which it knows 3; expected 0 to 2");
}

TEST_CASE("a slot can change hands within one message") {
  Wire wire;
  wire.tell(auras(0, 1, 1));
  wire.tell(auras(5, 6, 2));
  const MigrationDecision moved = auras(5, 6, 3);
  wire.tell(moved);
  REQUIRE(wire.to.remote().size() == 1);
  CHECK(is_as_decided(wire.to.remote()[0], moved.projected[0]));
}

TEST_CASE("more auras than there are slots are told whole") {
  Wire wire;
  constexpr std::uint32_t count = AuraExchange::max_auras;
  wire.tell(auras(0, count, 1));
  const MigrationDecision moved = auras(0, count, 2);
  const Bytes payload = wire.tell(moved);
  const auto* message = verified<wire::Auras>(payload);
  CHECK(message->moved()->size() == AuraExchange::no_slot);
  CHECK(message->auras()->size() == count - AuraExchange::no_slot);
  REQUIRE(wire.to.remote().size() == count);
  CHECK(is_as_decided(wire.to.remote().back(), moved.projected.back()));
}

TEST_CASE("of two servers that both claim a body the lower number's aura counts") {
  AuraExchange here;
  for (const RegionId from : {RegionId{2}, RegionId{0}, RegionId{1}}) {
    here.link_up(from);
    AuraExchange there;
    there.link_up(hearer);
    there.announce(Tick{1}, auras(from.value, from.value + 3u, from.value), SomeBodies{});
    REQUIRE(here.receive(from, decode_frame(*there.take_frame(hearer))->payload, prototypes, 3));
  }
  here.take_in();
  REQUIRE(here.remote().size() == 5);
  for (std::uint32_t n = 0; n < 5; ++n) {
    CHECK(here.remote()[n].id == BodyId::world(n));
    CHECK(here.remote()[n].host.value == (n < 3 ? 0 : n - 2));
  }
}
