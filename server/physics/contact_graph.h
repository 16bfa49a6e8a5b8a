// Who touches whom among the bodies of one world: built in one pass, read for a few of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "server/base/ids.h"

namespace aureole {

/// Members, awake or asleep, that share at least one contact point; of others that a member touches
/// only their number counts. Static geometry is not in it. Members are named by their slots.
class ContactGraph {
 public:
  /// Of one who is no member.
  static constexpr std::uint32_t outside = static_cast<std::uint32_t>(-1);
  /// Two slots; one of them may be `outside`.
  using Edge = std::pair<std::uint32_t, std::uint32_t>;

  /// Edges come in any order and may be doubled. Keeps its memory between calls.
  /// \param slots  all that edges name are below
  void assign(std::size_t slots, std::span<const Edge> edges);

  /// Replaces `found` by the members that a member touches, ascending. Returns how many it touches,
  /// outsiders included; a compound outside may count more than once.
  std::size_t find_touching(std::uint32_t member, std::vector<std::uint32_t>& found) const;

 private:
  static constexpr std::uint32_t none = static_cast<std::uint32_t>(-1);
  struct Half {
    std::uint32_t partner;
    std::uint32_t next;  ///< Of the same member, in `halves_`; `none`: it is the last.
  };
  std::vector<std::uint32_t> first_;  ///< By slot, in `halves_`.
  std::vector<Half> halves_;
};

/// What a body of this world presses on a stand-in with.
struct StandInLoad {
  BodyId stand_in;
  BodyId body;
  float impulse_ns = 0;  ///< Sum along the normals over all points of the last step (N s).
  friend bool operator==(const StandInLoad&, const StandInLoad&) = default;
};

}  // namespace aureole
