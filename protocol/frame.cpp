// Frames: encoding, and reading them back out of a stream.
#include "protocol/frame.h"

#include <algorithm>
#include <bit>

#include "server/base/check.h"

namespace aureole {

static_assert(std::endian::native == std::endian::little,
              "the wire is little-endian and structs are sent as they lie in memory");

namespace {

Status check_header(const FrameHeader& header, std::size_t max_payload) {
  if (header.type == 0 || header.type > last_frame_type)
    return Error::format("frame of unknown type {}; expected 1 to {}", header.type,
                         last_frame_type);
  if (header.reserved != 0)
    return Error::format("frame with reserved bits {:#x} set; expected 0", header.reserved);
  if (header.payload_bytes > max_payload)
    return Error::format("frame of {} bytes; at most {} are allowed here", header.payload_bytes,
                         max_payload);
  if (header.payload_bytes % 8 != 0)
    return Error::format("frame of {} bytes; expected a multiple of 8", header.payload_bytes);
  return Ok{};
}

/// Of the frame that `bytes` begin with, if they are enough for that; not checked yet.
std::optional<FrameHeader> read_header(std::span<const std::byte> bytes) {
  FrameHeader header;
  if (bytes.size() < sizeof header) return std::nullopt;
  std::memcpy(&header, bytes.data(), sizeof header);
  return header;
}

std::size_t size_of(const FrameHeader& header) {
  return sizeof header + header.payload_bytes;
}

/// `bytes` begin with all of it.
FrameView cut_out(const FrameHeader& header, std::span<const std::byte> bytes) {
  return {static_cast<FrameType>(header.type), header.sequence,
          bytes.subspan(sizeof header, header.payload_bytes)};
}

FrameHeader header_of(FrameType type, std::uint64_t sequence, std::size_t payload_bytes) {
  const std::size_t padded = (payload_bytes + 7) & ~std::size_t{7};
  AUREOLE_CHECK(padded <= max_payload_bytes, "senders split what does not fit a frame");
  return {static_cast<std::uint32_t>(padded), static_cast<std::uint16_t>(type), 0, sequence};
}

}  // namespace

Bytes encode_frame(FrameType type, std::uint64_t sequence, std::span<const std::byte> payload) {
  const FrameHeader header = header_of(type, sequence, payload.size());
  // Not filled with zeros first: nearly all of it is about to be written.
  Bytes bytes;
  bytes.reserve(size_of(header));
  const auto head = std::as_bytes(std::span(&header, 1));
  bytes.insert(bytes.end(), head.begin(), head.end());
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  bytes.resize(size_of(header));
  return bytes;
}

void encode_frame_into(Bytes& bytes, FrameType type, std::uint64_t sequence,
                       std::span<const std::byte> payload) {
  const FrameHeader header = header_of(type, sequence, payload.size());
  bytes.resize(size_of(header));
  const auto head = std::as_bytes(std::span(&header, 1));
  const auto behind_head = std::copy(head.begin(), head.end(), bytes.begin());
  std::fill(std::copy(payload.begin(), payload.end(), behind_head), bytes.end(), std::byte{0});
}

Result<FrameView> decode_frame(std::span<const std::byte> bytes) {
  const auto header = read_header(bytes);
  if (header)
    if (auto ok = check_header(*header, max_payload_bytes); !ok) return ok.error();
  if (!header || bytes.size() != size_of(*header))
    return Error::format("{} bytes are not exactly one frame", bytes.size());
  return cut_out(*header, bytes);
}

Status FrameReader::feed(std::span<const std::byte> data) {
  if (failed_) return Error{"the stream broke off at a bad frame before"};
  if (consumed_ > 0 && consumed_ == buffer_.size()) {
    buffer_.clear();
    consumed_ = 0;
  } else if (consumed_ > (64u << 10)) {
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(consumed_));
    consumed_ = 0;
  }
  buffer_.insert(buffer_.end(), data.begin(), data.end());

  // Headers are judged as soon as they are whole, so that an oversize frame is never waited for.
  // Behind a frame that still waits in next() only the widest limit holds: that frame may be the
  // hello which makes the reader's owner raise its own.
  auto rest = std::span<const std::byte>(buffer_).subspan(consumed_);
  std::size_t max_payload = max_payload_;
  while (const auto header = read_header(rest)) {
    if (auto ok = check_header(*header, max_payload); !ok) {
      failed_ = true;
      return ok;
    }
    if (rest.size() < size_of(*header)) break;
    rest = rest.subspan(size_of(*header));
    max_payload = std::max(max_payload_, max_payload_bytes);
  }
  return Ok{};
}

std::optional<FrameView> FrameReader::next() {
  if (failed_) return std::nullopt;
  const auto rest = std::span<const std::byte>(buffer_).subspan(consumed_);
  const auto header = read_header(rest);
  // What is longer than is allowed here feed() will call an Error.
  if (!header || header->payload_bytes > max_payload_ || rest.size() < size_of(*header))
    return std::nullopt;
  consumed_ += size_of(*header);
  return cut_out(*header, rest);
}

}  // namespace aureole
