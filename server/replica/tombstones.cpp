// Remembering removals, and forgetting the oldest.
#include "server/replica/tombstones.h"

#include <algorithm>

namespace aureole {

void Tombstones::remember(BodyId id, const Version& version) {
  if (covers(id, version)) return;
  graves_[id] = {version, ++last_number_};
  removals_.push_back({id, last_number_});
  while (removals_.size() > capacity_) {
    const Removal oldest = removals_.front();
    removals_.pop_front();
    const auto grave = graves_.find(oldest.id);
    if (grave != graves_.end() && grave->second.number == oldest.number) graves_.erase(grave);
  }
}

bool Tombstones::covers(BodyId id, const Version& version) const {
  const auto grave = graves_.find(id);
  return grave != graves_.end() && version <= grave->second.version;
}

std::vector<std::pair<BodyId, Version>> Tombstones::all() const {
  std::vector<std::pair<BodyId, Version>> all;
  for (const auto& [id, grave] : graves_) all.emplace_back(id, grave.version);
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace aureole
