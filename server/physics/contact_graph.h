// Who touches whom in one world, as rows of ids: built in one pass, asked as often as one likes.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "server/base/ids.h"

namespace aureole {

/// Bodies and stand-ins that share at least one contact point, awake or asleep. Static geometry is
/// not in it.
class ContactGraph {
 public:
  /// Two places in the list of ids.
  using Edge = std::pair<std::uint32_t, std::uint32_t>;

  /// `ids` ascend; edges come in any order and may be doubled. Keeps its memory between calls.
  void assign(std::span<const BodyId> ids, std::span<const Edge> edges);

  /// Everybody, ascending, whether they touch anything or not.
  std::span<const BodyId> ids() const { return ids_; }
  /// Ascending; empty for one who touches nobody or is not in the graph.
  std::span<const BodyId> touching(BodyId id) const;

 private:
  std::vector<BodyId> ids_;
  std::vector<std::uint32_t> begin_;  ///< Of each row in `partners_`.
  std::vector<std::uint32_t> end_;
  std::vector<BodyId> partners_;
};

/// What a body of this world presses on a stand-in with.
struct StandInLoad {
  BodyId stand_in;
  BodyId body;
  float impulse_ns = 0;  ///< Sum along the normals over all points of the last step (N s).
  friend bool operator==(const StandInLoad&, const StandInLoad&) = default;
};

}  // namespace aureole
