// Contacts out of and into a Bullet world, with the impulses that the solver had found.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "server/physics/bullet/bullet_world.h"

namespace aureole {

/// One contact and the two Bullet objects that it is about; null where one is not in this world.
struct CarriedContact {
  btCollisionObject* a;
  btCollisionObject* b;
  const ContactManifold* manifold;
};

/// Whose contacts with a group are meant.
enum class Partners {
  within,  ///< The group's own members and static geometry.
  all,     ///< Bodies and stand-ins outside it too.
};

/// Contacts of `group`, which ascends, sorted by (a, b, ordinal). `beside_others`, if not null,
/// becomes those of the group, ascending, that make a pair with a body outside of it, whether they
/// touch or not.
std::vector<ContactManifold> extract_contacts(BulletWorld& world,
                                              std::span<BulletBody* const> group, Partners partners,
                                              std::vector<BodyId>* beside_others = nullptr);

/// Looks at all pairs of the group at once, asleep or not, as the next step would at those awake;
/// and at those that have been found since there were `pairs_before` of them, none having gone: to
/// whoever is new there are no others.
void detect_contacts(BulletWorld& world, std::span<BulletBody* const> group, int pairs_before);

/// Makes sure that each pair has been looked at, asleep or not, then replaces its points.
void install_contacts(BulletWorld& world, std::vector<CarriedContact> carried);

}  // namespace aureole
