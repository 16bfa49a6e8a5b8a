// Bodies that sleep, kept as they lay down: what nothing comes near to costs a decision no look.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "server/aura/migration_policy.h"
#include "server/aura/partition/partition_map.h"
#include "server/aura/shapes/aura_capsule.h"
#include "server/aura/shapes/box_rows.h"
#include "server/base/ids.h"
#include "server/base/prefetch.h"

namespace aureole {

/// Most of a world sleeps most of the time. Whoever hosts sleeping bodies puts them here when they
/// fall asleep and takes them out when they wake or go; in between they neither move nor change,
/// and decisions find those that matter by where they lie. Who comes or goes costs one pass over
/// their boxes a tick.
class Sleepers {
 public:
  /// Names a sleeper while it is here.
  using Place = std::uint32_t;

  /// `home`: the area of the region whose bodies these are.
  explicit Sleepers(const Rectangle& home) : home_(home) {}

  /// From now on the region ends there. One pass over all who are here.
  void move_home(const Rectangle& home);

  /// Before somebody is put here: has the memory that it will take come nearer.
  void expect_one() const {
    if (!free_.empty()) prefetch(&sleepers_[free_.back()], sizeof(Sleeper));
  }
  /// One that is here already is put where it lies now. Its own aura is resting_aura().
  void put(const HostedBody& body);
  /// False: it is not here.
  bool take(BodyId id);
  /// Call after put() and take(), before rows() is asked.
  void settle() { rows_.settle(); }

  std::size_t size() const { return by_id_.size(); }
  std::optional<Place> place_of(BodyId id) const;
  const HostedBody& body(Place place) const { return sleepers_[place].body; }
  const AuraCapsule& aura(Place place) const { return sleepers_[place].aura; }
  /// Around the aura.
  const AuraBox& box(Place place) const { return sleepers_[place].box; }
  /// Has its body's name, its aura and its box come nearer, for who is going to look at several.
  void fetch(Place place) const {
    const Sleeper& sleeper = sleepers_[place];
    prefetch(&sleeper.body.id);
    prefetch(&sleeper.aura, sizeof(Sleeper) - offsetof(Sleeper, aura));
  }

  /// The boxes around their auras, by place.
  const BoxRows& rows() const { return rows_; }
  /// Those whose auras reach out of the region; in no order that means anything.
  std::span<const Place> beyond() const { return beyond_; }

 private:
  static constexpr std::uint32_t not_beyond = static_cast<std::uint32_t>(-1);
  static constexpr std::uint32_t nobody = static_cast<std::uint32_t>(-2);
  struct Sleeper {
    HostedBody body;
    AuraCapsule aura;
    AuraBox box;
    std::uint32_t beyond = nobody;  ///< Its place in `beyond_`; `nobody`: this place is free.
  };

  void note_whether_beyond(Place place);

  Rectangle home_;
  std::vector<Sleeper> sleepers_;
  std::vector<Place> free_;
  std::unordered_map<BodyId, Place> by_id_;
  BoxRows rows_;
  std::vector<Place> beyond_;
};

}  // namespace aureole
