// Where a load that has risen came from: from something that has moved, or from nowhere.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "server/base/ids.h"
#include "server/physics/body.h"
#include "server/physics/physics_world.h"

namespace aureole {

/// A blow goes through bodies that touch within one step, and leaves none of those between in
/// motion: that what presses on a stand-in lies still says nothing. But each contact on the way
/// bears the blow. So where no way of contacts that bear enough leads to anything that has moved,
/// nothing was struck: what lies still leans on each other otherwise than a step ago.
class LoadPath {
 public:
  /// A blow may come to a body through several contacts. One that bears less than this share of
  /// what has come to the stand-in is not followed.
  static constexpr float least_share = 0.125f;
  /// Who is reached through more bodies than this may have been struck by anything.
  static constexpr std::size_t bodies_max = 64;

  /// Whether the load, of a body that lies still, has risen by `rise_ns` (N s) without a blow.
  /// What leans on nothing but the stand-in has nothing to find another balance with.
  /// `moved(body)`: whether the body may have moved in the last step or just before.
  template <class HasMoved>
  bool is_balance(const PhysicsWorld& physics, const StandInLoad& load, float rise_ns,
                  HasMoved&& moved) {
    bool leans_elsewhere = false;
    path_.assign(1, load.body);
    for (std::size_t k = 0; k < path_.size(); ++k) {
      physics.contact_loads(path_[k], loads_);
      for (const ContactLoad& contact : loads_) {
        if (k == 0 && contact.other != load.stand_in) leans_elsewhere = true;
        if (contact.stand_in || contact.impulse_ns < least_share * rise_ns) continue;
        if (std::find(path_.begin(), path_.end(), contact.other) != path_.end()) continue;
        if (path_.size() == bodies_max || moved(contact.other)) return false;
        path_.push_back(contact.other);
      }
    }
    return leans_elsewhere;
  }

 private:
  std::vector<BodyId> path_;
  std::vector<ContactLoad> loads_;
};

}  // namespace aureole
