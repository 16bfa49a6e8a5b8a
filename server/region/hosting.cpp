// Bodies coming into a region and leaving it, with everything that belongs to them kept in step.
#include "server/region/hosting.h"

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <limits>
#include <map>

#include "server/aura/migration_policy.h"
#include "server/base/check.h"
#include "server/base/hash.h"
#include "server/base/leap.h"
#include "server/base/prefetch.h"
#include "server/base/replace_in.h"

namespace aureole {
namespace {

/// So long ago that no policy holds a newborn body back.
constexpr Tick never_changed{-1'000'000};

/// What comes asleep has always rested; of anything else nothing is known yet.
std::optional<Tick> moved_before(const BodyState& state) {
  return state.activation == Activation::asleep ? std::optional(never_changed) : std::nullopt;
}

std::uint8_t clamped_ticks(std::int64_t ticks, std::uint8_t most) {
  return static_cast<std::uint8_t>(std::clamp<std::int64_t>(ticks, 0, most));
}

std::vector<BodyDefinition> definitions_of(const WorldDefinition& world) {
  std::vector<BodyDefinition> all;
  for (const auto& prototype : world.prototypes) all.push_back(prototype.body);
  return all;
}

std::vector<StaticDefinition> statics_of(const WorldDefinition& world) {
  std::vector<StaticDefinition> all;
  for (const auto& piece : world.statics) all.push_back(piece.body);
  return all;
}

}  // namespace

Hosting::Hosting(const WorldDefinition& world, RegionId self, Incarnation incarnation)
    : self_(self),
      incarnation_(incarnation),
      definitions_(definitions_of(world)),
      statics_(statics_of(world)),
      physics_(world.physics, definitions_, statics_, bodies_expected_by(world)) {
  for (const BodyDefinition& definition : definitions_) {
    radii_.push_back(bounding_radius(definition.shape));
    spines_.push_back(aureole::spine(definition.shape));
  }
}

/// False if there is one already; it stays.
bool Hosting::make_record(BodyId id, const Record& record) {
  if (!records_.emplace(id, record).second) return false;
  out_of_order_.push_back(id);
  return true;
}

void Hosting::erase_record(BodyId id) {
  records_.erase(id);
  out_of_order_.push_back(id);
}

/// One pass, however many have come and gone.
void Hosting::bring_in_order() {
  next_ = 0;
  expected_.clear();
  next_expected_ = 0;
  changed_.clear();
  if (out_of_order_.empty()) return;
  std::sort(out_of_order_.begin(), out_of_order_.end());
  const auto last = std::unique(out_of_order_.begin(), out_of_order_.end());
  out_of_order_.erase(last, out_of_order_.end());
  boost::container::small_vector<std::size_t, 32> gone;
  boost::container::small_vector<Entry, 32> fresh;
  auto known = in_order_.begin();
  for (const BodyId id : out_of_order_) {
    known = std::lower_bound(known, in_order_.end(), id, is_before);
    if (known != in_order_.end() && known->id == id)
      gone.push_back(static_cast<std::size_t>(known - in_order_.begin()));
    if (const auto at = records_.find(id); at != records_.end()) fresh.push_back({id, &at->second});
  }
  replace_in<Entry>(in_order_, {gone.data(), gone.size()}, {fresh.data(), fresh.size()},
                    [](const Entry& a, const Entry& b) { return a.id < b.id; });
  changed_.swap(out_of_order_);
}

const Hosting::Entry& Hosting::entry_in_order(BodyId id) {
  // Often the next one; if few are looked at, far ahead.
  const auto found =
      leap(in_order_.begin() + static_cast<std::ptrdiff_t>(next_), in_order_.end(), id, is_before);
  next_ = static_cast<std::size_t>(found - in_order_.begin());
  AUREOLE_CHECK(next_ < in_order_.size() && in_order_[next_].id == id,
                "bodies are looked at in the order of their ids");
  return in_order_[next_];
}

void Hosting::expect(BodyId id) {
  const Entry& entry = expected_.emplace_back(entry_in_order(id));
  prefetch(entry.record, sizeof(Record));
}

Hosting::Record& Hosting::next_record(BodyId id) {
  if (expected_.empty()) return *entry_in_order(id).record;
  AUREOLE_CHECK(next_expected_ < expected_.size() && expected_[next_expected_].id == id,
                "bodies are looked at as they are expected");
  return *expected_[next_expected_++].record;
}

void Hosting::spawn(std::span<const NewBody> bodies, std::uint32_t epoch) {
  std::vector<NewBody> born;
  for (const NewBody& body : bodies)
    // Another region may have handed a body of this name over: what was first stays.
    if (make_record(body.id,
                    {epoch, never_changed, moved_before(body.state), never_changed, self_}))
      born.push_back(body);
  physics_.add(born);
  find_contacts_of_sleepers(born);
  for (const NewBody& body : born) publisher_.body_gained(body.id, version(body.id));
  counts_.spawned += born.size();
}

/// They would not be looked for before the sleepers wake.
void Hosting::find_contacts_of_sleepers(std::span<const NewBody> bodies) {
  std::vector<BodyId> sleepers;
  for (const NewBody& body : bodies)
    if (body.state.activation == Activation::asleep) sleepers.push_back(body.id);
  physics_.find_contacts(sleepers);
}

void Hosting::remove(std::span<const BodyId> ids) {
  if (ids.empty()) return;
  for (BodyId id : ids) {
    removed_.push_back({id, version(id)});
    publisher_.body_removed(id, version(id));
    erase_record(id);
  }
  physics_.remove(ids);
  counts_.removed += ids.size();
}

std::span<const BodyId> Hosting::begin_look(Tick now) {
  if (now != last_look_) look_before_ = std::exchange(last_look_, now);
  bring_in_order();
  return changed_;
}

void Hosting::tell_history(const Record& record, HostedBody& body) {
  body.changed_owner = record.changed_owner;
  body.changed_owner_before = record.changed_owner_before;
  body.came_from = record.came_from;
  body.came = record.came;
}

void Hosting::look(HostedBody& body, Tick now, float slow_for_s) {
  Record& record = next_record(body.id);
  if (record.looked_at == born_now) record.came = now;
  if (record.lies) {
    record.moved = never_changed;
  } else if (record.looked_at < look_before_ || !record.moved) {
    record.moved =
        body.asleep ? never_changed : now - static_cast<std::int64_t>(slow_for_s / tick_s);
  }
  if (body.motion_speed_mps >= still_speed_mps) record.moved = now;
  record.looked_at = now;
  body.still_ticks = clamped_ticks(now - *record.moved, still_ticks_max);
  tell_history(record, body);
}

void Hosting::lie_down(HostedBody& body) {
  Record& record = records_.at(body.id);
  record.lies = true;
  body.still_ticks = still_ticks_max;
  tell_history(record, body);
}

void Hosting::wake_up(BodyId id) {
  Record& record = records_.at(id);
  record.lies = false;
  // As if it had been looked at all the time while it slept.
  record.moved = never_changed;
  record.looked_at = look_before_;
}

std::uint8_t Hosting::still_ticks(BodyId id, Tick now) const {
  const Record& record = records_.at(id);
  if (record.lies) return still_ticks_max;
  if (record.looked_at < last_look_) return physics_.is_asleep(id) ? still_ticks_max : 0;
  return clamped_ticks(now - record.moved.value_or(now), still_ticks_max);
}

namespace {

bool is_member(const HandoffGroup& group, BodyId id) {
  return std::binary_search(group.bodies.begin(), group.bodies.end(),
                            HandoffGroup::Body{{id, {}, {}}, 0, 0},
                            [](const auto& a, const auto& b) { return a.body.id < b.body.id; });
}

/// The side of the contact that is a body outside the group; none: there is none.
BodyId outsider(const HandoffGroup& group, const ContactManifold& manifold) {
  const auto* b = std::get_if<BodyId>(&manifold.b);
  if (b == nullptr) return {};
  if (!is_member(group, manifold.a)) return manifold.a;
  return is_member(group, *b) ? BodyId{} : *b;
}

}  // namespace

/// Adds what the group leans on; contacts with what moves on here are dropped.
void Hosting::bring_neighbours(HandoffGroup& group, Tick now) const {
  std::map<BodyId, NewBody> behind;
  std::erase_if(group.contacts, [&](const ContactManifold& manifold) {
    const BodyId id = outsider(group, manifold);
    if (id == BodyId{}) return false;
    if (physics_.is_stand_in(id)) {
      behind.emplace(id, physics_.stand_in(id));
    } else {
      if (!lies_still(id, now)) return true;
      behind.emplace(id, NewBody{id, physics_.prototype(id), physics_.state(id)});
    }
    return false;
  });
  for (const auto& [id, body] : behind) group.stand_ins.push_back(body);
}

Hosting::Released Hosting::release(std::span<const BodyId> ids, Tick now, Cut cut) {
  Released released;
  HandoffGroup& group = released.group;
  group.tick = now;
  for (BodyId id : ids)
    group.bodies.push_back({{id, physics_.prototype(id), physics_.state(id)},
                            epoch(id),
                            still_ticks(id, now),
                            clamped_ticks(now - changed_owner(id), owned_ticks_max)});
  std::sort(group.bodies.begin(), group.bodies.end(),
            [](const auto& a, const auto& b) { return a.body.id < b.body.id; });
  // Beside others, not only touching: Bullet loses a contact for a step now and then, and what has
  // moved by a centimetre touches.
  group.contacts = cut == Cut::at_rest ? physics_.contacts_around(ids, &released.left_behind)
                                       : physics_.contacts_within(ids);
  std::erase_if(released.left_behind, [&](BodyId id) { return !lies_still(id, now); });
  std::erase_if(group.contacts, [](const auto& manifold) { return !may_travel(manifold); });
  if (cut == Cut::at_rest) bring_neighbours(group, now);
  physics_.turn_into_stand_ins(released.left_behind);
  std::vector<BodyId> gone;
  for (const auto& b : group.bodies)
    if (!std::binary_search(released.left_behind.begin(), released.left_behind.end(), b.body.id))
      gone.push_back(b.body.id);
  physics_.remove(gone);
  for (BodyId id : ids) {
    publisher_.body_lost(id);
    erase_record(id);
  }
  counts_.migrations_out += ids.size();
  return released;
}

std::vector<BodyId> Hosting::accept(const HandoffGroup& group, RegionId from, Tick now) {
  std::vector<NewBody> taken;
  std::vector<BodyId> ids;
  for (const auto& arriving : group.bodies) {
    const BodyId id = arriving.body.id;
    if (const auto it = records_.find(id); it != records_.end()) {
      ++counts_.version_conflicts;
      if (it->second.epoch > arriving.epoch) continue;
      publisher_.body_lost(id);
      physics_.remove(std::span(&id, 1));
      erase_record(id);
    }
    taken.push_back(arriving.body);
    ids.push_back(id);
    const bool last = arriving.epoch == std::numeric_limits<std::uint32_t>::max();
    make_record(id, {last ? arriving.epoch : arriving.epoch + 1, now, now - arriving.still_ticks,
                     now - arriving.owned_ticks, from});
  }
  physics_.add(taken);
  for (BodyId id : ids) publisher_.body_gained(id, version(id));

  std::vector<ContactManifold> contacts;
  const auto is_taken = [&](BodyId id) { return std::binary_search(ids.begin(), ids.end(), id); };
  const auto is_here = [&](BodyId id) { return physics_.contains(id) || physics_.is_stand_in(id); };
  for (const auto& manifold : group.contacts) {
    const auto* other = std::get_if<BodyId>(&manifold.b);
    const bool fits = other == nullptr ? is_taken(manifold.a)
                                       : is_here(manifold.a) && is_here(*other) &&
                                             (is_taken(manifold.a) || is_taken(*other));
    if (fits) contacts.push_back(manifold);
  }
  physics_.install_contacts(contacts);
  counts_.migrations_in += ids.size();
  return ids;
}

void Hosting::claim(std::span<const HandoffGroup::Body> bodies, Tick now) {
  std::vector<NewBody> claimed;
  for (const auto& body : bodies) {
    claimed.push_back(body.body);
    make_record(body.body.id, {body.epoch, now, now - body.still_ticks, never_changed, self_});
  }
  physics_.add(claimed);
  find_contacts_of_sleepers(claimed);  // Theirs died with their owner.
  for (const NewBody& body : claimed) publisher_.body_gained(body.id, version(body.id));
  counts_.recovered += claimed.size();
}

std::uint64_t Hosting::state_hash() const {
  Hasher hasher;
  hasher.add(physics_.state_hash());
  for (BodyId id : physics_.ids()) {
    const Record& record = records_.at(id);
    hasher.add(record.epoch).add(record.changed_owner.value);
  }
  return hasher.value();
}

}  // namespace aureole
