// Who gets bodies that must be together and are not.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "server/aura/adaptive/clusters.h"
#include "server/aura/adaptive/contests/neighbourhood.h"
#include "server/aura/adaptive/contests/promises.h"
#include "server/aura/adaptive/outlook/aura_size.h"
#include "server/aura/adaptive/outlook/outlook.h"
#include "server/aura/adaptive/visitors.h"
#include "server/aura/audience.h"
#include "server/aura/migration_policy.h"

namespace aureole {

/// A cluster that meets auras of other servers, of which either moves, is contested. Two servers
/// never decide about the same pair:
///
///   - Between two the first in the order (precedence.h) is the arbiter. It gives both sides to
///     whoever's region the middle of what meets lies in, each side weighted by how much would have
///     to move, and the line between the two shifted towards the one with more to do; who has
///     changed its owner twice within a second stays, and so does what meets something that has
///     just been asked for, or is so near to it that the two may be one cluster by now: if it left,
///     the two would swap places. It sends its own or asks for the other's.
///     The other one tells it of its side, and waits.
///   - Where a third server is near all go to the first: around a corner nobody sees everything.
class Contests {
 public:
  explicit Contests(const AuraTolerances& tolerances) { set_tolerances(tolerances); }

  void set_tolerances(const AuraTolerances& tolerances) {
    round_trip_ticks_ = round_trip_ticks(tolerances);
    promises_.set_tolerances(tolerances);
  }

  /// Once a tick. Notes on the way who visits whom.
  void find(const MigrationSituation& situation, Outlook& outlook, Clusters& clusters,
            Visitors& visitors);

  struct Asked {
    const RemoteAura* aura;
    Company::Hold known;  ///< See HandoverRequest.
  };
  struct Verdict {
    std::vector<Clusters::Number> clusters;  ///< Ours that meet, directly or through others'.
    RegionId to;                             ///< Our own number: they stay.
    std::vector<Asked> asked;                ///< What shall come there too.
  };
  /// What becomes of the contested clusters, each once, in a fixed order.
  std::vector<Verdict> verdicts();

  /// The first server that has anything near a cluster, or on its way, if before ours.
  RegionId first_around(Clusters::Number cluster);

  /// Whether a request for a body waits: its cluster is held (Company::hold()) more firmly than who
  /// asks knew either side to be, and others have been told so. It knows now, and comes here. Both
  /// judge by what was told and what was asked, never by what the other one may see: so none comes
  /// while the other one goes.
  bool is_held_back(Clusters::Number cluster, BodyId asked_for, Company::Hold known);

  /// Who is near what, as of find().
  const Neighbourhood& neighbourhood() const { return neighbourhood_; }

  /// Whether another server's body comes here, or may be part by now of a cluster that does: who
  /// left what it meets would pass it by.
  bool may_come(const RemoteAura& aura) const { return promises_.may_come(aura); }

  /// Whether a body must be brought together with somebody else's.
  bool is_contested(std::uint32_t body) const {
    return body < contested_.size() && contested_[body] != 0;
  }
  /// Of a body whose cluster is known.
  const Company& company_of(std::uint32_t body);

 private:
  using Meetings = std::vector<const RemoteAura*>;
  /// Clusters that hang together through those of others.
  struct Contest {
    std::vector<Clusters::Number> ours;
    Meetings meets;
  };
  std::vector<Contest> joined_contests() const;
  std::uint8_t changes_of(const HostedBody& body) const;
  std::uint8_t changes_of(Clusters::Number cluster) const;
  RegionId arbitrate(const Contest& contest, RegionId other) const;
  bool may_come(const Meetings& meets) const;
  static void sort_by_id(Meetings& meets);
  Contest take_waiting(Contest& contest) const;
  Verdict conclude(const Contest& contest, RegionId to, bool crowded);
  Company::Hold hold_of(Clusters::Number cluster) const;
  Company::Hold hold_of(const std::vector<Clusters::Number>& clusters) const;
  static Company::Hold hold_of(const Meetings& meets);
  void remember(const Contest& contest, Verdict& verdict);
  bool has_moved_to(const Contest& contest, RegionId host) const;
  std::optional<RegionId> settled_host(const Contest& contest) const;
  bool meets_a_third_soon(const Contest& contest, RegionId other) const;
  void note_told(BodyId id, Company::Hold hold);

  std::int64_t round_trip_ticks_ = 0;
  const MigrationSituation* situation_ = nullptr;
  Outlook* outlook_ = nullptr;
  Clusters* clusters_ = nullptr;
  Neighbourhood neighbourhood_;
  Promises promises_;
  std::map<Clusters::Number, Meetings> meetings_;
  /// By cluster, found out when first asked for.
  std::vector<std::optional<Company>> companies_;
  /// Bodies of which others have been told that their clusters are held, and since when they have
  /// been told so in every decision; as of the one before, and of this one.
  struct Told {
    Company::Hold hold;
    Tick since;
  };
  std::map<BodyId, Told> told_held_, told_held_now_;
  Tick told_held_at_{-1'000'000};
  std::vector<std::uint8_t> contested_;  ///< By number on the stage; grows bit by bit.
  std::vector<std::uint32_t> near_;      ///< Only used within find().
};

}  // namespace aureole
