// Which other servers are near something: at corners nobody sees everything.
#pragma once

#include <optional>
#include <vector>

#include "server/aura/adaptive/clusters.h"
#include "server/aura/adaptive/outlook/outlook.h"
#include "server/aura/audience.h"
#include "server/aura/migration_policy.h"

namespace aureole {

/// How far to look around a cluster for other servers.
struct Horizon {
  double clearance_m;     ///< Around its auras, and around its members' ways …
  double onward_s;        ///< … of so long.
  bool away_too = false;  ///< Servers that are away may be back by then: they count as well.
};

/// A cluster goes to the first server that has anything so near to it, or on its way, if that is a
/// third one: at a corner it would be fetched on to that one soon, and from there to the next.
inline constexpr Horizon near_by{1.0, 0.5};
/// So far around an aura that leaves its region others are told of it (m), if it lies at home: who
/// has something there, or its region, may be handed what the aura is about to meet, and has to
/// know of it by then. As far as `far_around` looks, and as long as a cluster may be.
inline constexpr double home_audience_m = 16;
/// Who has changed its owner within the last second goes as far as it may have to at once: it must
/// not change it more than twice.
inline constexpr Horizon far_around{8.0, 1.0};

/// The servers that have their region, or any aura, near something; ours is left out.
class Neighbourhood {
 public:
  /// Once a look; all three must outlive the questions.
  void begin(const MigrationSituation& situation, const Outlook& outlook, const Clusters& clusters);

  void add_around(const AuraBox& box, const Horizon& look, RegionSet& around) const;
  /// The same, whoever is linked or not, for those who are not in `around` yet.
  void add_others_near(const AuraBox& box, double clearance_m, RegionSet& around) const;
  void add_around(Clusters::Number cluster, const Horizon& look, RegionSet& around) const;

  /// Around a cluster, as far as it has to look: `far_around` if it has changed its owner within
  /// the last second. Found out when first asked for.
  const RegionSet& of(Clusters::Number cluster);
  /// Whether a third server is among these.
  bool is_crowded(Clusters::Number cluster);

 private:
  AuraBox room_of(std::uint32_t body, const Horizon& look) const;
  const Horizon& horizon_of(Clusters::Number cluster) const;
  std::optional<RegionSet>& known_of(Clusters::Number cluster);
  bool may_be_crowded(const Horizon& look) const;

  const MigrationSituation* situation_ = nullptr;
  const Outlook* outlook_ = nullptr;
  const Clusters* clusters_ = nullptr;
  std::vector<std::optional<RegionSet>> of_cluster_;
  /// Around all auras of each other server.
  std::vector<std::optional<AuraBox>> rooms_of_hosts_;
  std::vector<AuraBox> rooms_;  ///< Only used within is_crowded().
};

}  // namespace aureole
