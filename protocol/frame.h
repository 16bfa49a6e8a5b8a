// Frames: how messages between servers are cut out of a byte stream, with every length bounded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/base/result.h"

namespace aureole {

using Bytes = std::vector<std::byte>;
/// A frame that goes to several peers is built once.
using SharedBytes = std::shared_ptr<const Bytes>;

/// Refused on mismatch; grows with every change of meaning on the wire.
inline constexpr std::uint32_t protocol_version = 12;

enum class FrameType : std::uint16_t {
  hello = 1,
  refusal = 2,
  time_request = 3,
  time_reply = 4,
  acknowledge = 5,
  handoff = 6,
  commands = 7,
  effects = 8,
  replica_update = 9,
  region_status = 10,
  auras = 11,
  recovery_query = 12,
  recovery_answer = 13,
  challenge = 14,
  sealed = 15,
};
inline constexpr std::uint16_t last_frame_type = 15;

/// 16 bytes before each payload. Payloads are multiples of 8 bytes long, so that in a buffer that
/// starts aligned every FlatBuffer stays aligned.
struct FrameHeader {
  std::uint32_t payload_bytes = 0;
  std::uint16_t type = 0;
  std::uint16_t reserved = 0;  ///< 0
  std::uint64_t sequence = 0;  ///< > 0: kept by the sender until acknowledged; see region/journal.h
};
static_assert(sizeof(FrameHeader) == 16);

/// Longest payload that any peer may send; a link's first frames are held to `max_hello_bytes`.
inline constexpr std::size_t max_payload_bytes = 8u << 20;
inline constexpr std::size_t max_hello_bytes = 1024;

struct FrameView;

/// One whole frame, kept. The payload lies 8-byte aligned.
struct Frame {
  FrameType type{};
  std::uint64_t sequence = 0;
  Bytes payload;

  operator FrameView() const;
};

/// One whole frame where it lies in the bytes that came from a peer, 8-byte aligned if they are:
/// to be read before these go. Nearly all frames are read at once; whoever keeps one copies it into
/// a Frame.
struct FrameView {
  FrameType type{};
  std::uint64_t sequence = 0;
  std::span<const std::byte> payload;

  operator Frame() const { return {type, sequence, {payload.begin(), payload.end()}}; }
};

inline Frame::operator FrameView() const {
  return {type, sequence, payload};
}

/// Builds header + payload (padded to 8 bytes). The payload must not pass max_payload_bytes.
Bytes encode_frame(FrameType type, std::uint64_t sequence, std::span<const std::byte> payload);

/// The same in the place of what `bytes` held.
void encode_frame_into(Bytes& bytes, FrameType type, std::uint64_t sequence,
                       std::span<const std::byte> payload);

/// Reads back what encode_frame made; `bytes` must hold exactly one frame, and outlive the view.
Result<FrameView> decode_frame(std::span<const std::byte> bytes);

/// Cuts frames out of a stream that arrives in pieces of any size.
class FrameReader {
 public:
  explicit FrameReader(std::size_t max_payload = max_hello_bytes) : max_payload_(max_payload) {}

  /// Raised once the other side has proved who it is.
  void set_max_payload(std::size_t bytes) { max_payload_ = bytes; }

  /// Takes all of `data`; frames that are complete wait in next(). An Error (bad type, reserved
  /// bits set, oversize, payload not a multiple of 8) is final: the stream cannot be trusted any
  /// more. `max_payload` is applied to the frame that is next, so that a large frame right behind
  /// the hello is not refused before the caller could raise the limit.
  Status feed(std::span<const std::byte> data);

  /// The next whole frame, if there is one; it lies here until the next feed().
  std::optional<FrameView> next();

  /// Bytes held back for an unfinished frame.
  std::size_t pending_bytes() const { return buffer_.size() - consumed_; }

 private:
  std::size_t max_payload_;
  Bytes buffer_;
  std::size_t consumed_ = 0;
  bool failed_ = false;
};

}  // namespace aureole
