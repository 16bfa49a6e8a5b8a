// What strangers say first: challenges, seals, hellos and refusals, with and without a secret.
#include "server/net/links/handshake.h"
#include "protocol/wire.h"
#include "tests/fuzz/fuzz_target.h"

using namespace aureole;

namespace {

using Side = Handshake::Side;

const std::optional<Secret> secret = *Secret::from_text("the secret of this world");

PeerLinksOptions options() {
  PeerLinksOptions self;
  self.self = PeerId{0};
  self.incarnation = Incarnation{1};
  self.world_hash = 99;
  self.region_count = 4;
  return self;
}

void read(const FrameView& frame) {
  if (const auto read = read_hello(frame, options())) {
    FUZZ_EXPECT(read->peer != options().self);
    FUZZ_EXPECT(!read->peer.is_region() || read->peer.value < 4);
    FUZZ_EXPECT(read->hello.incarnation.value >= 1);
  } else {
    FUZZ_EXPECT(!read.error().message.empty());
  }
  for (const char c : read_refusal(frame).reason)
    FUZZ_EXPECT(static_cast<unsigned char>(c) >= 0x20);
}

}  // namespace

/// The first byte says which frame the rest is.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Bytes payload = payload_of(data + 1, size - 1);
  const FrameView frame{static_cast<FrameType>(data[0] % (last_frame_type + 1)), 0, payload};
  read(frame);
  for (const auto& known : {std::optional<Secret>{}, secret}) {
    Handshake dials(Side::dials, PeerId{0}, known);
    if (dials.hear_challenge(frame)) FUZZ_EXPECT(frame.type == FrameType::challenge);
    for (const Side side : {Side::dials, Side::answers}) {
      Handshake handshake(side, PeerId{0}, known);
      const auto opened = handshake.open(frame);
      // Nobody who does not know it proves anything.
      if (opened) FUZZ_EXPECT(opened->is_proven == !known.has_value());
      if (opened) read(opened->frame);
    }
  }
  return 0;
}

std::vector<Bytes> aureole_fuzz_seeds() {
  Handshake dials(Side::dials, PeerId{0}, secret), answers(Side::answers, PeerId{0}, secret);
  const SharedBytes challenge = answers.challenge();
  if (!dials.hear_challenge(*decode_frame(*challenge))) std::abort();
  PeerLinksOptions peer = options();
  peer.self = PeerId{1};
  const SharedBytes hello = make_hello(peer, Incarnation{3}, true);
  std::vector<Bytes> seeds;
  for (const SharedBytes& frame :
       {challenge, Handshake(Side::answers, PeerId{0}, {}).challenge(), hello,
        make_refusal({"no", true}), dials.seal(hello), answers.seal(hello)}) {
    const auto view = *decode_frame(*frame);
    Bytes seed{static_cast<std::byte>(view.type)};
    seed.insert(seed.end(), view.payload.begin(), view.payload.end());
    seeds.push_back(std::move(seed));
  }
  return seeds;
}
