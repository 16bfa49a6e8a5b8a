// Hello and refusal: building them, and judging the other side's.
#include "server/net/links/handshake.h"

#include "protocol/wire.h"

namespace aureole {

SharedBytes make_hello(const PeerLinksOptions& self, Incarnation known, bool running) {
  flatbuffers::FlatBufferBuilder builder(128);
  const bool region = self.self.is_region();
  const auto id = region ? self.self.value
                         : static_cast<std::uint16_t>(self.self.value - PeerId::first_gateway);
  const auto hello = wire::CreateHello(builder, protocol_version, self.world_hash,
                                       region ? wire::Role::region : wire::Role::gateway, id,
                                       self.incarnation.value, known.value, running);
  return std::make_shared<const Bytes>(finish_frame(builder, hello, FrameType::hello));
}

SharedBytes make_refusal(const std::string& reason) {
  flatbuffers::FlatBufferBuilder builder(128);
  const auto refusal = wire::CreateRefusal(builder, builder.CreateString(reason.substr(0, 500)));
  return std::make_shared<const Bytes>(finish_frame(builder, refusal, FrameType::refusal));
}

Result<Introduction> read_hello(const FrameView& frame, const PeerLinksOptions& self) {
  const auto* hello = verified<wire::Hello>(frame.payload);
  if (hello == nullptr) return Error{"the first message is not a valid hello"};
  if (hello->protocol_version() != protocol_version)
    return Error::format(
        "protocol version {} cannot talk to version {}: run the same release everywhere",
        hello->protocol_version(), protocol_version);
  if (hello->world_hash() != self.world_hash)
    return Error::format(
        "it simulates another world than {}: start every server with the same world file and "
        "--regions",
        describe(self.self));
  if (hello->incarnation() == 0) return Error{"incarnation 0 in a hello; expected at least 1"};
  if (hello->id() >= PeerId::first_gateway)
    return Error::format("server number {} in a hello; expected less than {}", hello->id(),
                         PeerId::first_gateway);
  if (hello->role() == wire::Role::region && hello->id() >= self.region_count)
    return Error::format("region r{} in a hello; this world has {} regions", hello->id(),
                         self.region_count);
  const PeerId peer = hello->role() == wire::Role::region ? PeerId::region(RegionId{hello->id()})
                                                          : PeerId::gateway(hello->id());
  if (hello->role() != wire::Role::region && hello->role() != wire::Role::gateway)
    return Error::format("unknown role {} in a hello", static_cast<int>(hello->role()));
  if (peer == self.self)
    return Error::format("{} was started twice, or dials itself", describe(peer));
  return Introduction{peer,
                      {Incarnation{hello->incarnation()}, Incarnation{hello->known_incarnation()},
                       hello->running()}};
}

std::string read_refusal(const FrameView& frame) {
  const auto* refusal = verified<wire::Refusal>(frame.payload);
  if (refusal == nullptr || refusal->reason() == nullptr) return "no reason given";
  std::string reason = refusal->reason()->str().substr(0, 500);
  for (char& c : reason)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return reason;
}

std::string describe(PeerId peer) {
  return peer.is_region() ? fmt::format("region r{}", peer.value)
                          : fmt::format("gateway {}", peer.value - PeerId::first_gateway);
}

}  // namespace aureole
