// Challenge, hello and refusal: building them, proving them, and judging the other side's.
#include "server/net/links/handshake.h"

#include <cstring>

#include "protocol/wire.h"
#include "server/base/check.h"

namespace aureole {
namespace {

constexpr const char* same_secret = "start every server of the world with the same --secret";

std::string other_version(std::uint32_t version) {
  return fmt::format(
      "protocol version {} cannot talk to version {}: run the same release everywhere", version,
      protocol_version);
}

template <std::size_t count>
wire::Bytes32 as_wire(const std::array<std::byte, count>& bytes) {
  static_assert(count == sizeof(wire::Bytes32));
  wire::Bytes32 out;
  std::memcpy(&out, bytes.data(), count);
  return out;
}

std::array<std::byte, 32> from_wire(const wire::Bytes32& bytes) {
  std::array<std::byte, 32> out;
  std::memcpy(out.data(), &bytes, out.size());
  return out;
}

template <class Table>
SharedBytes framed(flatbuffers::FlatBufferBuilder& builder, flatbuffers::Offset<Table> root,
                   FrameType type) {
  return std::make_shared<const Bytes>(finish_frame(builder, root, type));
}

}  // namespace

SharedBytes make_hello(const PeerLinksOptions& self, Incarnation known, bool running) {
  flatbuffers::FlatBufferBuilder builder(128);
  const bool region = self.self.is_region();
  const auto id = region ? self.self.value
                         : static_cast<std::uint16_t>(self.self.value - PeerId::first_gateway);
  const auto hello = wire::CreateHello(builder, protocol_version, self.world_hash,
                                       region ? wire::Role::region : wire::Role::gateway, id,
                                       self.incarnation.value, known.value, running);
  return framed(builder, hello, FrameType::hello);
}

SharedBytes make_refusal(const Refusal& refusal) {
  flatbuffers::FlatBufferBuilder builder(128);
  const auto reason = builder.CreateString(refusal.reason.substr(0, 500));
  return framed(builder, wire::CreateRefusal(builder, reason, refusal.replaced),
                FrameType::refusal);
}

Result<Introduction> read_hello(const FrameView& frame, const PeerLinksOptions& self) {
  const auto* hello = verified<wire::Hello>(frame.payload);
  if (hello == nullptr) return Error{"the first message is not a valid hello"};
  if (hello->protocol_version() != protocol_version)
    return Error{other_version(hello->protocol_version())};
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

Refusal read_refusal(const FrameView& frame) {
  const auto* read = verified<wire::Refusal>(frame.payload);
  if (read == nullptr || read->reason() == nullptr) return {"no reason given"};
  Refusal refusal{read->reason()->str().substr(0, 500), read->replaced()};
  for (char& c : refusal.reason)
    if (c < 0x20 || c > 0x7e) c = ' ';
  return refusal;
}

std::string describe(PeerId peer) {
  return peer.is_region() ? fmt::format("region r{}", peer.value)
                          : fmt::format("gateway {}", peer.value - PeerId::first_gateway);
}

Handshake::Handshake(Side side, PeerId answering, const std::optional<Secret>& secret)
    : side_(side), answering_(answering), secret_(secret) {
  if (!secret) return;
  (side == Side::dials ? dialling_nonce_ : answering_nonce_) = random_nonce();
}

SharedBytes Handshake::challenge() const {
  AUREOLE_CHECK(side_ == Side::answers, "who is dialled asks");
  flatbuffers::FlatBufferBuilder builder(128);
  std::optional<wire::Bytes32> nonce;
  if (answering_nonce_) nonce = as_wire(*answering_nonce_);
  return framed(builder,
                wire::CreateChallenge(builder, protocol_version, nonce ? &*nonce : nullptr),
                FrameType::challenge);
}

Status Handshake::hear_challenge(const FrameView& frame) {
  AUREOLE_CHECK(side_ == Side::dials, "who dials is asked");
  if (frame.type != FrameType::challenge) return Error{"the first message is no challenge"};
  const auto* challenge = verified<wire::Challenge>(frame.payload);
  if (challenge == nullptr) return Error{"the first message is not a valid challenge"};
  if (challenge->protocol_version() != protocol_version)
    return Error{other_version(challenge->protocol_version())};
  if (challenge->nonce() != nullptr && !secret_)
    return Error::format("it asks for a secret, and this server has none: {}", same_secret);
  if (challenge->nonce() == nullptr && secret_)
    return Error::format("it has no secret, and this server has one: {}", same_secret);
  if (challenge->nonce() != nullptr) answering_nonce_ = from_wire(*challenge->nonce());
  has_heard_challenge_ = true;
  return Ok{};
}

Secret::Mac Handshake::code_of(Side sender, const Nonce& dialling, FrameType type,
                               std::span<const std::byte> payload) const {
  // All but the payload have fixed lengths. Who sends is part of it, so that no proof can be sent
  // back; and who was dialled, so that none can be passed on to another server.
  const auto number = static_cast<std::uint16_t>(type);
  const std::uint16_t to = answering_.value;
  const std::array<std::byte, 5> head{std::byte(sender == Side::dials ? 'd' : 'a'),
                                      std::byte(number & 0xff), std::byte(number >> 8),
                                      std::byte(to & 0xff), std::byte(to >> 8)};
  return secret_->mac({head, *answering_nonce_, dialling, payload});
}

SharedBytes Handshake::seal(SharedBytes frame) const {
  if (!secret_ || !answering_nonce_ || !dialling_nonce_) return frame;
  const auto inner = decode_frame(*frame);
  AUREOLE_CHECK(inner, "what is sealed is a frame of ours");
  const wire::Bytes32 mac = as_wire(code_of(side_, *dialling_nonce_, inner->type, inner->payload));
  flatbuffers::FlatBufferBuilder builder(512);
  const auto payload = builder.CreateVector(
      reinterpret_cast<const std::uint8_t*>(inner->payload.data()), inner->payload.size());
  std::optional<wire::Bytes32> nonce;
  if (side_ == Side::dials) nonce = as_wire(*dialling_nonce_);
  return framed(builder,
                wire::CreateSealed(builder, nonce ? &*nonce : nullptr,
                                   static_cast<std::uint16_t>(inner->type), payload, &mac),
                FrameType::sealed);
}

Result<Handshake::Opened> Handshake::open(const FrameView& frame) {
  if (frame.type != FrameType::sealed) {
    if (!secret_) return Opened{frame, true};
    if (frame.type == FrameType::refusal) return Opened{frame, false};
    return Error::format("it does not prove that it knows this world's secret: {}", same_secret);
  }
  if (!secret_)
    return Error::format("it proves that it knows a secret, and this server has none: {}",
                         same_secret);
  const auto* sealed = verified<wire::Sealed>(frame.payload);
  const auto expected_nonce = side_ == Side::answers;
  if (sealed == nullptr || sealed->payload() == nullptr || sealed->mac() == nullptr ||
      (sealed->nonce() != nullptr) != expected_nonce)
    return Error{"a sealed message is not valid"};
  if (!answering_nonce_) return Error{"a sealed message before the challenge"};
  const Nonce dialling =
      sealed->nonce() != nullptr ? from_wire(*sealed->nonce()) : *dialling_nonce_;
  const auto type = static_cast<FrameType>(sealed->type());
  const auto payload =
      std::as_bytes(std::span(sealed->payload()->data(), sealed->payload()->size()));
  const Side other = side_ == Side::dials ? Side::answers : Side::dials;
  if (!Secret::are_same(code_of(other, dialling, type, payload), from_wire(*sealed->mac())))
    return Error::format("it knows another secret, or took this server for another one: {}",
                         same_secret);
  // Only now: who has not proven anything gets no answer with a code.
  dialling_nonce_ = dialling;
  return Opened{Frame{type, 0, {payload.begin(), payload.end()}}, true};
}

}  // namespace aureole
