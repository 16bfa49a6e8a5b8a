// How far each body reaches in the adaptive mode: by what it can really do in the time that counts.
#pragma once

#include "server/aura/aura_radius.h"
#include "server/aura/box_rows.h"
#include "server/aura/migration_policy.h"

namespace aureole {

inline constexpr double gravity_mps2 = 9.81;

/// Auras reach this much further than their body (m): two that touch, or nearly, are known to each
/// other even before they stir.
inline constexpr double resting_margin_m = 0.08;

/// How long from the moment that an aura is measured until the two bodies that it brings together
/// are stepped by one server (s), in flights of eq. (1)'s ceil((2 T_F + T_L) / T_P) steps: one
/// until the other server hears of it, one until the arbiter hears of the other's, one until the
/// other one hears what it is asked for, one until that has come.
inline double reach_time_s(const AuraTolerances& tolerances) {
  return 4 * steps_in_flight(tolerances) * (tick_us / 1e6);
}

/// The body as it stands.
AuraCapsule room_of(const HostedBody& body);

/// The same and a little more: all that one at rest can touch.
AuraCapsule resting_aura(const HostedBody& body);

/// Everything that the body can touch within `reach_s` if nothing strikes it but the ground.
AuraCapsule flight_aura(const HostedBody& body, double reach_s);

/// The same if it may be struck, or strike, on its way, and from there get `way_m` far in whatever
/// direction; `before`: what it can touch otherwise.
AuraCapsule struck_aura(const AuraCapsule& before, double way_m, double reach_s);

/// A box around its way of the next `duration_s` if nothing strikes it: swept along its velocity,
/// as far as it may fall, and aside as far as the ground may turn it.
AuraBox way_of(const HostedBody& body, double duration_s);

}  // namespace aureole
