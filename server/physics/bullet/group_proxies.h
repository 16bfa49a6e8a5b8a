// Who of a group stands at either side of a pair, for walks over all pairs.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "server/physics/bullet/bullet_world.h"

namespace aureole {

/// Tells which sides of pairs are of a group whose bodies are marked. Pairs lie side by side in
/// memory and bodies do not: a few are told by their proxies alone.
class GroupProxies {
 public:
  explicit GroupProxies(std::span<BulletBody* const> group) : few_(group.size() <= few_max) {
    for (std::size_t i = 0; few_ && i < group.size(); ++i)
      proxies_[count_++] = group[i]->rigid.getBroadphaseHandle();
  }
  bool hold(const btBroadphaseProxy* proxy) const {
    if (few_) return std::find(proxies_.begin(), end(), proxy) != end();
    const BulletBody* body = body_of(object_of(proxy));
    return body && body->marked;
  }

 private:
  static constexpr std::size_t few_max = 8;
  std::array<const btBroadphaseProxy*, few_max>::const_iterator end() const {
    return proxies_.begin() + static_cast<std::ptrdiff_t>(count_);
  }
  std::array<const btBroadphaseProxy*, few_max> proxies_{};
  std::size_t count_ = 0;
  bool few_;
};

}  // namespace aureole
