// A line that gives way to who has less to do.
#include "server/aura/adaptive/load_balance.h"

#include <algorithm>

namespace aureole {
namespace {

/// Fewer bodies awake than this make no difference.
constexpr double little = 64;

/// The shift for a difference of all that there is, and the longest (m).
constexpr double whole_shift_m = 300.0, shift_max_m = 12.0;

/// Who has fewer awake than this has little to do and lends nothing: a world that calms down comes
/// home.
constexpr double much = 128;

}  // namespace

double line_shift_m(SideLoad here, SideLoad there) {
  if (here.awake <= 0 || there.awake <= 0) return 0;
  const double more = here.awake - there.awake;
  if (more > 0 ? here.contested > more : there.contested > -more) return 0;
  return std::clamp(whole_shift_m * more / (here.awake + there.awake + 2 * little), -shift_max_m,
                    shift_max_m);
}

double lent_m(double awake_here, double awake_there) {
  return awake_here < much ? 0 : std::max(0.0, line_shift_m({awake_here, 0}, {awake_there, 0}));
}

}  // namespace aureole
