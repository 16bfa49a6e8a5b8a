// One pointer a process; the parent reads only after the child's end.
#include "server/experiment/run_moment.h"

#include <fmt/format.h>

namespace aureole {
namespace {

RunMoment* shared_moment = nullptr;

}  // namespace

void share_run_moments(RunMoment* shared) {
  shared_moment = shared;
}

void note_run_moment(const RunMoment& moment) {
  if (shared_moment != nullptr) *shared_moment = moment;
}

std::string describe(const RunMoment& moment) {
  if (moment.tick < 0) return {};
  return fmt::format("at tick {}, when r{} hosted {} bodies and took its step", moment.tick,
                     moment.server, moment.bodies);
}

}  // namespace aureole
