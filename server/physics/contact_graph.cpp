// Edges in any order become sorted rows without repetitions.
#include "server/physics/contact_graph.h"

#include <algorithm>

namespace aureole {

void ContactGraph::assign(std::size_t members, std::span<const Edge> edges) {
  begin_.assign(members + 1, 0);
  outsiders_.assign(members, 0);
  for (const auto& [a, b] : edges) {
    if (a == outside || b == outside) {
      ++outsiders_[a == outside ? b : a];
      continue;
    }
    ++begin_[a + 1];
    ++begin_[b + 1];
  }
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  end_.assign(begin_.begin(), begin_.end() - 1);
  partners_.resize(begin_.back());
  for (const auto& [a, b] : edges) {
    if (a == outside || b == outside) continue;
    partners_[end_[a]++] = b;
    partners_[end_[b]++] = a;
  }
  for (std::size_t i = 0; i < end_.size(); ++i) {
    const auto first = partners_.begin() + begin_[i];
    const auto last = partners_.begin() + end_[i];
    std::sort(first, last);
    end_[i] = static_cast<std::uint32_t>(std::unique(first, last) - partners_.begin());
  }
}

}  // namespace aureole
