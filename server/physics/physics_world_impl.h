// What stands behind a PhysicsWorld: bodies and stand-ins by id, and the Bullet world that they are
// in. For this room's own files.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "server/physics/bullet/bullet_queries.h"
#include "server/physics/bullet/bullet_shapes.h"
#include "server/physics/bullet/bullet_world.h"
#include "server/physics/physics_world.h"

namespace aureole {

/// Ids and what is behind them, both ascending by id.
struct BodyList {
  std::vector<BodyId> ids;
  std::vector<BulletBody*> bodies;

  /// Takes in what ascends and is not here.
  void merge(std::span<BulletBody* const> sorted);
  /// Lets go of what ascends and is here.
  void leave(std::span<BulletBody* const> sorted);
};

struct PhysicsWorld::Impl {
  Impl(const PhysicsSettings& settings, std::unique_ptr<ShapeLibrary> own, ShapeLibrary& library,
       std::size_t expected_bodies);
  ~Impl();

  /// Null if there is neither a body nor a stand-in of that id.
  BulletBody* find(BodyId id) const;
  BulletBody& body(BodyId id) const;
  BulletBody& stand_in(BodyId id) const;
  BulletBody& body_or_stand_in(BodyId id) const;
  /// The objects of a list without repetitions, ascending; `get` is one of the three above.
  std::vector<BulletBody*> group_of(std::span<const BodyId> group,
                                    BulletBody& (Impl::*get)(BodyId) const) const;

  /// Makes one that is not here, in its role, and puts it into the Bullet world; no list is told.
  BulletBody* create(const NewBody& body, Role role);
  /// Takes bodies or stand-ins out of the world and of `list`.
  void destroy(BodyList& list, std::span<BulletBody* const> sorted, Wake wake);
  /// After anything that may change who touches whom or who is awake.
  void changed();

  // Bullet's world knows the bodies and the bodies the shapes: the order below is that of dying.
  std::unique_ptr<ShapeLibrary> own_shapes;  ///< Null in a scratch world.
  std::unordered_map<BodyId, std::unique_ptr<BulletBody>> by_id;
  std::vector<BulletBody*> by_slot;  ///< Of those that are taken.
  std::vector<std::uint32_t> free_slots;
  BodyList bodies;  ///< Obstacles too.
  BodyList stand_ins;
  mutable BulletWorld world;  ///< Bullet's queries are not const; they change nothing.
  mutable std::optional<std::size_t> awake_count;
  mutable bool awake_is_current = false;
  mutable AwakeBodies awake;  ///< Kept for its memory.
};

/// A list of bodies in the order of their ids.
std::vector<NewBody> sorted_by_id(std::span<const NewBody> bodies);

}  // namespace aureole
