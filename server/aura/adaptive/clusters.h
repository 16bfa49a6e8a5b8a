// Which bodies go together if one of them goes.
#pragma once

#include <boost/container/small_vector.hpp>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "server/aura/adaptive/outlook/outlook.h"
#include "server/aura/migration_policy.h"

namespace aureole {

/// Everything here whose auras overlap, recursively, so that a move does not tear apart what
/// touches (section 3.4 of the paper, thrashing). A cluster ends at pairs that rest; what is
/// carried belongs to its carrier's. Found when first asked for.
class Clusters {
 public:
  using Number = std::size_t;

  /// Begins a tick; both must outlive it.
  void begin(const MigrationSituation& situation, Outlook& outlook);

  /// The cluster that a body belongs to, by the body's number on the stage.
  Number of(std::uint32_t body);
  /// The same if it has been asked for before.
  std::optional<Number> known(std::uint32_t body) const;
  std::size_t size() const { return count_; }
  std::span<const std::uint32_t> members(Number cluster) const {
    const auto& members = clusters_[cluster].members;
    return {members.data(), members.size()};
  }

  /// Whether it has been sent away in this tick.
  bool sent(Number cluster) const { return clusters_[cluster].sent; }
  void note_sent(Number cluster) { clusters_[cluster].sent = true; }

  /// Whether a body of the cluster has changed its owner within the last `ticks`.
  bool has_moved(Number cluster, std::int64_t ticks) const;

 private:
  static constexpr Number none = static_cast<Number>(-1);
  struct Cluster {
    /// Most clusters are of one or of few: they need no memory of their own.
    boost::container::small_vector<std::uint32_t, 8> members;
    bool sent = false;
  };
  void add_companions(std::uint32_t body, std::vector<std::uint32_t>& found) const;

  const MigrationSituation* situation_ = nullptr;
  Outlook* outlook_ = nullptr;
  std::vector<Number> of_body_;
  /// The first `count_` of them; the others' memory is kept. They stay where they are as more come:
  /// members() are looked at meanwhile.
  std::deque<Cluster> clusters_;
  std::size_t count_ = 0;
  std::vector<std::uint32_t> found_;  ///< Only used within of().
  std::map<std::uint32_t, std::vector<std::uint32_t>> followers_;
};

}  // namespace aureole
