// Remembering bodies that left, and forgetting them in time.
#include "server/region/recovery/traces.h"

namespace aureole {

void Traces::remember(const Trace& trace, Tick now) {
  kept_[trace.id] = {trace, ++last_number_};
  order_.push_back({now, trace.id, last_number_});
  while (order_.size() > capacity) drop_oldest();
}

void Traces::prune(Tick now) {
  while (!order_.empty() && now - order_.front().since > remember_ticks) drop_oldest();
}

void Traces::drop_oldest() {
  const Order oldest = order_.front();
  order_.pop_front();
  const auto it = kept_.find(oldest.id);
  if (it != kept_.end() && it->second.number == oldest.number) kept_.erase(it);
}

std::vector<Trace> Traces::all() const {
  std::vector<Trace> traces;
  traces.reserve(kept_.size());
  for (const auto& [id, kept] : kept_) traces.push_back(kept.trace);
  return traces;
}

}  // namespace aureole
