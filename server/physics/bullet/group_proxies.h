// Who of a group stands at either side of a pair, for walks over all pairs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "server/physics/bullet/bullet_world.h"

namespace aureole {

/// Tells which sides of pairs are of a group whose bodies are marked. Pairs lie side by side in
/// memory and bodies do not: a Bloom filter of one hash tells nearly all that are not of the group
/// by their addresses alone (Bloom, Space/Time Trade-offs in Hash Coding, 1970).
class GroupProxies {
 public:
  explicit GroupProxies(std::span<BulletBody* const> group) {
    if (group.size() == 1) only_ = group.front()->rigid.getBroadphaseHandle();
    for (const BulletBody* body : group) {
      const std::size_t bit = bit_of(body->rigid.getBroadphaseHandle());
      filter_[bit / 64] |= std::uint64_t{1} << bit % 64;
    }
  }
  bool hold(const btBroadphaseProxy* proxy) const {
    if (only_ != nullptr) return proxy == only_;
    const std::size_t bit = bit_of(proxy);
    if ((filter_[bit / 64] >> bit % 64 & 1) == 0) return false;
    const BulletBody* body = body_of(object_of(proxy));
    return body && body->marked;
  }

 private:
  static constexpr int bits_log2 = 12;
  static std::size_t bit_of(const btBroadphaseProxy* proxy) {
    const std::uint64_t address = reinterpret_cast<std::uintptr_t>(proxy);
    return address * 0x9E37'79B9'7F4A'7C15 >> (64 - bits_log2);  // Knuth's multiplicative hash
  }
  const btBroadphaseProxy* only_ = nullptr;  ///< If it is a group of one.
  std::array<std::uint64_t, (std::size_t{1} << bits_log2) / 64> filter_{};
};

}  // namespace aureole
