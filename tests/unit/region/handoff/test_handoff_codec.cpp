// Handoffs and commands as bytes: exact when they are honest, refused when they are not.
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "protocol/wire.h"
#include "server/region/handoff/handoff.h"
#include "server/region/players/effects.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

HandoffGroup sample_group() {
  HandoffGroup group;
  group.tick = Tick{1234};
  for (std::uint32_t i = 0; i < 3; ++i) {
    HandoffGroup::Body b;
    b.body.id = BodyId::world(10 + i);
    b.body.prototype = PrototypeId{1};
    b.body.state.position = {1.25 + i, 2.5, -3.125};
    b.body.state.orientation = Eigen::Quaternionf(0.5f, 0.5f, -0.5f, 0.5f);
    b.body.state.linear_velocity = {1, 2, 3};
    b.body.state.activation = Activation::wants_sleep;
    b.body.state.deactivation_time_s = 0.25f;
    b.epoch = 7 + i;
    b.still_ticks = static_cast<std::uint8_t>(3 * i);
    b.owned_ticks = static_cast<std::uint8_t>(5 * i);
    group.bodies.push_back(b);
  }
  group.bodies.push_back({{BodyId::avatar(PlayerId{5}), PrototypeId{0}, {}}, 2});
  ContactManifold manifold;
  manifold.a = BodyId::world(10);
  manifold.b = BodyId::world(11);
  manifold.ordinal = 1;
  ContactPoint point;
  point.impulse = 0.75f;
  point.age_steps = 9;
  point.child_b = 3;
  manifold.points = {point, point};
  group.contacts.push_back(manifold);
  manifold.b = StaticId{2};
  group.contacts.push_back(manifold);
  Avatar avatar;
  avatar.player = PlayerId{5};
  avatar.session = 77;
  avatar.applied_sequence = 12;
  avatar.active = Tick{400};
  avatar.held_until = Tick{408};
  avatar.carried = BodyId::world(11);
  PlayerCommand command;
  command.player = PlayerId{5};
  command.session = 77;
  command.sequence = 14;
  command.kind = PlayerCommand::Kind::blast;
  avatar.waiting.emplace(14u, command);
  group.avatars.push_back(avatar);
  return group;
}

/// Encodes, spoils by `change`, and returns the sentence of the refusal ("" if it was accepted).
template <class Change>
std::string refusal(Change change) {
  HandoffGroup group = sample_group();
  change(group);
  const auto back = decode_handoff(encode_handoff(group), 4, 4);
  return back ? "" : back.error().message;
}

}  // namespace

TEST_CASE("a handoff comes back bit for bit") {
  const HandoffGroup group = sample_group();
  const auto back = decode_handoff(encode_handoff(group), 4, 4);
  REQUIRE(back);
  REQUIRE(back->tick == group.tick);
  REQUIRE(back->bodies.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto &a = back->bodies[i], &b = group.bodies[i];
    REQUIRE(a.body.id == b.body.id);
    REQUIRE(a.epoch == b.epoch);
    REQUIRE(a.still_ticks == b.still_ticks);
    REQUIRE(a.owned_ticks == b.owned_ticks);
    REQUIRE(a.body.state.position == b.body.state.position);
    REQUIRE(a.body.state.orientation.coeffs() == b.body.state.orientation.coeffs());
    REQUIRE(a.body.state.linear_velocity == b.body.state.linear_velocity);
    REQUIRE(a.body.state.activation == b.body.state.activation);
    REQUIRE(a.body.state.deactivation_time_s == b.body.state.deactivation_time_s);
  }
  REQUIRE(back->contacts.size() == 2);
  REQUIRE(std::get<BodyId>(back->contacts[0].b) == BodyId::world(11));
  REQUIRE(std::get<StaticId>(back->contacts[1].b) == StaticId{2});
  REQUIRE(back->contacts[0].points.size() == 2);
  REQUIRE(back->contacts[0].points[1].impulse == 0.75f);
  REQUIRE(back->contacts[0].points[1].child_b == 3);
  REQUIRE(back->avatars.size() == 1);
  REQUIRE(back->avatars[0].session == 77);
  REQUIRE(back->avatars[0].carried == BodyId::world(11));
  REQUIRE(back->avatars[0].active == Tick{400});
  REQUIRE(back->avatars[0].held_until == Tick{408});
  REQUIRE(back->avatars[0].waiting.at(14).kind == PlayerCommand::Kind::blast);
}

