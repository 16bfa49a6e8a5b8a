// How far each body reaches in the adaptive mode: by what it can really do in the time that counts.
#pragma once

#include "server/aura/aura_radius.h"
#include "server/aura/migration_policy.h"
#include "server/aura/overlap_grid.h"

namespace aureole {

/// Auras reach this much further than their body (m): two that touch, or nearly, are known to each
/// other even before they stir.
inline constexpr double resting_margin_m = 0.08;

/// How long from the moment that an aura is measured until the two bodies that it brings together
/// are stepped by one server (s). Two servers that both know of a pair need two flights of eq.
/// (1)'s ceil((2 T_F + T_L) / T_P) steps; one that has to ask needs three. One step more for what
/// changes while it is decided.
inline double reach_time_s(const AuraTolerances& tolerances) {
  return (3 * steps_in_flight(tolerances) + 1) * (tick_us / 1e6);
}

/// The body's box as it stands, and a little more: all that one at rest can touch.
AuraBox resting_aura(const HostedBody& body);

/// Everything that the body can touch within `reach_s` if nothing strikes it: its box swept along
/// its velocity, as far as it may fall, and aside as far as the ground may turn it.
AuraBox flight_aura(const HostedBody& body, double reach_s);

/// Everything that the body can touch within `reach_s` if it moves at up to `speed_mps` in whatever
/// direction: it may be struck, or strike.
AuraBox struck_aura(const HostedBody& body, double speed_mps, double reach_s);

}  // namespace aureole
