// Typed access to frame payloads: verified before they are read, framed when they are written.
#pragma once

#include <span>

#include "generated/messages_generated.h"
#include "protocol/frame.h"

namespace aureole {

/// The payload as a table, or nullptr unless every offset in it stays inside the buffer. Numbers
/// are not looked at: NaN passes the verifier, readers check what they use.
template <class Table>
const Table* verified(std::span<const std::byte> payload) {
  const auto* data = reinterpret_cast<const std::uint8_t*>(payload.data());
  if (payload.size() < 8 || reinterpret_cast<std::uintptr_t>(data) % 8 != 0) return nullptr;
  flatbuffers::Verifier verifier(data, payload.size(), /*max_depth=*/16, /*max_tables=*/200'000);
  if (!verifier.VerifyBuffer<Table>(nullptr)) return nullptr;
  return flatbuffers::GetRoot<Table>(data);
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
