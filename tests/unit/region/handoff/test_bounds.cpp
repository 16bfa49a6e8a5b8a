// What piles up between neighbours, and what is refused when it grows too large.
#include "protocol/wire.h"
#include "tests/support/catch.h"
#include "tests/unit/region/handoff/besieged.h"

using namespace aureole;
using namespace aureole::testing;

TEST_CASE("more effects than fit one message are told in several that the other side takes") {
  Besieged region;
  region.world.max_thrown_per_player = 10'000;
  region.start();
  region.step();
  HandoffGroup group;
  group.tick = region.now;
  group.bodies.push_back({{BodyId::avatar(PlayerId{7}), avatar_prototype, at({10, 0.95, 0})}, 1});
  group.avatars.emplace_back().player = PlayerId{7};
  group.avatars[0].thrown = 9'000;  // Throwing nine thousand things here would take long.
  REQUIRE(region.hear(FrameType::handoff, encode_handoff(group)));
  region.step();
  PlayerCommand leave;
  leave.player = PlayerId{7};
  leave.sequence = 1;
  leave.kind = PlayerCommand::Kind::leave;
  const Bytes payload = encode_commands(std::span(&leave, 1));
  REQUIRE(region.core->receive(PeerId::gateway(0), Frame{FrameType::commands, 0, payload}));
  region.step(20);  // What players do waits while neighbours have just met.
  std::size_t removals = 0;
  for (const auto& entry : region.core->journal(RegionId{1}).unacknowledged()) {
    const auto effects = decode_effects(entry.payload);
    REQUIRE(effects);
    removals += effects->removals.size();
  }
  REQUIRE(removals == 9'000);
}

TEST_CASE("effects for a region that is away for long do not pile up without end") {
  Besieged region;
  region.start();
  region.core->peer_down(PeerId{1});
  PlayerCommand command;
  command.player = PlayerId{7};
  command.session = 1;
  command.kind = PlayerCommand::Kind::join;
  for (int i = 0; i < 6000; ++i) {
    ++command.sequence;
    const Bytes payload = encode_commands(std::span(&command, 1));
    REQUIRE(region.core->receive(PeerId::gateway(0), Frame{FrameType::commands, 0, payload}));
    region.step();
    command.kind = PlayerCommand::Kind::blast;
  }
  REQUIRE(region.core->journal(RegionId{1}).unacknowledged().size() <= 4096);
}

TEST_CASE("a neighbour that sets off more blasts, or removes more, than can be is refused") {
  Besieged region;
  region.start();
  region.step();
  const auto tell = [&](std::uint64_t from, std::size_t blasts, std::size_t removals) {
    EffectsMessage effects;
    for (std::size_t n = 0; n < blasts; ++n)
      effects.blasts.push_back(
          {from + n, region.now + 100, {0, 0, 0}, 1, 1, BodyId::avatar(PlayerId{1})});
    for (std::size_t n = 0; n < removals; ++n)
      effects.removals.push_back(BodyId::thrown(PlayerId{1}, static_cast<std::uint32_t>(from + n)));
    const Status taken = region.hear(FrameType::effects, encode_effects(effects));
    if (!taken) --region.sequence;  // It is sent again under the same number.
    return taken;
  };
  SECTION("blasts") {
    REQUIRE(tell(1, 4000, 0));
    SECTION("in one step") {}
    SECTION("in several") {
      region.step(3);
    }
    const Status more = tell(5000, 97, 0);
    REQUIRE_FALSE(more);
    CHECK(more.error().message.find("4097 blasts") != std::string::npos);
    CHECK(tell(5000, 96, 0));
  }
  SECTION("removals") {
    std::uint64_t from = 1;
    for (int n = 0; n < 16; ++n, from += 4096) REQUIRE(tell(from, 0, 4096));
    region.step();
    const Status more = tell(from, 0, 1);
    REQUIRE_FALSE(more);
    CHECK(more.error().message.find("65537 removals") != std::string::npos);
    // What has waited for long is waited for no more.
    region.step(200);
    CHECK(tell(from, 0, 1));
  }
}

TEST_CASE("groups that wait for a step are bounded by their bytes, too") {
  Besieged region;
  region.start();
  region.step();
  const auto tell = [&](std::uint32_t n) {
    HandoffGroup group;
    group.tick = region.now;
    group.bodies.push_back({{BodyId::world(1'000 + n), ball, at({10.0 + n, 3, 0})}, 1});
    Bytes payload = encode_handoff(group);
    payload.resize(8u << 20);
    const Status taken = region.hear(FrameType::handoff, std::move(payload));
    if (!taken) --region.sequence;
    return taken;
  };
  std::uint32_t n = 0;
  while (n < 32) REQUIRE(tell(n++));
  const Status more = tell(n);
  REQUIRE_FALSE(more);
  CHECK(more.error().message.find("too many handoffs") != std::string::npos);
  region.step();
  CHECK(tell(n));
  region.step();
  CHECK(region.core->physics().size() == 33);
}

TEST_CASE("a neighbour that talks and never says what it has taken is no neighbour") {
  Besieged region;
  region.start();
  PlayerCommand command;
  command.player = PlayerId{7};
  command.session = 1;
  command.kind = PlayerCommand::Kind::join;
  const auto& journal = region.core->journal(RegionId{1});
  const auto do_something = [&] {
    ++command.sequence;
    const Bytes payload = encode_commands(std::span(&command, 1));
    REQUIRE(region.core->receive(PeerId::gateway(0), Frame{FrameType::commands, 0, payload}));
    region.step();
    command.kind = PlayerCommand::Kind::blast;
  };
  const auto chatter = [&] {
    return region.hand_over(BodyId::world(90), ball, at({10, 3, 0}), region.now);
  };
  REQUIRE(chatter());
  for (int i = 0; i < 40'000 && journal.untaken() <= 16'384; ++i) do_something();
  REQUIRE(journal.untaken() == 16'385);
  const Status heard = chatter();
  REQUIRE_FALSE(heard);
  CHECK(heard.error().message.find("has not said that it took 16385 messages") !=
        std::string::npos);
  // It can always say so.
  flatbuffers::FlatBufferBuilder builder;
  const Bytes acknowledge =
      finish_frame(builder, wire::CreateAcknowledge(builder, 1, 1), FrameType::acknowledge);
  REQUIRE(region.core->receive(PeerId{1}, Frame(*decode_frame(acknowledge))));
  --region.sequence;
  CHECK(chatter());
}
