// How far each body reaches in the adaptive mode: by what it can really do in the time that counts.
#pragma once

#include "server/aura/migration_policy.h"
#include "server/aura/shapes/aura_box.h"
#include "server/aura/shapes/aura_radius.h"

namespace aureole {

inline constexpr double gravity_mps2 = 9.81;

/// Auras reach this much further than their body (m): two that touch, or nearly, are known to each
/// other even before they stir.
inline constexpr double resting_margin_m = 0.08;

/// Servers decide at every second tick, all of them at the same ones: what is said in one is heard
/// until the next, and deciding costs half.
inline constexpr std::int64_t decision_ticks = 2;

/// From one decision until what it says is heard in another one: eq. (1)'s
/// ceil((2 T_F + T_L) / T_P) steps, rounded up to the next decision.
inline std::int64_t hearing_ticks(const AuraTolerances& tolerances) {
  const auto flight = static_cast<std::int64_t>(steps_in_flight(tolerances));
  return (flight + decision_ticks - 1) / decision_ticks * decision_ticks;
}

/// Until a server hears what is made of its word.
inline std::int64_t round_trip_ticks(const AuraTolerances& tolerances) {
  return 2 * hearing_ticks(tolerances);
}

/// How long a verdict is kept, and who was near remembered: a round trip and a decision.
inline std::int64_t verdict_hold_ticks(const AuraTolerances& tolerances) {
  return round_trip_ticks(tolerances) + decision_ticks;
}

/// To spare. A request that is refused once, since the asker could not know what has come to the
/// other one meanwhile, takes one more still; with none more simulated seeds break rules.
inline constexpr std::int64_t spare_ticks = 1;

/// How long from the moment that two auras overlap until the two bodies are stepped by one server:
/// at most until the next decision; until the arbiter hears of it, until the other server hears
/// what it is asked for; and one flight until that has come. That the other server has heard of the
/// arbiter's body by then, and tells it of its own, visitor_clearance_m() sees to.
inline std::int64_t reach_ticks(const AuraTolerances& tolerances) {
  return decision_ticks - 1 + round_trip_ticks(tolerances) +
         static_cast<std::int64_t>(steps_in_flight(tolerances)) + spare_ticks;
}

/// How long before it happens a blast is told of: one flight until all have heard, then the reach
/// time, to bring together whom it will throw. Nobody has asked for any of them before, so that
/// none is refused and there is nothing to spare.
inline std::int64_t blast_lead_ticks(const AuraTolerances& tolerances) {
  return static_cast<std::int64_t>(steps_in_flight(tolerances)) + reach_ticks(tolerances) -
         spare_ticks;
}

/// The reach time (s).
inline double reach_time_s(const AuraTolerances& tolerances) {
  return static_cast<double>(reach_ticks(tolerances)) * (tick_us / 1e6);
}

/// Where three regions meet only what is faster than this (m/s), or may start at once, reckons with
/// a tick to spare: what a tick decides there is whether something comes down on sleepers. What is
/// slower makes up the heaps, and hangs together the more the further it looks ahead.
inline constexpr double spare_from_mps = 6;

/// Hosts of auras are told of what lies so near to them (m), and as far as their bodies can get in
/// the reach time (auras grow in one step when something comes in the way of a body): so far a body
/// gets while the one server hears of an aura and tells of its own.
inline double visitor_clearance_m(const AuraTolerances& tolerances) {
  return tolerances.speed_mps *
         static_cast<double>(decision_ticks - 1 + hearing_ticks(tolerances)) * (tick_us / 1e6);
}

/// The body as it stands.
AuraCapsule room_of(const HostedBody& body);

/// The same and a little more: all that one at rest can touch.
AuraCapsule resting_aura(const HostedBody& body);

/// Of two rooms that both hold all that a body can touch.
AuraCapsule smaller(const AuraCapsule& a, const AuraCapsule& b);

/// Everything that the body can touch within `reach_s` if nothing strikes it but the ground.
AuraCapsule flight_aura(const HostedBody& body, double reach_s);

/// The same if it may be struck, or strike, on its way, and from there get `way_m` far in whatever
/// direction; `before`: what it can touch otherwise.
AuraCapsule struck_aura(const HostedBody& body, const AuraCapsule& before, double way_m,
                        double reach_s);

/// A box around its way of the next `duration_s` if nothing strikes it: swept along its velocity,
/// as far as it may fall, and aside as far as the ground may turn it.
AuraBox way_of(const HostedBody& body, double duration_s);

}  // namespace aureole
