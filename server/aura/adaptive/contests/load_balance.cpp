// A line that gives way to who has less to do.
#include "server/aura/adaptive/contests/load_balance.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

/// Where nobody has as many bodies awake as this there is nothing to share out: a world that calms
/// down comes home.
constexpr double much = 128;

/// The shift for a difference of all that there is, and the longest (m).
constexpr double whole_shift_m = 300.0, shift_max_m = 12.0;

/// A difference of less than this share of what both have is none.
constexpr double even_share = 0.02;

bool are_loads(SideLoad here, SideLoad there) {
  return here.awake > 0 && there.awake > 0 && std::max(here.awake, there.awake) >= much;
}

}  // namespace

double line_shift_m(SideLoad here, SideLoad there) {
  if (!are_loads(here, there)) return 0;
  const double more = here.awake - there.awake;
  if (more > 0 ? here.contested > more : there.contested > -more) return 0;
  return std::clamp(whole_shift_m * more / (here.awake + there.awake + much), -shift_max_m,
                    shift_max_m);
}

bool stays(SideLoad here, SideLoad there) {
  const double more = here.awake - there.awake;
  if (!are_loads(here, there) || std::abs(more) <= even_share * (here.awake + there.awake))
    return here.contested >= there.contested;
  return std::abs(more + 2 * there.contested) < std::abs(more - 2 * here.contested);
}

}  // namespace aureole
