// Edges in any order become sorted rows without repetitions.
#include "server/physics/contact_graph.h"

#include <algorithm>

namespace aureole {

void ContactGraph::assign(std::span<const BodyId> ids, std::span<const Edge> edges) {
  ids_.assign(ids.begin(), ids.end());
  begin_.assign(ids.size() + 1, 0);
  for (const auto& [a, b] : edges) {
    ++begin_[a + 1];
    ++begin_[b + 1];
  }
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  end_.assign(begin_.begin(), begin_.end() - 1);
  partners_.resize(2 * edges.size());
  for (const auto& [a, b] : edges) {
    partners_[end_[a]++] = ids_[b];
    partners_[end_[b]++] = ids_[a];
  }
  for (std::size_t i = 0; i < end_.size(); ++i) {
    const auto first = partners_.begin() + begin_[i];
    const auto last = partners_.begin() + end_[i];
    std::sort(first, last);
    end_[i] = static_cast<std::uint32_t>(std::unique(first, last) - partners_.begin());
  }
}

std::span<const BodyId> ContactGraph::touching(BodyId id) const {
  const auto found = std::lower_bound(ids_.begin(), ids_.end(), id);
  if (found == ids_.end() || *found != id) return {};
  const auto row = static_cast<std::size_t>(found - ids_.begin());
  return std::span(partners_).subspan(begin_[row], end_[row] - begin_[row]);
}

}  // namespace aureole
