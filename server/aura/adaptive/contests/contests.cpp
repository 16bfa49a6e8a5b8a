// Contested clusters, and the arbiter's rule.
#include "server/aura/adaptive/contests/contests.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "server/aura/adaptive/contests/load_balance.h"
#include "server/aura/adaptive/outlook/aura_size.h"

namespace aureole {
namespace {

/// What is given to who comes later in the order may have to go back again: where a third server is
/// so near, also one that is away and may be back, all go to the first of the two; who has changed
/// its owner within the last second does so sooner.
constexpr Horizon back_near{8.0, 1.0, true};
constexpr Horizon back_near_again{32.0, 1.0, true};

std::uint8_t size_class_of(std::size_t bodies) {
  const int power = std::bit_width(std::max<std::size_t>(bodies, 1)) - 1;
  return static_cast<std::uint8_t>(std::min(power, int{Company::size_class_max}));
}

/// Of the body that its cluster was found from: whichever that is.
std::uint16_t label_of(BodyId body) {
  const std::uint64_t mixed = body.value * 0x9E37'79B9'7F4A'7C15;  // Knuth's multiplicative hash
  return static_cast<std::uint16_t>(std::max<std::uint64_t>(mixed >> 48, 1));
}

}  // namespace

void Contests::find(const MigrationSituation& s, Outlook& outlook, Clusters& clusters,
                    Visitors& visitors) {
  situation_ = &s;
  outlook_ = &outlook;
  clusters_ = &clusters;
  meetings_.clear();
  companies_.clear();
  if (s.now != told_held_at_) {  // A tick may be looked at twice: see MigrationDecision.
    told_held_.swap(told_held_now_);
    told_held_now_.clear();
    told_held_at_ = s.now;
  }
  contested_.clear();
  promises_.begin(s);
  neighbourhood_.begin(s, outlook, clusters);
  for (const RemoteAura& aura : s.remote) {
    visitors.find(aura, near_);
    contested_.resize(outlook.size(), 0);
    for (const std::uint32_t body : near_) {
      if ((outlook.rests(body) && aura.resting) || !overlap(aura.room, outlook.aura(body)))
        continue;
      contested_[body] = 1;
      Meetings& meets = meetings_[clusters.of(body)];
      if (meets.empty() || meets.back() != &aura) meets.push_back(&aura);
    }
  }
}

std::uint8_t Contests::changes_of(const HostedBody& body) const {
  const bool once = situation_->now - body.changed_owner < long_stay_ticks;
  const bool twice = situation_->now - body.changed_owner_before < long_stay_ticks;
  return twice ? 2 : once ? 1 : 0;
}

std::uint8_t Contests::changes_of(Clusters::Number cluster) const {
  std::uint8_t most = 0;
  for (const std::uint32_t member : clusters_->members(cluster))
    most = std::max(most, changes_of(outlook_->body(member)));
  return most;
}

RegionId Contests::first_around(Clusters::Number cluster) {
  const RegionSet& others = neighbourhood_.of(cluster);
  const Precedence& order = situation_->order;
  return others.empty() ? situation_->self : order.first(order.first(others), situation_->self);
}

const Company& Contests::company_of(std::uint32_t body) {
  const Clusters::Number cluster = clusters_->of(body);
  if (companies_.size() <= cluster) companies_.resize(clusters_->size());
  if (!companies_[cluster]) {
    Company& company = companies_[cluster].emplace();
    company.label = label_of(outlook_->body(clusters_->members(cluster).front()).id);
    company.size_class = size_class_of(clusters_->members(cluster).size());
    company.changes = changes_of(cluster);
    company.crowded = neighbourhood_.is_crowded(cluster);
    company.lately = hold_of(cluster) >= Company::Hold::lately_come;
  }
  if (const Company::Hold hold = companies_[cluster]->hold(); hold != Company::Hold::none)
    note_told(outlook_->body(body).id, hold);
  return *companies_[cluster];
}

void Contests::note_told(BodyId id, Company::Hold hold) {
  const auto known = told_held_.find(id);
  const bool is_news = known == told_held_.end() || known->second.hold != hold;
  told_held_now_.try_emplace(id, Told{hold, is_news ? situation_->now : known->second.since});
}

Company::Hold Contests::hold_of(Clusters::Number cluster) const {
  Company::Hold most = Company::Hold::none;
  for (const std::uint32_t member : clusters_->members(cluster)) {
    const HostedBody& body = outlook_->body(member);
    if (changes_of(body) == Company::changes_max) return Company::Hold::changed_twice;
    if (situation_->now - body.changed_owner < round_trip_ticks_) most = Company::Hold::lately_come;
  }
  return most;
}

Company::Hold Contests::hold_of(const std::vector<Clusters::Number>& clusters) const {
  Company::Hold most = Company::Hold::none;
  for (const Clusters::Number cluster : clusters) most = std::max(most, hold_of(cluster));
  return most;
}

Company::Hold Contests::hold_of(const Meetings& meets) {
  Company::Hold most = Company::Hold::none;
  for (const RemoteAura* aura : meets) most = std::max(most, aura->company.hold());
  return most;
}

bool Contests::is_held_back(Clusters::Number cluster, BodyId asked_for, Company::Hold known) {
  const auto told = told_held_.find(asked_for);
  Company::Hold hold = hold_of(cluster);
  // What must not change its owner again waits though nobody has been told so yet.
  if (hold == Company::Hold::changed_twice)
    note_told(asked_for, hold);
  else if (told == told_held_.end())
    return false;
  else
    hold = told->second.hold;
  const auto now_told = told_held_now_.find(asked_for);
  const Tick since = now_told != told_held_now_.end() ? now_told->second.since : told->second.since;
  // Nobody was told of it when what the asker had heard by then was said; from then on all know.
  const std::int64_t unknown_ticks = round_trip_ticks_ - decision_ticks;
  return known < hold && situation_->now - since <= unknown_ticks;
}

/// Each once.
void Contests::sort_by_id(Meetings& meets) {
  std::sort(meets.begin(), meets.end(), [](const auto* a, const auto* b) { return a->id < b->id; });
  meets.erase(std::unique(meets.begin(), meets.end()), meets.end());
}

/// Those that meet the same body of others', or bodies of one cluster of others', are one. Disjoint
/// sets: each points on towards the last of its set, which takes in all of it.
std::vector<Contests::Contest> Contests::joined_contests() const {
  std::vector<Contest> contests;
  std::vector<std::pair<BodyId, std::size_t>> by_body;
  std::vector<std::pair<std::pair<RegionId, std::uint16_t>, std::size_t>> by_cluster;  // Others'.
  for (const auto& [cluster, meets] : meetings_) {
    if (clusters_->sent(cluster)) continue;
    for (const RemoteAura* aura : meets) {
      by_body.emplace_back(aura->id, contests.size());
      if (aura->company.label != 0)
        by_cluster.push_back({{aura->host, aura->company.label}, contests.size()});
    }
    contests.push_back({{cluster}, meets});
  }
  std::vector<std::size_t> onward(contests.size());
  std::iota(onward.begin(), onward.end(), std::size_t{0});
  const auto last_of = [&](std::size_t at) {
    while (onward[at] != at) at = onward[at] = onward[onward[at]];
    return at;
  };
  const auto join_same = [&](auto& places) {
    std::sort(places.begin(), places.end());
    for (std::size_t n = 1; n < places.size(); ++n) {
      if (places[n - 1].first != places[n].first) continue;
      const std::size_t a = last_of(places[n - 1].second), b = last_of(places[n].second);
      onward[std::min(a, b)] = std::max(a, b);
    }
  };
  join_same(by_body);
  join_same(by_cluster);
  for (std::size_t at = 0; at < contests.size(); ++at) {
    if (last_of(at) == at) continue;
    const Contest joined = std::exchange(contests[at], {});
    Contest& all = contests[last_of(at)];
    all.ours.insert(all.ours.end(), joined.ours.begin(), joined.ours.end());
    all.meets.insert(all.meets.end(), joined.meets.begin(), joined.meets.end());
  }
  std::erase_if(contests, [](const Contest& contest) { return contest.ours.empty(); });
  for (Contest& contest : contests) {
    std::sort(contest.ours.begin(), contest.ours.end());
    sort_by_id(contest.meets);
  }
  return contests;
}

/// Whether any of it comes here, or may have become part by now of a cluster that does.
bool Contests::may_come(const Meetings& meets) const {
  return std::any_of(meets.begin(), meets.end(),
                     [&](const RemoteAura* aura) { return promises_.may_come(*aura); });
}

/// Takes from a contest those of our clusters that meet what comes here, and whom they meet.
Contests::Contest Contests::take_waiting(Contest& contest) const {
  Contest waiting, going;
  for (const Clusters::Number cluster : contest.ours) {
    const Meetings& meets = meetings_.at(cluster);
    Contest& part = may_come(meets) ? waiting : going;
    part.ours.push_back(cluster);
    part.meets.insert(part.meets.end(), meets.begin(), meets.end());
  }
  sort_by_id(going.meets);
  sort_by_id(waiting.meets);
  contest = std::move(going);
  return waiting;
}

RegionId Contests::arbitrate(const Contest& contest, RegionId other) const {
  const RegionId self = situation_->self;
  std::uint8_t our_changes = 0, their_changes = 0;
  bool has_come = false, gave = false;
  Eigen::Vector3d theirs(0, 0, 0), ours(0, 0, 0);
  std::map<std::uint16_t, double> their_clusters;
  for (const RemoteAura* aura : contest.meets) {
    theirs += aura->room.centre / static_cast<double>(contest.meets.size());
    double& weight = their_clusters[aura->company.label];
    weight = std::max(weight, static_cast<double>(1 << aura->company.size_class));
    their_changes = std::max(their_changes, aura->company.changes);
    if (const Promises::Promise* given = promises_.of(aura->id)) gave |= given->to == other;
  }
  double meeting = 0, our_weight = 0, their_weight = 0;
  for (const auto& [label, weight] : their_clusters) their_weight += weight;
  their_weight = std::max(their_weight, static_cast<double>(contest.meets.size()));
  for (const Clusters::Number cluster : contest.ours) {
    our_changes = std::max(our_changes, changes_of(cluster));
    our_weight += 1 << size_class_of(clusters_->members(cluster).size());
    for (const std::uint32_t member : clusters_->members(cluster)) {
      if (!is_contested(member)) continue;
      ours += outlook_->body(member).position.vector();
      if (const Promises::Promise* given = promises_.of(outlook_->body(member).id)) {
        has_come |= given->to == self;
        gave |= given->to == other;
      }
      ++meeting;
    }
  }
  ours /= meeting;
  // What is held stays.
  const Company::Hold our_hold = hold_of(contest.ours), their_hold = hold_of(contest.meets);
  if (our_hold != their_hold) return our_hold > their_hold ? self : other;
  // What has been given is followed; what has been asked for stays here, or is about to come.
  if (gave && !has_come) return other;
  if (has_come || may_come(contest.meets)) return self;
  // Who has changed its owner more often stays.
  if (our_changes != their_changes) return our_changes > their_changes ? self : other;
  const std::span<const double> awake = situation_->awake;
  const SideLoad here{awake.empty() ? 0 : awake[self.value], our_weight};
  const SideLoad there{awake.empty() ? 0 : awake[other.value], their_weight};
  if (our_hold != Company::Hold::none) return stays(here, there) ? self : other;
  const Eigen::Vector3d middle =
      (ours * our_weight + theirs * their_weight) / (our_weight + their_weight);
  const auto distance = [&](RegionId region) {
    return situation_->map.area(region).distance(middle.x(), middle.z());
  };
  return distance(other) - distance(self) < line_shift_m(here, there) ? other : self;
}

/// Whether a side of it has come to that server within the last second.
bool Contests::has_moved_to(const Contest& contest, RegionId host) const {
  if (host == situation_->self)
    return std::any_of(contest.ours.begin(), contest.ours.end(),
                       [&](Clusters::Number cluster) { return changes_of(cluster) > 0; });
  return std::any_of(contest.meets.begin(), contest.meets.end(), [&](const RemoteAura* aura) {
    return aura->host == host && aura->company.changes > 0;
  });
}

/// The lowest server whose side has changed its owner as often as it should: not the first, for it
/// must not go on when the order changes.
std::optional<RegionId> Contests::settled_host(const Contest& contest) const {
  RegionSet settled;
  for (const RemoteAura* aura : contest.meets)
    if (aura->company.changes == Company::changes_max) settled.add(aura->host);
  for (const Clusters::Number cluster : contest.ours)
    if (changes_of(cluster) == Company::changes_max) settled.add(situation_->self);
  if (settled.empty()) return {};
  return settled.lowest();
}

bool Contests::meets_a_third_soon(const Contest& contest, RegionId other) const {
  RegionSet others;
  for (const Clusters::Number cluster : contest.ours)
    neighbourhood_.add_around(cluster, changes_of(cluster) > 0 ? back_near_again : back_near,
                              others);
  others.remove(other);
  return !others.empty();
}

void Contests::remember(const Contest& contest, Verdict& verdict) {
  const RegionId self = situation_->self;
  if (verdict.to == self) {
    // What was asked for by who knew more comes, though less is known now.
    for (Asked& asked : verdict.asked)
      asked.known = promises_.give(asked.aura->id, self, asked.known);
    return;
  }
  for (const RemoteAura* aura : contest.meets)
    promises_.give(aura->id, verdict.to, Company::Hold::none);
  for (const Clusters::Number cluster : contest.ours)
    for (const std::uint32_t member : clusters_->members(cluster))
      promises_.give(outlook_->body(member).id, verdict.to, Company::Hold::none);
}

/// All of a contest goes to one server: what is ours leaves, or what is theirs is asked for.
Contests::Verdict Contests::conclude(const Contest& contest, RegionId to, bool crowded) {
  const Precedence& order = situation_->order;
  Verdict verdict{contest.ours, to, {}};
  const Company::Hold our_hold = hold_of(contest.ours);
  for (const RemoteAura* aura : contest.meets)
    if (order.before(situation_->self, aura->host) && aura->host != to)
      verdict.asked.push_back({aura, std::max(our_hold, aura->company.hold())});
  if (!crowded || to == situation_->self) remember(contest, verdict);
  return verdict;
}

std::vector<Contests::Verdict> Contests::verdicts() {
  const RegionId self = situation_->self;
  const Precedence& order = situation_->order;
  promises_.note_coming();
  std::vector<Verdict> all;
  for (Contest& contest : joined_contests()) {
    RegionSet others;
    for (const Clusters::Number cluster : contest.ours) others.add(neighbourhood_.of(cluster));
    bool crowded = false, followed = false, meets_earlier = false;
    for (const RemoteAura* aura : contest.meets) {
      others.add(aura->host);
      crowded = crowded || aura->company.crowded;
      meets_earlier = meets_earlier || order.before(aura->host, self);
      const bool moved = aura->company.changes > 0;
      followed = followed || moved;
      neighbourhood_.add_around(aura->room.box(), moved ? far_around : near_by, others);
    }
    const RegionId other = order.first(others);
    crowded = crowded || others.holds_several();
    RegionId to = order.first(other, self);
    if (crowded) {
      // Whoever has come after us once is not led on to a server that nobody meets yet.
      if (followed && !meets_earlier) to = self;
      // Whoever has come to the one that was first until a moment ago does not go on at once.
      RegionSet everybody = others;
      everybody.add(self);
      const RegionId was = situation_->order_before.first(everybody);
      if (was != to && has_moved_to(contest, was) && !has_moved_to(contest, to)) to = was;
      to = settled_host(contest).value_or(to);
    } else {
      if (order.before(other, self)) continue;  // It decides.
      to = arbitrate(contest, other);
      if (to != self && meets_a_third_soon(contest, other)) to = self;
    }
    // Whoever went to the other side now would pass by what comes here.
    if (to != self && order.before(self, other))
      if (const Contest waiting = take_waiting(contest); !waiting.ours.empty())
        all.push_back(conclude(waiting, self, crowded));
    if (!contest.ours.empty()) all.push_back(conclude(contest, to, crowded));
  }
  return all;
}

}  // namespace aureole
