// Payloads that were cut short, bent or shifted: refused, or read without leaving the buffer.
#include "protocol/wire_values.h"

#include <cstring>

#include "tests/support/catch.h"

using namespace aureole;

namespace {

template <class Table>
Bytes payload_of(flatbuffers::FlatBufferBuilder& builder, flatbuffers::Offset<Table> root) {
  const Bytes frame = finish_frame(builder, root, FrameType::replica_update);
  return {frame.begin() + sizeof(FrameHeader), frame.end()};
}

Bytes a_replica_update() {
  flatbuffers::FlatBufferBuilder b;
  const wire::ReplicaKey key(1, {}, 1, 0, 0, {1, 2, 3}, {0, 0, 0, 1}, {}, {}, 0);
  const auto keys = b.CreateVectorOfStructs(&key, 1);
  const wire::ReplicaMotion motion;
  const auto motions = b.CreateVectorOfStructs(&motion, 1);
  const wire::ReplicaRemoved removed(2, {});
  const auto all_removed = b.CreateVectorOfStructs(&removed, 1);
  const wire::PlayerStatus player(1, 2, 3, true, 0);
  const auto players = b.CreateVectorOfStructs(&player, 1);
  return payload_of(b, wire::CreateReplicaUpdate(b, 9, true, keys, motions, all_removed, players));
}

Bytes a_handoff() {
  flatbuffers::FlatBufferBuilder b;
  const wire::HandoffBody body;
  const auto bodies = b.CreateVectorOfStructs(&body, 1);
  const wire::HandoffPoint point;
  const auto points = b.CreateVectorOfStructs(&point, 1);
  const std::vector manifolds{wire::CreateHandoffManifold(b, 1, 2, 3, 4, points)};
  const wire::Command command(1, 2, 3, wire::CommandKind::blast, 0, 0, 0, 0, 0, 0, 0);
  const auto waiting = b.CreateVectorOfStructs(&command, 1);
  const std::vector players{
      wire::CreateHandoffPlayer(b, 1, 2, 3, 4, true, 5, 6, 7, 8, 9, 10, 11, 12, waiting)};
  const auto all_manifolds = b.CreateVector(manifolds);
  const auto all_players = b.CreateVector(players);
  const wire::Resting resting;
  const auto stand_ins = b.CreateVectorOfStructs(&resting, 1);
  return payload_of(b, wire::CreateHandoff(b, 9, bodies, all_manifolds, all_players, stand_ins));
}

Bytes some_effects() {
  flatbuffers::FlatBufferBuilder b;
  const wire::Blast blast;
  const auto blasts = b.CreateVectorOfStructs(&blast, 1);
  const auto removals = b.CreateVector(std::vector<std::uint64_t>{1, 2, 3});
  const wire::BodyRequest request(1, 2);
  const auto requests = b.CreateVectorOfStructs(&request, 1);
  return payload_of(b, wire::CreateEffects(b, blasts, removals, requests));
}

/// Reads everything there is; the sum, which is kept here, hinders the compiler from leaving it
/// out.
volatile double kept = 0;

template <class Vector, class Read>
double each(const Vector* vector, Read read) {
  double sum = 0;
  if (vector != nullptr)
    for (const auto* element : *vector) sum += read(*element);
  return sum;
}
double read_all(const wire::ReplicaUpdate& u) {
  return double(u.tick()) + u.complete() +
         each(u.keys(),
              [](auto& k) {
                return double(k.id()) + k.slot() + k.position().z() + k.deactivation_time_s();
              }) +
         each(u.motions(), [](auto& m) { return double(slot_of(m)) + m.orientation()->Get(5); }) +
         each(u.removed(),
              [](auto& r) { return double(r.id()) + double(r.version().incarnation()); }) +
         each(u.players(), [](auto& p) { return double(p.player()) + double(p.carried()); });
}
double read_all(const wire::Handoff& h) {
  return double(h.tick()) +
         each(h.bodies(), [](auto& k) { return double(k.id()) + k.position().z(); }) +
         each(h.manifolds(),
              [](auto& m) {
                return double(m.a()) + m.ordinal() +
                       each(m.points(), [](auto& p) { return double(p.child_b()) + p.impulse(); });
              }) +
         each(h.players(), [](auto& p) {
           return double(p.player()) + double(p.carried()) +
                  each(p.waiting(), [](auto& c) { return double(c.target()) + c.pitch(); });
         });
}
double read_all(const wire::Effects& e) {
  double sum = each(e.blasts(), [](auto& b) { return double(b.id()) + b.position().y(); }) +
               each(e.requests(), [](auto& r) { return double(r.body()) + r.player(); });
  if (e.removals() != nullptr)
    for (const std::uint64_t id : *e.removals()) sum += double(id);
  return sum;
}

/// Every length (the sanitizers see any read outside), every bit and some bytes flipped.
template <class Table>
void mistreat(const Bytes& good) {
  REQUIRE(verified<Table>(good) != nullptr);
  double sum = read_all(*verified<Table>(good));
  for (std::size_t length = 0; length < good.size(); ++length) {
    const Bytes cut(good.begin(), good.begin() + std::ptrdiff_t(length));
    if (const auto* table = verified<Table>(cut)) sum += read_all(*table);
  }
  int refused = 0;
  for (std::size_t at = 0; at < good.size(); ++at)
    for (const int change : {1, 2, 4, 8, 16, 32, 64, 128, 255}) {
      Bytes bent = good;
      bent[at] ^= static_cast<std::byte>(change);
      if (const auto* table = verified<Table>(bent)) {
        sum += read_all(*table);
      } else {
        ++refused;
      }
    }
  CHECK(refused > 0);
  kept = sum;
}

/// A table with one vector of one element, all zeros, by hand, as no builder makes it: the vtable
/// at 8, the table behind it, the vector's length at `length_at`, its element behind that.
Bytes with_vector(flatbuffers::voffset_t field, std::size_t length_at, std::size_t element_bytes) {
  constexpr std::size_t vtable = 8;
  const std::size_t vtable_bytes = field + 2u, table = (vtable + vtable_bytes + 3) / 4 * 4;
  Bytes bytes((length_at + 4 + element_bytes + 7) / 8 * 8);
  const auto put = [&](std::size_t at, auto number) {
    std::memcpy(bytes.data() + at, &number, sizeof(number));
  };
  put(0, static_cast<std::uint32_t>(table));  // root
  put(vtable, static_cast<std::uint16_t>(vtable_bytes));
  put(vtable + 2, std::uint16_t{8});      // how long the table is
  put(vtable + field, std::uint16_t{4});  // where in it the vector is named
  put(table, static_cast<std::int32_t>(table - vtable));
  put(table + 4, static_cast<std::uint32_t>(length_at - (table + 4)));
  put(length_at, std::uint32_t{1});
  return bytes;
}

}  // namespace

