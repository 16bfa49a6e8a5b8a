// Affinities; see sched_setaffinity(2).
#include "server/measure/figures/own_processors.h"

namespace aureole {
namespace {

bool keep_to(pid_t process, int processor) {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<std::size_t>(processor), &one);
  return sched_setaffinity(process, sizeof(one), &one) == 0;
}

}  // namespace

OwnProcessors::OwnProcessors(std::size_t processes) {
  CPU_ZERO(&all_);
  // A machine with more processors than fit into the set is left alone.
  if (sched_getaffinity(0, sizeof(all_), &all_) != 0) return;
  std::vector<int> processors;
  for (int n = 0; n < CPU_SETSIZE; ++n)
    if (CPU_ISSET(static_cast<std::size_t>(n), &all_)) processors.push_back(n);
  if (processors.size() <= processes || !keep_to(0, processors.front())) return;
  free_.assign(processors.begin() + 1, processors.end());
}

OwnProcessors::~OwnProcessors() {
  if (CPU_COUNT(&all_) > 0) sched_setaffinity(0, sizeof(all_), &all_);
}

std::optional<int> OwnProcessors::take(pid_t process) {
  if (free_.empty() || !keep_to(process, free_.back())) return {};
  const int processor = free_.back();
  free_.pop_back();
  return processor;
}

void OwnProcessors::give_back(std::optional<int> processor) {
  if (processor) free_.push_back(*processor);
}

}  // namespace aureole