TEST_CASE("a handoff with anything wrong in it is refused with a sentence") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  REQUIRE(refusal([](auto&) {}).empty());
  REQUIRE_FALSE(refusal([](auto& g) {
                  g.bodies.clear();
                  g.avatars.clear();
                  g.contacts.clear();
                }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.bodies[0].body.id = BodyId{5}; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { std::swap(g.bodies[0], g.bodies[1]); }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.bodies[1].body.prototype = PrototypeId{4}; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.bodies[1].body.state.position.y = NAN; }).empty());
  REQUIRE_FALSE(
      refusal([&](auto& g) { g.bodies[1].body.state.linear_velocity.x() = nan; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.bodies[1].body.state.orientation.coeffs() *= 2; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) {
                  g.bodies[1].body.state.activation = static_cast<Activation>(3);
                }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.contacts[0].b = BodyId::world(99); }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.contacts[0].a = BodyId::world(99); }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.contacts[1].b = StaticId{4}; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.contacts[0].points.clear(); }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.contacts[0].points.resize(5); }).empty());
  REQUIRE_FALSE(refusal([&](auto& g) { g.contacts[0].points[0].impulse = nan; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.contacts[0].points[0].child_a = 1000; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.avatars[0].player = PlayerId{6}; }).empty());
  REQUIRE_FALSE(refusal([&](auto& g) { g.avatars[0].yaw = nan; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.tick = Tick{INT64_MIN}; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.bodies[1].body.state.position.x = 1e300; }).empty());
  REQUIRE_FALSE(
      refusal([](auto& g) { g.bodies[1].body.state.linear_velocity.x() = 3e38f; }).empty());
  REQUIRE_FALSE(
      refusal([](auto& g) { g.bodies[1].body.state.angular_velocity.x() = 3e38f; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.contacts[0].points[0].impulse = 3e38f; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.contacts[0].points[0].normal_on_b *= 2; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.contacts[0].points[1].lateral_2 = {9, 0, 0}; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.avatars[0].carried = g.avatars[0].body(); }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.avatars[0].lost_since = Tick{INT64_MIN}; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.avatars[0].held_until = Tick{INT64_MAX}; }).empty());
  REQUIRE_FALSE(refusal([](auto& g) { g.avatars[0].session = UINT32_MAX; }).empty());
  REQUIRE(refusal([](auto& g) { g.avatars.push_back(g.avatars[0]); }) ==
          "a handoff carries player 5 twice");
  // A second name of an avatar, beside the one that its player is found by.
  REQUIRE_FALSE(refusal([](auto& g) {
                  g.avatars.clear();
                  g.bodies.back().body.id.value |= std::uint64_t{1} << 40;
                }).empty());
}

TEST_CASE("no cut or flipped byte of a handoff does more than be refused") {
  const Bytes good = encode_handoff(sample_group());
  for (std::size_t n = 0; n < good.size(); n += 8) {
    const Bytes cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(n));
    static_cast<void>(decode_handoff(cut, 4, 4));
  }
  std::mt19937 random(1);
  for (int round = 0; round < 20'000; ++round) {
    Bytes bad = good;
    for (int k = 0; k < 1 + round % 4; ++k)
      bad[random() % bad.size()] = static_cast<std::byte>(random());
    if (auto group = decode_handoff(bad, 4, 4)) {
      for (const auto& b : group->bodies) REQUIRE(is_sane(b.body.state));
    }
  }
}

