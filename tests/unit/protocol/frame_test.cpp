// Frames out of a stream: cut anywhere, judged early, never trusted.
#include "protocol/frame.h"

#include <cstdint>
#include <random>

#include "tests/support/catch.h"

using namespace aureole;

namespace {

Bytes payload_of(std::size_t size, unsigned seed) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 7 + seed);
  return bytes;
}

struct Expected {
  FrameType type;
  std::uint64_t sequence;
  Bytes payload;
};

/// Small and large, empty ones too.
std::vector<Expected> some_frames() {
  std::vector<Expected> frames;
  unsigned n = 1;
  for (std::size_t size : {8u, 0u, 24u, 64u, 0u, 8u, 16u}) {
    frames.push_back({static_cast<FrameType>(n), n * 1'000'000'007ull, payload_of(size, n)});
    ++n;
  }
  return frames;
}

Bytes stream_of(const std::vector<Expected>& frames) {
  Bytes stream;
  for (const auto& f : frames) {
    const Bytes bytes = encode_frame(f.type, f.sequence, f.payload);
    stream.insert(stream.end(), bytes.begin(), bytes.end());
  }
  return stream;
}

void take_all(FrameReader& reader, std::vector<Frame>& frames) {
  while (auto frame = reader.next()) frames.push_back(std::move(*frame));
}

bool are_same(const std::vector<Frame>& frames, const std::vector<Expected>& expected) {
  if (frames.size() != expected.size()) return false;
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (frames[i].type != expected[i].type || frames[i].sequence != expected[i].sequence ||
        frames[i].payload != expected[i].payload)
      return false;
  return true;
}

Bytes header_bytes(const FrameHeader& header) {
  Bytes bytes(sizeof header);
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

}  // namespace

TEST_CASE("A frame comes back as it was encoded, padded with zeros to 8 bytes") {
  const Bytes payload = payload_of(13, 5);
  const Bytes bytes = encode_frame(FrameType::handoff, 77, payload);
  REQUIRE(bytes.size() == 32);
  const auto frame = decode_frame(bytes);
  REQUIRE(frame);
  CHECK(frame->type == FrameType::handoff);
  CHECK(frame->sequence == 77);
  Bytes padded = payload;
  padded.resize(16);
  CHECK(Frame(*frame).payload == padded);
}

TEST_CASE("The header lies on the wire as WIRE_FORMAT.md says") {
  const Bytes bytes = encode_frame(FrameType::commands, 0x0102030405060708u, payload_of(8, 0));
  const std::uint8_t expected[16] = {8, 0, 0, 0, 7, 0, 0, 0, 8, 7, 6, 5, 4, 3, 2, 1};
  for (int i = 0; i < 16; ++i) CHECK(std::to_integer<int>(bytes[i]) == expected[i]);
}

TEST_CASE("decode_frame takes exactly one frame") {
  Bytes bytes = encode_frame(FrameType::hello, 0, payload_of(8, 1));
  CHECK_FALSE(decode_frame({}));
  CHECK_FALSE(decode_frame(std::span(bytes).first(bytes.size() - 1)));
  const Bytes again = bytes;
  bytes.insert(bytes.end(), again.begin(), again.end());
  CHECK_FALSE(decode_frame(bytes));
}

TEST_CASE("A stream of frames may be split in two anywhere") {
  const auto expected = some_frames();
  const Bytes stream = stream_of(expected);
  for (std::size_t split = 0; split <= stream.size(); ++split) {
    FrameReader reader;
    std::vector<Frame> frames;
    REQUIRE(reader.feed(std::span(stream).first(split)));
    take_all(reader, frames);
    REQUIRE(reader.feed(std::span(stream).subspan(split)));
    take_all(reader, frames);
    REQUIRE(are_same(frames, expected));
    REQUIRE(reader.pending_bytes() == 0);
  }
}

TEST_CASE("A stream of frames may come byte by byte, taken at once or at the end") {
  const auto expected = some_frames();
  const Bytes stream = stream_of(expected);
  for (const bool at_once : {true, false}) {
    FrameReader reader;
    std::vector<Frame> frames;
    for (const std::byte b : stream) {
      REQUIRE(reader.feed({&b, 1}));
      if (at_once) take_all(reader, frames);
    }
    take_all(reader, frames);
    REQUIRE(are_same(frames, expected));
  }
}

TEST_CASE("A long stream in pieces of any size comes out whole, and the buffer does not grow") {
  std::mt19937 random(1);
  std::vector<Expected> expected;
  for (int i = 0; i < 400; ++i)
    expected.push_back({static_cast<FrameType>(1 + i % last_frame_type), std::uint64_t(i),
                        payload_of(8 * (random() % 400), random())});
  const Bytes stream = stream_of(expected);
  REQUIRE(stream.size() > 300'000);
  FrameReader reader(8 * 400);
  std::vector<Frame> frames;
  for (std::size_t at = 0; at < stream.size();) {
    const std::size_t piece = std::min<std::size_t>(1 + random() % 9000, stream.size() - at);
    REQUIRE(reader.feed(std::span(stream).subspan(at, piece)));
    take_all(reader, frames);
    REQUIRE(reader.pending_bytes() < 8 * 400 + sizeof(FrameHeader));
    at += piece;
  }
  REQUIRE(are_same(frames, expected));
}

TEST_CASE("Payloads lie aligned to 8 bytes") {
  const Bytes stream = stream_of(some_frames());
  FrameReader reader;
  REQUIRE(reader.feed(stream));
  while (auto frame = reader.next())
    CHECK(reinterpret_cast<std::uintptr_t>(frame->payload.data()) % 8 == 0);
}

TEST_CASE("A bad header is refused before any of its payload has come") {
  const FrameHeader good{8, 1, 0, 0};
  REQUIRE(FrameReader().feed(header_bytes(good)));
  const auto refused = [](const FrameHeader& header) {
    FrameReader reader;
    const Status status = reader.feed(header_bytes(header));
    return !status && !reader.next();
  };
  CHECK(refused({8, 0, 0, 0}));
  CHECK(refused({8, last_frame_type + 1, 0, 0}));
  CHECK(refused({8, 0xffff, 0, 0}));
  CHECK(refused({8, 1, 1, 0}));
  CHECK(refused({8, 1, 0x8000, 0}));
  for (std::uint32_t odd = 1; odd < 8; ++odd) CHECK(refused({odd, 1, 0, 0}));
  CHECK(refused({max_hello_bytes + 8, 1, 0, 0}));
  CHECK(refused({0xffff'fff8u, 1, 0, 0}));
}

TEST_CASE("A header is judged as soon as its last byte is there, not before") {
  const Bytes bad = header_bytes({8, 99, 0, 0});
  FrameReader reader;
  for (std::size_t i = 0; i + 1 < bad.size(); ++i) REQUIRE(reader.feed({&bad[i], 1}));
  CHECK_FALSE(reader.feed({&bad.back(), 1}));
}

TEST_CASE("The first frame is held to the hello's length, later ones to the limit that is set") {
  const Bytes longest_hello = encode_frame(FrameType::hello, 0, Bytes(max_hello_bytes));
  const Bytes large = encode_frame(FrameType::handoff, 1, Bytes(100'000));
  FrameReader reader;
  REQUIRE(reader.feed(longest_hello));
  REQUIRE(reader.next());
  reader.set_max_payload(100'000);
  REQUIRE(reader.feed(large));
  CHECK(reader.next()->payload.size() == 100'000);
  CHECK_FALSE(reader.feed(encode_frame(FrameType::handoff, 1, Bytes(100'008))));
}

TEST_CASE("A large frame right behind the hello waits until the limit has been raised") {
  Bytes stream = encode_frame(FrameType::hello, 0, Bytes(64));
  const Bytes large = encode_frame(FrameType::handoff, 1, Bytes(100'000));
  stream.insert(stream.end(), large.begin(), large.end());
  SECTION("raised after the hello") {
    FrameReader reader;
    REQUIRE(reader.feed(stream));
    CHECK(reader.next()->type == FrameType::hello);
    reader.set_max_payload(max_payload_bytes);
    CHECK(reader.next()->type == FrameType::handoff);
  }
  SECTION("never raised: the large frame does not come out, and the next byte is an Error") {
    FrameReader reader;
    REQUIRE(reader.feed(stream));
    CHECK(reader.next()->type == FrameType::hello);
    CHECK_FALSE(reader.next());
    CHECK_FALSE(reader.feed(Bytes(1)));
  }
  SECTION("too large for any limit: refused at once, wherever it stands") {
    Bytes endless = encode_frame(FrameType::hello, 0, Bytes(64));
    const Bytes header = header_bytes({max_payload_bytes + 8, 6, 0, 1});
    endless.insert(endless.end(), header.begin(), header.end());
    CHECK_FALSE(FrameReader().feed(endless));
  }
}

TEST_CASE("After an Error the reader stays shut, even for good frames") {
  FrameReader reader;
  REQUIRE_FALSE(reader.feed(header_bytes({8, 99, 0, 0})));
  CHECK_FALSE(reader.feed(encode_frame(FrameType::hello, 0, Bytes(8))));
  CHECK_FALSE(reader.next());
}

TEST_CASE("Garbage never gets a frame past the limits") {
  std::mt19937 random(7);
  int refused = 0;
  for (int run = 0; run < 2000; ++run) {
    Bytes garbage(64);
    for (std::byte& b : garbage) b = static_cast<std::byte>(random() % (run % 2 ? 256 : 3));
    FrameReader reader;
    if (!reader.feed(garbage)) ++refused;
    while (auto frame = reader.next()) {
      REQUIRE(frame->payload.size() <= max_hello_bytes);
      REQUIRE(static_cast<int>(frame->type) <= last_frame_type);
    }
  }
  CHECK(refused > 1900);
}
