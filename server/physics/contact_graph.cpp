// Edges hang on their members in lists: most members are never asked for, and nothing is sorted for
// them.
#include "server/physics/contact_graph.h"

#include <algorithm>

namespace aureole {

void ContactGraph::assign(std::size_t slots, std::span<const Edge> edges) {
  first_.assign(slots, none);
  halves_.clear();
  const auto hang = [&](std::uint32_t member, std::uint32_t partner) {
    if (member == outside) return;
    halves_.push_back({partner, first_[member]});
    first_[member] = static_cast<std::uint32_t>(halves_.size() - 1);
  };
  for (const auto& [a, b] : edges) {
    hang(a, b);
    hang(b, a);
  }
}

std::size_t ContactGraph::find_touching(std::uint32_t member,
                                        std::vector<std::uint32_t>& found) const {
  found.clear();
  std::size_t outsiders = 0;
  for (std::uint32_t at = first_[member]; at != none; at = halves_[at].next) {
    if (halves_[at].partner == outside)
      ++outsiders;
    else
      found.push_back(halves_[at].partner);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found.size() + outsiders;
}

}  // namespace aureole
