// Typed access to frame payloads: verified before they are read, framed when they are written.
#pragma once

#include <cstdint>
#include <span>

#include "generated/messages_generated.h"
#include "protocol/frame.h"

namespace aureole {

/// Sessions of players stay below this, so that the next one and the epochs that start from them
/// (region/players.cpp) never wrap around. They count quarters of seconds since 2025: 30 years.
inline constexpr std::uint32_t session_max = 0xf000'0000;

/// Ticks on the wire are at most this far from 0, so that differences of ticks never overflow.
inline constexpr std::int64_t wire_tick_max = std::int64_t{1} << 40;
inline constexpr bool is_wire_tick(std::int64_t tick) {
  return tick >= -wire_tick_max && tick <= wire_tick_max;
}

namespace detail {

/// The verifier looks at the alignment of a vector's length (4 bytes) only, while reading elements
/// that hold 64-bit numbers from an address that is not a multiple of 8 is undefined behaviour.
template <class Element>
bool is_aligned(const flatbuffers::Vector<Element>* vector) {
  return vector == nullptr || vector->size() == 0 ||
         reinterpret_cast<std::uintptr_t>(vector->Data()) % 8 == 0;
}

/// For the tables that have such vectors.
template <class Table>
bool vectors_are_aligned(const Table&) {
  return true;
}
inline bool vectors_are_aligned(const wire::Commands& t) {
  return is_aligned(t.commands());
}
inline bool vectors_are_aligned(const wire::Handoff& t) {
  if (t.players() != nullptr)
    for (const wire::HandoffPlayer* player : *t.players())
      if (!is_aligned(player->waiting())) return false;
  return is_aligned(t.bodies()) && is_aligned(t.stand_ins());
}
inline bool vectors_are_aligned(const wire::Effects& t) {
  return is_aligned(t.blasts()) && is_aligned(t.removals()) && is_aligned(t.requests());
}
inline bool vectors_are_aligned(const wire::Auras& t) {
  return is_aligned(t.auras()) && is_aligned(t.resting()) && is_aligned(t.removed()) &&
         is_aligned(t.handed_over()) && is_aligned(t.pulls());
}
inline bool vectors_are_aligned(const wire::ReplicaUpdate& t) {
  return is_aligned(t.keys()) && is_aligned(t.removed()) && is_aligned(t.players());
}
inline bool vectors_are_aligned(const wire::RegionStatus& t) {
  return is_aligned(t.outside());
}
inline bool vectors_are_aligned(const wire::RecoveryAnswer& t) {
  return is_aligned(t.traces()) && is_aligned(t.states()) && is_aligned(t.players());
}
inline bool vectors_are_aligned(const wire::Snapshot& t) {
  return is_aligned(t.injected()) && is_aligned(t.removals());
}

}  // namespace detail

/// The payload as a table, or nullptr unless every offset in it stays inside the buffer and every
/// vector is aligned. Numbers are not looked at: NaN passes the verifier, readers check what they
/// use.
template <class Table>
const Table* verified(std::span<const std::byte> payload) {
  const auto* data = reinterpret_cast<const std::uint8_t*>(payload.data());
  if (payload.size() < 8 || reinterpret_cast<std::uintptr_t>(data) % 8 != 0) return nullptr;
  flatbuffers::Verifier verifier(data, payload.size(), /*max_depth=*/16, /*max_tables=*/200'000);
  if (!verifier.VerifyBuffer<Table>(nullptr)) return nullptr;
  const Table* table = flatbuffers::GetRoot<Table>(data);
  return detail::vectors_are_aligned(*table) ? table : nullptr;
}

/// Finishes `root` and frames it.
template <class Table>
Bytes finish_frame(flatbuffers::FlatBufferBuilder& builder, flatbuffers::Offset<Table> root,
                   FrameType type, std::uint64_t sequence = 0) {
  builder.Finish(root);
  return encode_frame(type, sequence,
                      std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize())));
}

}  // namespace aureole
