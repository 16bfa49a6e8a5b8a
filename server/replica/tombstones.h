// Bodies that were removed on purpose, so that states of them which come late do not bring them
// back.
#pragma once

#include <cstdint>
#include <deque>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/base/ids.h"

namespace aureole {

/// Remembers the newest `capacity` removals.
class Tombstones {
 public:
  static constexpr std::size_t default_capacity = 65'536;
  explicit Tombstones(std::size_t capacity = default_capacity) : capacity_(capacity) {}

  /// The body was removed at this version; the highest one counts.
  void remember(BodyId id, const Version& version);
  /// Whether a state of this version is of a body that has been removed since.
  bool covers(BodyId id, const Version& version) const;
  std::size_t size() const { return graves_.size(); }
  /// Ascending by body.
  std::vector<std::pair<BodyId, Version>> all() const;

 private:
  struct Grave {
    Version version;
    std::uint64_t number = 0;
  };
  struct Removal {
    BodyId id;
    std::uint64_t number = 0;
  };

  std::size_t capacity_;
  std::uint64_t last_number_ = 0;
  std::unordered_map<BodyId, Grave> graves_;
  std::deque<Removal>
      removals_;  ///< Oldest first; those with another number than the grave's are past.
};

}  // namespace aureole
