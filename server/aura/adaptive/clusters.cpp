// Following overlaps from body to body.
#include "server/aura/adaptive/clusters.h"

#include <algorithm>

namespace aureole {

void Clusters::begin(const MigrationSituation& situation, Outlook& outlook) {
  situation_ = &situation;
  outlook_ = &outlook;
  const auto hosted = situation.hosted;
  of_body_.assign(outlook.size(), none);
  count_ = 0;
  followers_.clear();
  for (std::uint32_t i = 0; i < hosted.size(); ++i) {
    if (hosted[i].leader == BodyId{}) continue;
    if (const auto leader = index_of(hosted, hosted[i].leader)) followers_[*leader].push_back(i);
  }
}

std::optional<Clusters::Number> Clusters::known(std::uint32_t body) const {
  if (body >= of_body_.size() || of_body_[body] == none) return {};
  return of_body_[body];
}

/// Whom a body goes with whatever their auras.
void Clusters::add_companions(std::uint32_t body, std::vector<std::uint32_t>& found) const {
  if (const auto it = followers_.find(body); it != followers_.end())
    found.insert(found.end(), it->second.begin(), it->second.end());
  if (const BodyId leader = outlook_->body(body).leader; leader != BodyId{})
    if (const auto at = index_of(situation_->hosted, leader)) found.push_back(*at);
}

Clusters::Number Clusters::of(std::uint32_t body) {
  if (const auto number = known(body)) return *number;
  const Number number = count_++;
  if (clusters_.size() == number) clusters_.emplace_back();
  clusters_[number].sent = false;
  auto& members = clusters_[number].members;
  members.assign(1, body);
  of_body_.resize(outlook_->size(), none);
  of_body_[body] = number;
  for (std::size_t k = 0; k < members.size(); ++k) {
    const std::uint32_t member = members[k];
    const auto take = [&](std::uint32_t other) {
      of_body_[other] = number;
      members.push_back(other);
    };
    found_.clear();
    outlook_->find(outlook_->box(member), found_);
    of_body_.resize(outlook_->size(), none);
    // Most that are near a member are members: their auras need not be compared again.
    for (const std::uint32_t other : found_)
      if (of_body_[other] == none && outlook_->are_company(member, other)) take(other);
    found_.clear();
    add_companions(member, found_);
    for (const std::uint32_t other : found_)
      if (of_body_[other] == none) take(other);
  }
  return number;
}

bool Clusters::has_moved(Number cluster, std::int64_t ticks) const {
  const auto& members = clusters_[cluster].members;
  return std::any_of(members.begin(), members.end(), [&](std::uint32_t member) {
    return situation_->now - outlook_->body(member).changed_owner < ticks;
  });
}

}  // namespace aureole