TEST_CASE("commands and effects come back as they were, and are refused when they cannot be") {
  PlayerCommand command{PlayerId{9}, 3,     4, PlayerCommand::Kind::grab,
                        keys::jump,  2,     1, BodyId::world(4),
                        1.5f,        -0.5f, 6};
  auto back = decode_commands(encode_commands(std::span(&command, 1)));
  REQUIRE(back);
  REQUIRE(back->size() == 1);
  REQUIRE((*back)[0].target == BodyId::world(4));
  REQUIRE((*back)[0].pitch == -0.5f);
  REQUIRE((*back)[0].spawn == 6);
  command.yaw = std::numeric_limits<float>::infinity();
  REQUIRE_FALSE(decode_commands(encode_commands(std::span(&command, 1))));
  command.yaw = 0;
  command.session = UINT32_MAX;
  REQUIRE_FALSE(decode_commands(encode_commands(std::span(&command, 1))));
  command.session = 3;
  command.player = PlayerId{};
  REQUIRE_FALSE(decode_commands(encode_commands(std::span(&command, 1))));

  EffectsMessage effects;
  effects.blasts.push_back({1, Tick{5}, {1, 2, 3}, 9, 12, BodyId::avatar(PlayerId{1})});
  effects.removals.push_back(BodyId::thrown(PlayerId{1}, 7));
  effects.requests.push_back({BodyId::world(3), PlayerId{1}});
  const auto same = decode_effects(encode_effects(effects));
  REQUIRE(same);
  REQUIRE(same->blasts[0].radius_m == 9);
  REQUIRE(same->removals == effects.removals);
  REQUIRE(same->requests[0].body == BodyId::world(3));
  // Only its host may take an avatar out of the world.
  effects.removals.push_back(BodyId::avatar(PlayerId{1}));
  REQUIRE_FALSE(decode_effects(encode_effects(effects)));
  effects.removals.pop_back();
  for (const auto& spoil : std::initializer_list<void (*)(BlastEffect&)>{
           [](auto& b) { b.radius_m = -1; }, [](auto& b) { b.radius_m = NAN; },
           [](auto& b) { b.speed_mps = NAN; }, [](auto& b) { b.position.z = NAN; },
           [](auto& b) { b.position.x = -1e300; }, [](auto& b) { b.tick = Tick{INT64_MIN}; },
           [](auto& b) { b.tick = Tick{INT64_MAX}; }}) {
    EffectsMessage bad = effects;
    REQUIRE(decode_effects(encode_effects(bad)));
    spoil(bad.blasts[0]);
    REQUIRE_FALSE(decode_effects(encode_effects(bad)));
  }
}

TEST_CASE("a handoff that names one contact many times is refused before it fills the memory") {
  flatbuffers::FlatBufferBuilder builder;
  const auto id = BodyId::world(1).value;
  const std::vector body(1, wire::HandoffBody(id, 1, 0, 0, 0, {}, {0, 0, 0, 1}, {}, {}, 0, 0));
  const std::vector points(4,
                           wire::HandoffPoint({}, {}, {0, 1, 0}, 0, 0, 0, 0, {}, {}, 0, 0, -1, -1));
  const auto contact =
      wire::CreateHandoffManifold(builder, id, 0, 0, 0, builder.CreateVectorOfStructs(points));
  const auto contacts = builder.CreateVector(std::vector(100'000, contact));
  builder.Finish(wire::CreateHandoff(builder, 1, builder.CreateVectorOfStructs(body), contacts));
  const auto bytes = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
  const auto group = decode_handoff(Bytes(bytes.begin(), bytes.end()), 4, 4);
  REQUIRE_FALSE(group);
  REQUIRE(group.error().message == "a handoff names the same contacts several times");
}

TEST_CASE("a group with more contacts than fit a frame travels with those that fit") {
  HandoffGroup group = sample_group();
  group.contacts[0].points.resize(4, group.contacts[0].points[0]);
  group.contacts.assign(40'000, group.contacts[0]);
  const Bytes payload = encode_handoff(group);
  REQUIRE(payload.size() <= max_payload_bytes);
  const auto back = decode_handoff(payload, 4, 4);
  REQUIRE(back);
  REQUIRE(back->bodies.size() == 4);
  REQUIRE(back->contacts.size() > 1000);
  REQUIRE(back->contacts.size() < 40'000);
}
