// Crowds are counted by distance; a line goes where the fewest are, a step at a time.
#include "server/region/loads/line_keeper.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

/// Between two codes of a bin; code 0 is nothing.
const double code_step = std::log(1.05);
/// Crowds and loads follow who is awake in so many statuses, 5 s; until then they are the mean of
/// all. Alike, so that what a crowd would bring is compared with what there was at the same time.
constexpr double looks_in_mind = 20;

double share_of(std::int64_t looks) {
  return std::max(1.0 / static_cast<double>(looks), 1.0 / looks_in_mind);
}

/// Fewer are not worth moving a line for (bodies awake).
constexpr double crowd_min = 8;
/// What belongs to a line's crowd (m, to either side of its place).
constexpr double crowd_reach_m = 48;
/// A place is quiet where there are at most so many of those who are here.
constexpr double quiet_share = 0.5;
/// What a side may have of the mean of all servers after a move, and what it has to have for the
/// line to go back.
constexpr double load_max = 1.15, overload = 1.3;
/// A metre of the way counts as so many bodies at its end: of two quiet places the nearer one.
constexpr double bodies_per_m = 0.02;

}  // namespace

double Crowd::between(double from, double to) const {
  double sum = 0;
  for (int i = 0; i < bins; ++i) {
    const double low = from_m + i * bin_m;
    const double covered_m = std::min(to, low + bin_m) - std::max(from, low);
    if (covered_m > 0) sum += awake[static_cast<std::size_t>(i)] * covered_m / bin_m;
  }
  return sum;
}

std::vector<std::uint8_t> Crowd::encoded() const {
  std::vector<std::uint8_t> bytes;
  for (const double n : awake)
    bytes.push_back(static_cast<std::uint8_t>(
        std::min(std::round(std::log1p(std::max(n, 0.0)) / code_step), 255.0)));
  return bytes;
}

Result<Crowd> Crowd::decoded(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != static_cast<std::size_t>(bins))
    return Error::format("a crowd of {} bins; expected {}", bytes.size(), bins);
  Crowd crowd;
  for (std::size_t i = 0; i < bytes.size(); ++i) crowd.awake[i] = std::expm1(bytes[i] * code_step);
  return crowd;
}

double LineSituation::gain(double place_m) const {
  return above_has.between(Crowd::from_m, place_m) - below_has.between(place_m, -Crowd::from_m);
}

double quiet_place_m(const LineSituation& line) {
  const double gainer = line.here_m > 0 ? line.below : line.above;
  if (line.here_m != 0 && gainer > overload * line.mean) return 0;
  const double here = line.stirs_at(line.here_m);
  const double crowd = line.below_has.between(-crowd_reach_m, crowd_reach_m) +
                       line.above_has.between(-crowd_reach_m, crowd_reach_m);
  if (here < crowd_min || crowd > line.crowd_max * line.all) return line.here_m;
  double best_m = line.here_m, least = quiet_share * here;
  const int reach = static_cast<int>(line.far_m / Crowd::bin_m);
  for (int i = -reach; i <= reach; ++i) {
    const double place_m = i * Crowd::bin_m;
    const double gain = line.gain(place_m);
    const double more = std::max(line.below + gain, line.above - gain);
    const double stirs = line.stirs_at(place_m) + bodies_per_m * std::abs(place_m - line.here_m);
    if (more <= load_max * line.mean && stirs < least) {
      least = stirs;
      best_m = place_m;
    }
  }
  return best_m;
}

LineKeeper::LineKeeper(const PartitionLines& lines, std::size_t regions, RegionId self)
    : lines_(lines), self_(self), loads_(regions) {
  for (std::uint16_t k = 0; k < regions; ++k) keepers_below_.push_back(RegionId{k});
  for (std::size_t i = 0; i < lines.count(); ++i) {
    const RegionId keeper = lines.below(i).front();
    for (const RegionId region : lines.above(i)) keepers_below_[region.value] = keeper;
    if (keeper == self) line_ = i;
    if (lines.above(i).front() == self) line_below_ = i;
  }
}

void LineKeeper::note_awake(std::span<const NewBody> awake) {
  const double share = share_of(++looks_);
  const auto count = [&](std::optional<std::size_t> line, Crowd& crowd) {
    if (!line) return;
    Crowd now;
    for (const NewBody& body : awake) {
      const double bin =
          (lines_.beyond_m(*line, body.state.position) - Crowd::from_m) / Crowd::bin_m;
      if (bin >= 0 && bin < Crowd::bins) ++now.awake[static_cast<std::size_t>(bin)];
    }
    for (std::size_t i = 0; i < now.awake.size(); ++i)
      crowd.awake[i] += (now.awake[i] - crowd.awake[i]) * share;
  };
  count(line_, ends_);
  count(line_below_, begins_);
}

std::int32_t LineKeeper::gain() const {
  if (!target_m_) return 0;
  const LineSituation now{.below_has = ends_, .above_has = beyond_};
  return static_cast<std::int32_t>(std::lround(std::clamp(now.gain(*target_m_), -1e6, 1e6)));
}

void LineKeeper::hear(RegionId from, double awake, std::int32_t gain, const Crowd& crowd_below) {
  Load& load = loads_[from.value];
  load.awake += (awake - load.awake) * share_of(++load.looks);
  load.gain = gain;
  if (line_ && lines_.above(*line_).front() == from) beyond_ = crowd_below;
}

/// With what lines on their way will have brought.
double LineKeeper::expected(RegionId region) const {
  const RegionId below = keepers_below_[region.value];
  const Load& load = loads_[region.value];
  return load.awake + load.gain - (below == region ? 0 : loads_[below.value].gain);
}

LineSituation LineKeeper::situation(double here_m) const {
  LineSituation now;
  now.here_m = here_m;
  now.far_m = lines_.far_m(*line_);
  now.crowd_max = crowd_max_;
  now.below_has = ends_;
  now.above_has = beyond_;
  // But for our own line.
  now.below = expected(self_) - loads_[self_.value].gain;
  now.above = expected(lines_.above(*line_).front()) + loads_[self_.value].gain;
  for (const Load& load : loads_) now.all += load.awake;
  now.mean = now.all / static_cast<double>(loads_.size());
  return now;
}

double LineKeeper::next_m(double here_m) {
  if (!line_) return here_m;
  const LineSituation now = situation(here_m);
  if (now.mean < awake_min_) return here_m;
  // Once it has set out it goes on, unless somebody would have too much by now.
  const auto too_much = [&](double place_m) {
    const double gain = now.gain(place_m);
    return std::max(now.below + gain, now.above - gain) > overload * now.mean;
  };
  const bool on_its_way = target_m_ && *target_m_ != here_m && !too_much(*target_m_);
  if (!on_its_way) target_m_ = quiet_place_m(now);
  return here_m + std::clamp(*target_m_ - here_m, -step_m, step_m);
}

}  // namespace aureole
