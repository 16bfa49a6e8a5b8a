// Near now, near a moment ago, and soon.
#include "server/aura/adaptive/visitors.h"

#include "server/aura/adaptive/homecoming.h"

namespace aureole {
namespace {

/// What rests leans on what is no further away (m).
constexpr double leaning_m = 0.1;

/// Ways of a second change little meanwhile.
constexpr std::int64_t warning_interval_ticks = 4;

}  // namespace

void Visitors::begin(const MigrationSituation& s, Outlook& outlook) {
  situation_ = &s;
  outlook_ = &outlook;
  near_.clear();
}

/// For whoever has come on the stage meanwhile.
void Visitors::make_room() {
  near_.resize(outlook_->size());
}

void Visitors::find(const RemoteAura& aura, std::vector<std::uint32_t>& found) {
  AuraBox wide = aura.room.box();
  wide.half.array() += clearance_m_ + aura.speed_mps * reach_s_;
  found.clear();
  outlook_->find(wide, found);
  make_room();
  if (found.empty()) return;
  RegionSet visitors;
  visitors.add(aura.host);
  const WorldPosition at = WorldPosition::from(wide.centre);
  if (const RegionId home = situation_->map.region_at(at.x, at.z); home != situation_->self)
    visitors.add(home);
  for (const std::uint32_t body : found) near_[body].add(visitors);
}

void Visitors::warn() {
  if (situation_->now - last_warning_ >= warning_interval_ticks) look_ahead();
  make_room();
  auto warned = warned_.begin();
  const auto hosted = situation_->hosted;
  for (std::uint32_t i = 0; i < hosted.size() && warned != warned_.end(); ++i) {
    while (warned != warned_.end() && warned->first < hosted[i].id) ++warned;
    if (warned != warned_.end() && warned->first == hosted[i].id) near_[i].add(warned->second);
  }
}

void Visitors::look_ahead() {
  last_warning_ = situation_->now;
  warned_.clear();
  if (situation_->remote.empty()) return;
  for (std::uint32_t i = 0; i < situation_->hosted.size(); ++i) {
    if (!outlook_->moves(i)) continue;
    const AuraBox way = way_of(situation_->hosted[i], clear_flight_s);
    if (!outlook_->near_others(way)) continue;
    found_.clear();
    outlook_->remote_rows().find(way, found_);
    RegionSet hosts;
    for (const std::uint32_t other : found_) hosts.add(situation_->remote[other].host);
    if (!hosts.empty()) warned_.emplace_back(situation_->hosted[i].id, hosts);
  }
}

void Visitors::note_leaving(std::span<const std::uint32_t> bodies, RegionId to) {
  found_.clear();
  for (const std::uint32_t body : bodies) {
    AuraBox wide = outlook_->box(body);
    wide.half.array() +=
        outlook_->rests(body) ? leaning_m : clearance_m_ + outlook_->expected_mps(body) * reach_s_;
    outlook_->find(wide, found_);
  }
  make_room();
  for (const std::uint32_t body : found_) near_[body].add(to);
}

/// Sleepers that nothing comes near to any more are told of until it is sure that nothing will.
void Visitors::bring_in_visited() {
  std::vector<BodyId> absent;
  const std::span<const std::uint32_t> present = outlook_->stage().ascending();
  auto at = present.begin();
  for (const Visit& visit : visits_) {
    while (at != present.end() && outlook_->body(*at).id < visit.visited) ++at;
    if (at != present.end() && outlook_->body(*at).id == visit.visited) continue;
    if (situation_->now - visit.at <= hold_ticks_) absent.push_back(visit.visited);
  }
  for (const BodyId id : absent) outlook_->stage().number_of(id);
  make_room();
}

void Visitors::remember() {
  const auto is_fresh = [&](const Visit& visit) {
    return situation_->now - visit.at <= hold_ticks_;
  };
  bring_in_visited();
  visits_before_.swap(visits_);
  visits_.clear();
  auto before = visits_before_.begin();
  for (const std::uint32_t i : outlook_->stage().ascending()) {
    const BodyId id = outlook_->body(i).id;
    near_[i].for_each([&](RegionId visitor) { visits_.push_back({id, visitor, situation_->now}); });
    while (before != visits_before_.end() && before->visited < id) ++before;
    for (; before != visits_before_.end() && before->visited == id; ++before) {
      if (near_[i].contains(before->visitor) || !is_fresh(*before)) continue;
      near_[i].add(before->visitor);
      visits_.push_back(*before);
    }
  }
}

}  // namespace aureole
