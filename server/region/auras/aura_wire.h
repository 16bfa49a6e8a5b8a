// How auras travel: units and flags of the wire, for those who tell and those who hear.
#pragma once

#include <cstdint>

namespace aureole::aura_wire {

/// Spines travel in steps of 1/16 m, girths in steps of 1/64 m, speeds in steps of 1/64 m/s.
inline constexpr double spine_step_m = 1.0 / 16;
inline constexpr double girth_step_m = 1.0 / 64;
inline constexpr double speed_step_mps = 1.0 / 64;
inline constexpr std::uint8_t asleep_flag = 1, resting_flag = 2, left_flag = 4;
/// Of `company`, whose lowest four bits are the size class, and the next two the changes.
inline constexpr int changes_shift = 4;
inline constexpr std::uint8_t crowded_flag = 64, lately_flag = 128;

}  // namespace aureole::aura_wire
