// The number that tells one start of a process from the next.
#pragma once

#include "server/base/ids.h"

namespace aureole {

/// Wall-clock time now (µs since 1970): grows from start to start as long as nobody sets the clock
/// back; whoever does passes --incarnation by hand.
Incarnation incarnation_of_this_start();

}  // namespace aureole
