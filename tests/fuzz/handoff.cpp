// decode_handoff: what a hostile region hands over is either refused or a group that can travel on.
#include <algorithm>

#include "protocol/wire_values.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/groups.h"

using namespace aureole;
using namespace aureole::fuzz;

namespace {

void check(const HandoffGroup& group, std::size_t size) {
  std::size_t points = 0, waiting = 0;
  FUZZ_EXPECT(!group.bodies.empty() && is_wire_tick(group.tick.value));
  const auto carries = [&](BodyId id) {
    return std::any_of(group.bodies.begin(), group.bodies.end(),
                       [&](const auto& b) { return b.body.id == id; });
  };
  for (const auto& b : group.bodies) {
    FUZZ_EXPECT(b.body.id.valid() && b.body.prototype.value < prototypes);
    FUZZ_EXPECT(may_travel(b.body.state));
  }
  for (const NewBody& body : group.stand_ins) FUZZ_EXPECT(may_travel(body.state));
  for (const ContactManifold& contact : group.contacts) {
    const auto* body = std::get_if<BodyId>(&contact.b);
    FUZZ_EXPECT(carries(contact.a) || (body != nullptr && carries(*body)));
    FUZZ_EXPECT(body != nullptr || std::get<StaticId>(contact.b).value < statics);
    FUZZ_EXPECT(may_travel(contact));
    points += contact.points.size();
  }
  std::vector<PlayerId> players;
  for (const Avatar& avatar : group.avatars) {
    FUZZ_EXPECT(avatar.player.value != 0 && carries(avatar.body()));
    FUZZ_EXPECT(avatar.waiting.size() <= Avatar::max_waiting);
    waiting += avatar.waiting.size();
    players.push_back(avatar.player);
  }
  std::sort(players.begin(), players.end());
  FUZZ_EXPECT(std::adjacent_find(players.begin(), players.end()) == players.end());
  // Parts of a message may not be counted again and again: memory is for what has travelled.
  FUZZ_EXPECT(points * sizeof(wire::HandoffPoint) + waiting * sizeof(wire::Command) <= size);
}

/// A message of one body whose one contact and one player are each named `times` times.
Bytes shared_parts(std::size_t times) {
  flatbuffers::FlatBufferBuilder builder;
  const std::uint64_t avatar = BodyId::avatar(PlayerId{1}).value;
  const std::vector bodies(1,
                           wire::HandoffBody(avatar, 1, 0, 0, 0, {}, {0, 0, 0, 1}, {}, {}, 0, 0));
  const std::vector points(4,
                           wire::HandoffPoint({}, {}, {0, 1, 0}, 0, 0, 0, 0, {}, {}, 0, 0, -1, -1));
  const auto contact =
      wire::CreateHandoffManifold(builder, avatar, 0, 1, 0, builder.CreateVectorOfStructs(points));
  const auto player = wire::CreateHandoffPlayer(builder, 1);
  builder.Finish(wire::CreateHandoff(builder, 7, builder.CreateVectorOfStructs(bodies),
                                     builder.CreateVector(std::vector(times, contact)),
                                     builder.CreateVector(std::vector(times, player))));
  const auto bytes = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
  return {bytes.begin(), bytes.end()};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto group = decode_handoff(payload_of(data, size), prototypes, statics);
  if (!group) {
    FUZZ_EXPECT(!group.error().message.empty());
    return 0;
  }
  check(*group, size + 7);
  // It can be handed on, and is then the same.
  const Bytes again = encode_handoff(*group);
  const auto same = decode_handoff(again, prototypes, statics);
  FUZZ_EXPECT(same && encode_handoff(*same) == again);
  return 0;
}

std::vector<Bytes> aureole_fuzz_seeds() {
  return {encode_handoff(a_group(1, 0)), encode_handoff(a_group(3, 2)),
          encode_handoff(a_group(0, 1)), encode_handoff(a_group(40, 3)), shared_parts(2000)};
}
