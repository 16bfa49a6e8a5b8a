// decode_commands: whatever a server says that players want, every number is within its range.
#include <cmath>

#include "protocol/wire.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/groups.h"

using namespace aureole;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto commands = decode_commands(payload_of(data, size));
  if (!commands) {
    FUZZ_EXPECT(!commands.error().message.empty());
    return 0;
  }
  FUZZ_EXPECT(commands->size() <= max_commands && commands->size() <= size / 8);
  for (const PlayerCommand& c : *commands) {
    FUZZ_EXPECT(c.player.value != 0 && c.session <= session_max && c.item <= 3);
    FUZZ_EXPECT(c.kind <= PlayerCommand::Kind::leave);
    FUZZ_EXPECT(std::abs(c.yaw) <= 1e6f && std::abs(c.pitch) <= 1.6f);
    FUZZ_EXPECT(c.target == BodyId{} || c.target.valid());
  }
  // They can be forwarded, and are then the same.
  const Bytes again = encode_commands(*commands);
  const auto same = decode_commands(again);
  FUZZ_EXPECT(same && encode_commands(*same) == again);
  return 0;
}

std::vector<Bytes> aureole_fuzz_seeds() {
  std::vector<PlayerCommand> many;
  for (std::uint32_t n = 1; n < 60; ++n) {
    many.push_back(fuzz::a_command(n, 2 * n));
    many.back().kind = static_cast<PlayerCommand::Kind>(n % 8);
  }
  return {encode_commands({}), encode_commands(std::span(many).first(1)), encode_commands(many)};
}
