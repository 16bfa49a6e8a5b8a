// Who goes back to the region that it lies in.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "server/aura/adaptive/clusters.h"
#include "server/aura/adaptive/outlook/aura_size.h"
#include "server/aura/adaptive/outlook/outlook.h"
#include "server/aura/migration_policy.h"

namespace aureole {

/// Who is on the way of what moves within so long (s) is told of it, and a row that it will strike
/// is not cut.
inline constexpr double clear_flight_s = 1.0;

class Contests;

/// What lies outside of its host's region goes home (section 3.5 of the paper) where nobody would
/// fetch it back at once: all that would soon meet each other together, a pocket, and only if
/// nothing of it soon meets what stays here, or what is hosted by a third server. A server that has
/// less to do keeps what lies near to it (line_shift_m()).
class Homecoming {
 public:
  void set_tolerances(const AuraTolerances& tolerances) {
    news_ticks_ = verdict_hold_ticks(tolerances);
  }

  struct Pocket {
    std::vector<Clusters::Number> clusters;
    RegionId home;
  };

  /// Once a tick, before pockets(): remembers who stirs.
  void note_unrest(const MigrationSituation& situation, Outlook& outlook);
  /// Disjoint pockets that may go home now.
  std::vector<Pocket> pockets(const MigrationSituation& situation, Outlook& outlook,
                              Clusters& clusters, const Contests& contests);

 private:
  bool stirs(BodyId id) const;
  RegionId belongs_to(std::uint32_t body) const;
  bool is_away(std::uint32_t body) const;
  AuraBox room_of(std::uint32_t body) const;
  static AuraBox room_of(const RemoteAura& aura, double duration_s);
  const BoxRows& stirrer_rows();
  const BoxRows& blow_rows();
  enum class Link : std::uint8_t { leaning, touching };
  bool may_lean(std::uint32_t a, std::uint32_t b) const;
  bool is_threatened(std::uint32_t body, Link link);
  bool may_leave(std::uint32_t body, bool contested);
  RegionId home_of(Clusters::Number cluster) const;
  bool is_met_there(const RemoteAura& aura, RegionId home) const;
  bool add_met(std::uint32_t body, RegionId home, std::vector<std::uint32_t>& met);
  bool look_around(Clusters::Number cluster, RegionId home, std::vector<std::uint32_t>& met);
  std::uint32_t& pocket_at(Clusters::Number cluster);
  std::vector<Clusters::Number> pocket_of(Clusters::Number first, RegionId home);

  std::int64_t news_ticks_ = 0;
  const MigrationSituation* situation_ = nullptr;  ///< Within pockets().
  Outlook* outlook_ = nullptr;
  Clusters* clusters_ = nullptr;
  const Contests* contests_ = nullptr;
  bool nothing_moves_ = false;  ///< Here for quiet_ticks, nor what others project.
  /// When each body last moved or expected a blow, if lately; ascending. And as of the last tick.
  std::vector<std::pair<BodyId, Tick>> unrest_, before_;
  /// What does not rest, here and elsewhere.
  struct Stirrer {
    std::uint32_t ours = 0;             ///< On the stage, if nobody else's.
    const RemoteAura* other = nullptr;  ///< Of another server's.
  };
  std::vector<Stirrer> stirrers_;
  BoxRows stirrer_rows_;  ///< Rooms of each of them, once they have been asked for.
  /// Ways of those whose blows would go on through a row, further ahead; the same.
  BoxRows blow_rows_;
  bool stirrers_known_ = false, blows_known_ = false;
  std::vector<AuraBox> rooms_;  ///< Only used while either is built.
  enum class Heap : std::uint8_t { unknown, calm, threatened };
  /// What each resting body that was asked for hangs together with, by how.
  std::array<std::vector<Heap>, 2> heaps_;
  static constexpr std::uint32_t no_pocket = 0;
  std::vector<std::uint32_t> judged_;  ///< The pocket of each cluster that has been found.
  std::uint32_t pockets_ = no_pocket;
  std::vector<std::uint32_t> found_, met_;  ///< Kept for their memory.
};

}  // namespace aureole
