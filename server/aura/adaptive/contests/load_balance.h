// How evenly two servers are loaded, and what follows from it for the line between them.
#pragma once

namespace aureole {

/// What a server has to do, and what it would give away.
struct SideLoad {
  double awake = 0;      ///< All bodies that it has awake, about; 0: nothing has been heard of it.
  double contested = 0;  ///< Those among them that one of the two is to have, about.
};

/// How far the line between two regions is shifted into that of `here`, whose clusters go to the
/// other side there (m); negative: the other way. It follows the difference between the two, up to
/// 12 m: who is given more of a heap along the boundary hosts it farther from home, and keeps it
/// there (homecoming.h). 0 where so many bodies would turn the difference around, and while neither
/// has much to do.
///
/// Contests look at it only where two meet. Where three do, all go to the one that comes first in
/// the order of the servers (precedence.h).
double line_shift_m(SideLoad here, SideLoad there);

/// Of two sides that are held alike, whether that of `here` stays and the other one comes to it: so
/// that the two servers come nearer to having as much to do, or are no further apart than they
/// must be. While they differ by a few hundredths, or have little, the larger side stays.
bool stays(SideLoad here, SideLoad there);

}  // namespace aureole
