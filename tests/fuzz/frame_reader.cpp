// FrameReader: whatever comes, however it is split, the same frames come out within the limits.
#include <algorithm>

#include "tests/fuzz/fuzz_target.h"

using namespace aureole;

namespace {

struct Outcome {
  std::vector<Frame> frames;
  bool failed = false;
};

/// Feeds `stream` in pieces of 1 + (next byte of `splits`) bytes; one piece if there are no splits.
Outcome read(std::span<const std::byte> stream, std::span<const std::byte> splits) {
  FrameReader reader;
  Outcome outcome;
  std::size_t piece = 0;
  while (!stream.empty() && !outcome.failed) {
    std::size_t length = stream.size();
    if (!splits.empty())
      length = std::min(length, 1 + std::to_integer<std::size_t>(splits[piece++ % splits.size()]));
    outcome.failed = !reader.feed(stream.first(length));
    stream = stream.subspan(length);
    while (auto frame = reader.next()) {
      FUZZ_EXPECT(!outcome.failed);
      FUZZ_EXPECT(frame->payload.size() <= max_payload_bytes && frame->payload.size() % 8 == 0);
      FUZZ_EXPECT(frame->type >= FrameType::hello &&
                  static_cast<int>(frame->type) <= last_frame_type);
      outcome.frames.push_back(std::move(*frame));
      // As a link does once it knows who is there.
      reader.set_max_payload(max_payload_bytes);
    }
  }
  if (outcome.failed) FUZZ_EXPECT(!reader.feed({}));
  return outcome;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span(data, size));
  const std::size_t split_count = std::min<std::size_t>(size, 4);
  const auto splits = input.first(split_count);
  const auto stream = input.subspan(split_count);

  const Outcome whole = read(stream, {});
  const std::byte one{0};
  for (const auto& pieces : {splits, std::span(&one, 1)}) {
    const Outcome split = read(stream, pieces);
    // An Error costs the frames before it that have not been taken; otherwise nothing differs.
    FUZZ_EXPECT(whole.failed || split.frames.size() == whole.frames.size());
    FUZZ_EXPECT(whole.frames.size() <= split.frames.size());
    for (std::size_t i = 0; i < whole.frames.size(); ++i) {
      const Frame& a = whole.frames[i];
      const Frame& b = split.frames[i];
      FUZZ_EXPECT(a.type == b.type && a.sequence == b.sequence && a.payload == b.payload);
    }
    // What came out goes back in.
    std::size_t at = 0;
    for (const Frame& frame : split.frames) {
      const Bytes again = encode_frame(frame.type, frame.sequence, frame.payload);
      FUZZ_EXPECT(at + again.size() <= stream.size());
      FUZZ_EXPECT(std::equal(again.begin(), again.end(), stream.begin() + std::ptrdiff_t(at)));
      at += again.size();
    }
  }
  return 0;
}

std::vector<Bytes> aureole_fuzz_seeds() {
  std::vector<Bytes> seeds;
  for (const std::size_t size : {0u, 8u, 64u, 1024u, 5000u}) {
    Bytes stream{std::byte{2}, std::byte{15}, std::byte{0}, std::byte{40}};
    for (int n = 0; n < 3; ++n) {
      const Bytes frame = encode_frame(static_cast<FrameType>(1 + n * 3), std::uint64_t(n),
                                       Bytes(n == 0 ? std::min<std::size_t>(size, 64) : size));
      stream.insert(stream.end(), frame.begin(), frame.end());
    }
    seeds.push_back(std::move(stream));
  }
  return seeds;
}
