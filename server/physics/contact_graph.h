// Who touches whom among some bodies of one world, as rows of their places: built in one pass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "server/base/ids.h"

namespace aureole {

/// A group of bodies and stand-ins, awake or asleep, that share at least one contact point. Members
/// are named by their places in the group; of others a member touches only their number counts.
/// Static geometry is not in it.
class ContactGraph {
 public:
  /// Of one who is not in the group.
  static constexpr std::uint32_t outside = static_cast<std::uint32_t>(-1);
  /// Two places; one of them may be `outside`.
  using Edge = std::pair<std::uint32_t, std::uint32_t>;

  /// Edges come in any order and may be doubled. Keeps its memory between calls.
  void assign(std::size_t members, std::span<const Edge> edges);

  /// Members that a member touches, ascending.
  std::span<const std::uint32_t> touching(std::uint32_t member) const {
    return std::span(partners_).subspan(begin_[member], end_[member] - begin_[member]);
  }
  /// How many it touches, outsiders included; a compound outside may count more than once.
  std::size_t leaning_on(std::uint32_t member) const {
    return end_[member] - begin_[member] + outsiders_[member];
  }

 private:
  std::vector<std::uint32_t> begin_;  ///< Of each row in `partners_`.
  std::vector<std::uint32_t> end_;
  std::vector<std::uint32_t> partners_;
  std::vector<std::uint32_t> outsiders_;
};

/// What a body of this world presses on a stand-in with.
struct StandInLoad {
  BodyId stand_in;
  BodyId body;
  float impulse_ns = 0;  ///< Sum along the normals over all points of the last step (N s).
  friend bool operator==(const StandInLoad&, const StandInLoad&) = default;
};

}  // namespace aureole
