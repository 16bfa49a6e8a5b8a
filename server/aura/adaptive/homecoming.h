// Who goes back to the region that it lies in.
#pragma once

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "server/aura/adaptive/clusters.h"
#include "server/aura/adaptive/outlook.h"
#include "server/aura/migration_policy.h"

namespace aureole {

/// What moves goes home only if it meets nothing but bodies of its new host for so long (s): it
/// would be fetched back at once, and perhaps on from there.
inline constexpr double clear_flight_s = 1.0;

class Contests;

/// A cluster of which no member reaches into the host's region, and which no projected aura
/// touches, is an island: it goes to the region that holds most of it (section 3.5 of the paper).
/// What rests goes home body by body, but only where nothing will soon pass: it would be fetched
/// back at once.
class Homecoming {
 public:
  struct Island {
    std::vector<Clusters::Number> clusters;
    RegionId home;
  };

  /// Once a tick, before islands(): remembers who stirs.
  void note_unrest(const MigrationSituation& situation, Outlook& outlook);
  /// Disjoint islands that may go home now.
  std::vector<Island> islands(const MigrationSituation& situation, Outlook& outlook,
                              Clusters& clusters, const Contests& contests);

 private:
  bool stirs(BodyId id) const;
  bool is_away(std::uint32_t body) const;
  bool is_calm(std::uint32_t body);
  void find_threats();
  bool may_leave(std::uint32_t body, bool contested);
  std::set<Clusters::Number> island_of(std::uint32_t body);
  bool flies_clear(const std::set<Clusters::Number>& island, RegionId home);

  const MigrationSituation* situation_ = nullptr;  ///< Within islands().
  Outlook* outlook_ = nullptr;
  Clusters* clusters_ = nullptr;
  bool nothing_moves_ = false;  ///< Here for quiet_ticks, nor what others project.
  /// When each body last moved or expected a blow, if lately; ascending. And as of the last tick.
  std::vector<std::pair<BodyId, Tick>> unrest_, before_;
  BoxRows threat_rows_;  ///< Built when asked for.
  std::vector<AuraBox> threats_;
  std::vector<std::uint32_t> threat_bodies_;  ///< Whose threat it is; others_body: a remote one's.
  static constexpr std::uint32_t others_body = static_cast<std::uint32_t>(-1);
  bool threats_known_ = false;
  enum class Calm : std::uint8_t { unknown, calm, threatened };
  std::vector<Calm> calm_;  ///< Of each resting body that was asked for in this tick.
};

}  // namespace aureole
