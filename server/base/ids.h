// Who is who: bodies, regions, gateways, players and the version that orders the states of one
// body.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace aureole {

/// One id type per kind of thing, passed by value; the tag keeps them from being mixed up.
template <class Tag, class Rep>
struct StrongId {
  using rep = Rep;
  Rep value{};

  constexpr StrongId() = default;
  constexpr explicit StrongId(Rep v) : value(v) {}
  friend constexpr auto operator<=>(StrongId, StrongId) = default;
};

/// A region server's number in the world file's order, 0 … 4095.
using RegionId = StrongId<struct RegionTag, std::uint16_t>;
/// A player, chosen by the gateway from the player's secret token; 0 is nobody.
using PlayerId = StrongId<struct PlayerTag, std::uint32_t>;
/// Index into the world's table of prototypes (shape + mass + material + colour), the same on all
/// servers.
using PrototypeId = StrongId<struct PrototypeTag, std::uint16_t>;
/// Index into the world's table of immovable geometry, the same on all servers.
using StaticId = StrongId<struct StaticTag, std::uint16_t>;
/// Counts the starts of one process; greater after every restart. 0 is never used.
using Incarnation = StrongId<struct IncarnationTag, std::uint64_t>;

/// Anything a region core exchanges messages with: a region (0 … 4095) or a gateway (4096 …).
struct PeerId : StrongId<struct PeerTag, std::uint16_t> {
  using StrongId::StrongId;
  static constexpr std::uint16_t first_gateway = 4096;
  static constexpr PeerId region(RegionId r) { return PeerId{r.value}; }
  static constexpr PeerId gateway(std::uint16_t n) {
    return PeerId{static_cast<std::uint16_t>(first_gateway + n)};
  }
  constexpr bool is_region() const { return value < first_gateway; }
  constexpr RegionId as_region() const { return RegionId{value}; }
};

/// A body's name, unique in the world for ever. The top byte says where the name comes from, so
/// that any server can make names without asking another one.
struct BodyId : StrongId<struct BodyTag, std::uint64_t> {
  using StrongId::StrongId;

  enum class Kind : std::uint8_t { none = 0, world = 1, injected = 2, avatar = 3, thrown = 4 };

  /// The n-th body of the world file (n from 0).
  static constexpr BodyId world(std::uint32_t n) { return make(Kind::world, n); }
  /// The n-th body that an injector made.
  static constexpr BodyId injected(std::uint16_t injector, std::uint64_t n) {
    return make(Kind::injected, (std::uint64_t{injector} << 40) | (n & 0xff'ffff'ffffu));
  }
  static constexpr BodyId avatar(PlayerId p) { return make(Kind::avatar, p.value); }
  /// The n-th thing that a player threw; n counts modulo 2^24.
  static constexpr BodyId thrown(PlayerId p, std::uint32_t n) {
    return make(Kind::thrown, (std::uint64_t{p.value} << 24) | (n & 0xff'ffffu));
  }
  constexpr Kind kind() const { return static_cast<Kind>(value >> 56); }
  /// The player of an avatar or of a thrown body; 0 for others.
  constexpr PlayerId player() const {
    if (kind() == Kind::avatar) return PlayerId{static_cast<std::uint32_t>(value)};
    if (kind() == Kind::thrown) return PlayerId{static_cast<std::uint32_t>(value >> 24)};
    return {};
  }
  /// An avatar has one name only: its player is found by it.
  constexpr bool valid() const {
    if (kind() == Kind::avatar) return player().value != 0 && *this == avatar(player());
    return kind() >= Kind::world && kind() <= Kind::thrown;
  }

 private:
  static constexpr BodyId make(Kind k, std::uint64_t rest) {
    return BodyId{(std::uint64_t{static_cast<std::uint8_t>(k)} << 56) | rest};
  }
};

/// Orders the ownerships of one body: whoever takes a body over makes the next epoch. Two owners
/// can never carry the same version, because region and incarnation are part of it; the higher one
/// wins everywhere.
struct Version {
  std::uint32_t epoch{};
  Incarnation incarnation{};
  RegionId region{};
  friend constexpr auto operator<=>(const Version&, const Version&) = default;
};

}  // namespace aureole

template <class Tag, class Rep>
struct std::hash<aureole::StrongId<Tag, Rep>> {
  std::size_t operator()(aureole::StrongId<Tag, Rep> id) const noexcept {
    return std::hash<Rep>{}(id.value);
  }
};
template <>
struct std::hash<aureole::BodyId> {
  std::size_t operator()(aureole::BodyId id) const noexcept {
    // Ids are dense in their low bits: one multiplication spreads them over the table.
    return static_cast<std::size_t>(id.value * 0x9e37'79b9'7f4a'7c15u);
  }
};
template <>
struct std::hash<aureole::PeerId> {
  std::size_t operator()(aureole::PeerId id) const noexcept { return id.value; }
};
