// One walk over those who are awake; whoever is not in it any more has fallen asleep or gone.
#include "server/region/view/hosted_bodies.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "server/aura/adaptive/outlook/aura_size.h"
#include "server/base/prefetch.h"

namespace aureole {

/// Everything that does not depend on time.
void HostedBodies::glimpse(const Hosting& hosting, const BodyGlance& seen, HostedBody& body) const {
  const PrototypeId prototype = seen.prototype();
  const BodyDefinition& definition = hosting.definitions()[prototype.value];
  const BodyState state = seen.state();
  const Spine& spine = hosting.spine(prototype);
  body.id = seen.id();
  body.slot = seen.slot();
  body.position = state.position;
  body.half_extents = seen.half_extents().cast<double>();
  body.bounding_radius_m = hosting.radius(prototype);
  body.half_spine = (state.orientation * spine.half).cast<double>();
  body.girth_m = double{spine.girth};
  body.lowest_m = double{spine.lowest};
  body.velocity_mps = state.linear_velocity.cast<double>();
  body.asleep = state.activation == Activation::asleep;
  if (!body.asleep)
    body.motion_speed_mps = double{motion_speed(definition.shape, state.orientation,
                                                state.linear_velocity, state.angular_velocity)};
  body.mass_kg = definition.mass_kg;
  body.restitution = definition.restitution;
  body.round = std::holds_alternative<SphereShape>(definition.shape);
}

void HostedBodies::show(Hosting& hosting, const BodyGlance& seen, const Look& look, Tick now) {
  HostedBody& body = hosted_.emplace_back();
  glimpse(hosting, seen, body);
  hosting.look(body, now, seen.slow_for_s());
  body.pressed = look.watch.is_pressed(body.id, now);
  nearby_geometry_.look(body, look.reach_s);
}

void HostedBodies::lay_down(Hosting& hosting, BodyId id) {
  sleepers_.expect_one();
  HostedBody body;
  glimpse(hosting, hosting.physics().glance(id), body);
  hosting.lie_down(body);
  nearby_geometry_.look(body, 0);  // It is not going anywhere.
  sleepers_.put(body);
}

/// `changed`: came or went since the last decision. Nobody moves asleep: whoever lies elsewhere
/// than it did has been awake, or has come again.
void HostedBodies::keep_sleepers(Hosting& hosting, std::span<const BodyId> changed) {
  for (const BodyId id : changed) {
    sleepers_.take(id);
    if (hosting.hosts(id) && hosting.physics().is_asleep(id)) lay_down(hosting, id);
  }
  prefetch_beginning(awake_);
  const std::span<const NewBody> awake = hosting.physics().awake();
  awake_now_.resize(awake.size());
  std::transform(awake.begin(), awake.end(), awake_now_.begin(),
                 [](const NewBody& body) { return body.id; });
  auto now = awake_now_.begin(), before = awake_.begin();
  while (true) {
    // Most that were awake are: from one that is not in both lists to the next.
    std::tie(now, before) = std::mismatch(now, awake_now_.end(), before, awake_.end());
    if (before != awake_.end() && (now == awake_now_.end() || *before < *now)) {
      const BodyId fallen_asleep = *before++;
      if (hosting.hosts(fallen_asleep) && !sleepers_.place_of(fallen_asleep))
        lay_down(hosting, fallen_asleep);
    } else if (now != awake_now_.end()) {
      const BodyId woken = *now++;
      if (sleepers_.take(woken)) hosting.wake_up(woken);
    } else {
      break;
    }
  }
  awake_.swap(awake_now_);
  sleepers_.settle();
}

void HostedBodies::move_home(const PartitionMap& map, RegionId self, double margin_m) {
  strip_ = BoundaryStrip(map, self);
  sleepers_.move_home(map.area(self).inner(margin_m));
}

void HostedBodies::begin(Hosting& hosting, bool apart, Tick now) {
  apart_ = apart;
  const std::span<const BodyId> changed = hosting.begin_look(now);
  if (apart_) keep_sleepers(hosting, changed);
}

void HostedBodies::show_within(double depth_m, std::span<const RemoteAura> remote) {
  shows_all_ = !std::isfinite(depth_m);
  if (!shows_all_) strip_.note(remote, depth_m);
}

/// Names them first, so that what is known of them comes near while they are looked at.
void HostedBodies::find_shown(Hosting& hosting, const Look& look) {
  shown_.clear();
  const auto expect = [&](BodyId id, std::size_t n) {
    shown_.push_back({id, n});
    hosting.expect(id);
  };
  auto stirred = look.stirred.begin();
  const auto expect_sleeper = [&](BodyId id) {
    const auto place = sleepers_.place_of(id);
    if (place && (shows_all_ || strip_.holds(sleepers_.body(*place).position))) expect(id, sleeps);
  };
  auto asked_for = look.asked_for.begin();
  const std::span<const NewBody> awake = hosting.physics().awake();
  for (std::size_t n = 0; n < awake.size(); ++n) {
    const BodyId id = awake[n].id;
    while (stirred != look.stirred.end() && *stirred < id) expect_sleeper(*stirred++);
    while (asked_for != look.asked_for.end() && *asked_for < id) ++asked_for;
    const bool is_asked_for = asked_for != look.asked_for.end() && *asked_for == id;
    if (shows_all_ || is_asked_for || strip_.holds(awake[n].state.position)) expect(id, n);
  }
  while (stirred != look.stirred.end()) expect_sleeper(*stirred++);
}

std::vector<HostedBody>& HostedBodies::look(Hosting& hosting, const Look& look, Tick now) {
  hosted_.clear();
  const PhysicsWorld& physics = hosting.physics();
  if (!apart_) {
    physics.for_each([&](const BodyGlance& seen) { show(hosting, seen, look, now); });
    return hosted_;
  }
  hosting.begin_look(now);  // Each look in a tick begins at the first body.
  find_shown(hosting, look);
  hosted_.reserve(shown_.size());
  for (const Shown& shown : shown_) {
    // What has just been written is read again at once, which waits until its line is here.
    constexpr std::size_t ahead = 2;
    if (hosted_.size() + ahead < shown_.size())
      prefetch(hosted_.data() + hosted_.size() + ahead, sizeof(HostedBody));
    show(hosting,
         shown.awake == sleeps ? physics.glance(shown.id) : physics.awake_glance(shown.awake), look,
         now);
  }
  return hosted_;
}

}  // namespace aureole
