// Equations (1) to (4) of the paper: how far an aura must reach so that nothing is met unawares.
#pragma once

#include <cmath>

#include "server/base/tick.h"

namespace aureole {

/// The user-defined tolerances of section 3.3; outside of them consistency is no longer promised.
struct AuraTolerances {
  double speed_mps = 32.0;      ///< V_t
  double latency_ms = 2.0;      ///< T_L
  double frame_time_ms = 15.0;  ///< T_F
};

/// Steps that a message needs at most: ceil((2 T_F + T_L) / T_P).
inline double steps_in_flight(const AuraTolerances& t) {
  return std::ceil((2 * t.frame_time_ms + t.latency_ms) / (tick_us / 1e3));
}

/// Longest displacement time of a remote body T_R (unit: s). Source: Brown et al. 2019, eq. (1).
inline double remote_displacement_s(const AuraTolerances& t) {
  return steps_in_flight(t) * (tick_us / 1e6);
}

/// Longest displacement time of the host's body T_H (unit: s). Source: Brown et al. 2019, eq. (2).
inline double host_displacement_s(const AuraTolerances& t) {
  return remote_displacement_s(t) - tick_us / 1e6 + steps_in_flight(t) * (tick_us / 1e6);
}

/// T_T = T_R + T_H (unit: s). Source: Brown et al. 2019, eq. (3).
inline double total_displacement_s(const AuraTolerances& t) {
  return (3 * steps_in_flight(t) - 1) * (tick_us / 1e6);
}

/// Aura radius R_a = R_o + V_t * T_T (unit: m). Source: Brown et al. 2019, eq. (4).
inline double aura_radius_m(double bounding_radius_m, const AuraTolerances& t) {
  return bounding_radius_m + t.speed_mps * total_displacement_s(t);
}

}  // namespace aureole
