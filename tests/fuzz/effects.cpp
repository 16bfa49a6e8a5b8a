// decode_effects: what hostile players' regions do to all bodies is within the limits of a game.
#include <cmath>

#include "protocol/quantise.h"
#include "protocol/wire.h"
#include "server/region/players/effects.h"
#include "tests/fuzz/fuzz_target.h"

using namespace aureole;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto effects = decode_effects(payload_of(data, size));
  if (!effects) {
    FUZZ_EXPECT(!effects.error().message.empty());
    return 0;
  }
  for (const BlastEffect& blast : effects->blasts) {
    FUZZ_EXPECT(blast.position.vector().cwiseAbs().maxCoeff() <= 2 * position_limit_m);
    FUZZ_EXPECT(blast.radius_m > 0 && blast.radius_m <= 1000);
    FUZZ_EXPECT(std::abs(blast.speed_mps) <= 1000);
    FUZZ_EXPECT(is_wire_tick(blast.tick.value));
  }
  for (const BodyId id : effects->removals) FUZZ_EXPECT(id.kind() == BodyId::Kind::thrown);
  for (const BodyRequest& request : effects->requests)
    FUZZ_EXPECT(request.body.valid() && request.player.value != 0);
  for (const std::size_t count :
       {effects->blasts.size(), effects->removals.size(), effects->requests.size()})
    FUZZ_EXPECT(count <= EffectsMessage::max_of_a_kind && count <= size / 8);
  // It can be written down, and is then the same.
  const Bytes again = encode_effects(*effects);
  const auto same = decode_effects(again);
  FUZZ_EXPECT(same && encode_effects(*same) == again);
  return 0;
}

std::vector<Bytes> aureole_fuzz_seeds() {
  EffectsMessage blast, rest, all;
  blast.blasts.push_back({1, Tick{5}, {1, 2, 3}, 9, 13, BodyId::avatar(PlayerId{1})});
  rest.removals.push_back(BodyId::thrown(PlayerId{1}, 7));
  rest.requests.push_back({BodyId::world(3), PlayerId{1}});
  for (std::uint32_t n = 1; n < 100; ++n) {
    all.blasts.push_back({n, Tick{n}, {n * 1.0, 0, 0}, 9, -13, {}});
    all.removals.push_back(BodyId::thrown(PlayerId{n}, n));
    all.requests.push_back({BodyId::injected(1, n), PlayerId{n}});
  }
  return {encode_effects({}), encode_effects(blast), encode_effects(rest), encode_effects(all)};
}
