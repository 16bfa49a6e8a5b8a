// Frames that everybody has read give their memory to those that come after them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/wire.h"

namespace aureole {

/// Makes frames that are sent in every tick and read within few. Asking for memory and giving it
/// back, in every tick anew, takes longer than writing a small frame.
///
/// Whoever holds a frame lets go of it in the thread that makes them, or in one that never runs at
/// the same time.
class FramePool {
 public:
  /// `frames` (at least 1): of so many the memory is kept; as many as are on their way at a time.
  explicit FramePool(std::size_t frames) : frames_(frames) {}

  /// As encode_frame(). Its bytes stay as they are for as long as anybody holds it.
  SharedBytes make(FrameType type, std::uint64_t sequence, std::span<const std::byte> payload);

  /// As finish_frame().
  template <class Table>
  SharedBytes finish(flatbuffers::FlatBufferBuilder& builder, flatbuffers::Offset<Table> root,
                     FrameType type) {
    builder.Finish(root);
    return make(type, 0, std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize())));
  }

  /// Longer payloads are seldom: their memory is not kept.
  static constexpr std::size_t kept_payload_max = 256u << 10;

 private:
  std::vector<std::shared_ptr<Bytes>> frames_;
  std::size_t next_ = 0;  ///< The one that was made longest ago.
};

}  // namespace aureole
