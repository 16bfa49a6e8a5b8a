// A pair's name, and the order of pairs that Bullet's deterministic walk has.
#pragma once

#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <cstdint>

namespace aureole {

/// The unique ids of a pair's two proxies in one number. The highest ids come first, as in Bullet's
/// walk where `m_deterministicOverlappingPairs` is set.
class PairKey {
 public:
  PairKey() = default;
  PairKey(const btBroadphaseProxy& one, const btBroadphaseProxy& two)
      : bits_(in_order(std::min(one.m_uniqueId, two.m_uniqueId)) << 32 |
              in_order(std::max(one.m_uniqueId, two.m_uniqueId))) {}

  friend bool operator==(PairKey, PairKey) = default;
  friend bool operator<(PairKey a, PairKey b) { return a.bits_ > b.bits_; }

 private:
  /// Negative ids, which Bullet gets to after 2^31 proxies, stay below the others.
  static std::uint64_t in_order(int id) { return static_cast<std::uint32_t>(id) ^ 0x8000'0000u; }

  std::uint64_t bits_ = 0;
};

}  // namespace aureole