TEST_CASE("The structs of the wire have the sizes that WIRE_FORMAT.md states") {
  static_assert(sizeof(FrameHeader) == 16);
  static_assert(sizeof(wire::HandoffBody) == 88 && alignof(wire::HandoffBody) == 8);
  static_assert(sizeof(wire::HandoffPoint) == 88 && alignof(wire::HandoffPoint) == 4);
  static_assert(sizeof(wire::Command) == 48 && alignof(wire::Command) == 8);
  static_assert(sizeof(wire::Blast) == 56 && alignof(wire::Blast) == 8);
  static_assert(sizeof(wire::Aura) == 40 && alignof(wire::Aura) == 8);
  static_assert(sizeof(wire::AuraMotion) == 22 && alignof(wire::AuraMotion) == 2);
  static_assert(sizeof(wire::Resting) == 56 && alignof(wire::Resting) == 8);
  static_assert(sizeof(wire::BodyRequest) == 16 && alignof(wire::BodyRequest) == 8);
  static_assert(sizeof(wire::ReplicaVersion) == 16 && alignof(wire::ReplicaVersion) == 8);
  static_assert(sizeof(wire::ReplicaKey) == 104 && alignof(wire::ReplicaKey) == 8);
  static_assert(sizeof(wire::ReplicaMotion) == 18 && alignof(wire::ReplicaMotion) == 1);
  static_assert(sizeof(wire::ReplicaRemoved) == 24 && alignof(wire::ReplicaRemoved) == 8);
  static_assert(sizeof(wire::PlayerStatus) == 24 && alignof(wire::PlayerStatus) == 8);
  SUCCEED("checked when this was compiled");
}

TEST_CASE("A ReplicaUpdate that was cut or bent is refused or read inside its buffer") {
  mistreat<wire::ReplicaUpdate>(a_replica_update());
}
TEST_CASE("A Handoff that was cut or bent is refused or read inside its buffer") {
  mistreat<wire::Handoff>(a_handoff());
}
TEST_CASE("Effects that were cut or bent are refused or read inside their buffer") {
  mistreat<wire::Effects>(some_effects());
}

TEST_CASE("A payload that does not lie at a multiple of 8 is refused") {
  const Bytes good = some_effects();
  Bytes shifted(good.size() + 8);
  std::copy(good.begin(), good.end(), shifted.begin() + 4);
  CHECK(verified<wire::Effects>(std::span(shifted).subspan(4, good.size())) == nullptr);
  CHECK(verified<wire::Effects>(good) != nullptr);
}

TEST_CASE("A vector whose elements do not lie at multiples of 8 is refused") {
  const Bytes effects = with_vector(wire::Effects::VT_REMOVALS, 28, 8);
  REQUIRE(verified<wire::Effects>(effects) != nullptr);
  REQUIRE(verified<wire::Effects>(effects)->removals()->size() == 1);
  CHECK(verified<wire::Effects>(with_vector(wire::Effects::VT_REMOVALS, 24, 8)) == nullptr);

  constexpr std::size_t mark = sizeof(wire::ToleranceMark);
  const Bytes status = with_vector(wire::RegionStatus::VT_OUTSIDE, 60, mark);
  REQUIRE(verified<wire::RegionStatus>(status) != nullptr);
  REQUIRE(verified<wire::RegionStatus>(status)->outside()->size() == 1);
  CHECK(verified<wire::RegionStatus>(with_vector(wire::RegionStatus::VT_OUTSIDE, 64, mark)) ==
        nullptr);
}
