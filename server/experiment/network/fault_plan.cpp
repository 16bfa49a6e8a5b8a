// Draws faults of every kind at random times, each with its own density.
#include "server/experiment/network/fault_plan.h"

#include <algorithm>

namespace aureole {
namespace {

constexpr Micros ms = 1000, second = 1'000'000;
/// No fault in the first half second: links come up and the first bodies are told of.
constexpr Micros first_fault_us = 500 * ms;
/// A crash is followed by this much time without another one of the same region.
constexpr Micros recover_us = 1500 * ms;

class Planner {
 public:
  explicit Planner(const FaultPlanOptions& options) : o_(options), random_(options.seed, 2) {}

  std::vector<Fault> plan() {
    if (o_.until_us <= first_fault_us || o_.kinds == FaultKinds::none) return {};
    if (o_.kinds != FaultKinds::crashes) draw_link_faults();
    if (o_.kinds != FaultKinds::links) draw_crashes();
    std::stable_sort(plan_.begin(), plan_.end(),
                     [](const Fault& x, const Fault& y) { return x.at_us < y.at_us; });
    return std::move(plan_);
  }

 private:
  /// Two different ends; regions mostly, now and then the gateway.
  std::pair<End, End> two_ends() {
    const int ends = o_.regions + (random_.chance(0.15) ? 1 : 0);
    if (ends < 2) return {0, o_.regions};
    const End a = random_.below(ends);
    const End b = (a + 1 + random_.below(ends - 1)) % ends;
    return {a, b};
  }

  /// Calls `draw(at)` at random moments, `per_s` times a second on average.
  template <class Draw>
  void at_random(double per_s, Draw draw) {
    Micros at = first_fault_us;
    while (true) {
      at += static_cast<Micros>(random_.between(0.2, 1.8) / per_s * second);
      if (at >= o_.until_us) return;
      draw(at);
    }
  }

  void add(Fault fault) {
    fault.duration_us = std::min(fault.duration_us, o_.until_us - fault.at_us);
    plan_.push_back(fault);
  }

  void draw_link_faults() {
    at_random(0.5, [&](Micros at) {
      const auto [a, b] = two_ends();
      add({at, Fault::Kind::stall, a, b, random_.below(380) * ms + 20 * ms});
    });
    at_random(0.4, [&](Micros at) {
      const auto [a, b] = two_ends();
      const bool silent = random_.chance(0.2);
      const Micros lasts =
          silent ? 800 * ms + random_.below(1200) * ms : 20 * ms + random_.below(380) * ms;
      add({at, Fault::Kind::stall_one_way, a, b, lasts});
    });
    at_random(0.5, [&](Micros at) {
      const auto [a, b] = two_ends();
      add({at, Fault::Kind::reset, a, b, random_.below(400) * ms});
    });
    at_random(0.3, [&](Micros at) {
      Fault fault{at, Fault::Kind::slow, random_.below(o_.regions)};
      fault.duration_us = 100 * ms + random_.below(900) * ms;
      fault.frame_ms = random_.between(17, 45);
      add(fault);
    });
  }

  void draw_crashes() {
    std::vector<Micros> free_from(static_cast<std::size_t>(o_.regions) + 1, 0);
    const End gateway = o_.regions;
    const auto crash = [&](Micros at, End who, bool lose_disk) {
      Micros& free = free_from[static_cast<std::size_t>(who)];
      const Micros down = 200 * ms + random_.below(1800) * ms;
      if (at < free || at + down >= o_.until_us) return;
      if (lose_disk) {
        // Somebody must know what was there: the store, and nobody else is in doubt.
        for (Micros other : free_from) lose_disk = lose_disk && at > other;
        // The store would not be whole while any other is down; keep the rest up meanwhile.
        if (lose_disk) std::fill(free_from.begin(), free_from.end(), at + down + recover_us);
      }
      Fault fault{at, Fault::Kind::crash, who, 0, down};
      fault.loses_disk = lose_disk && who != gateway;
      add(fault);
      free = std::max(free, at + down + recover_us);
    };
    at_random(0.3, [&](Micros at) {
      const End who = random_.below(o_.regions);
      const bool lose_disk = random_.chance(0.2);
      const bool neighbour_too = random_.chance(0.3);
      crash(at, who, lose_disk);
      if (neighbour_too && !lose_disk && o_.regions > 1)
        crash(at + random_.below(400) * ms, (who + 1) % o_.regions, false);
    });
    at_random(0.12, [&](Micros at) { crash(at, gateway, false); });
  }

  FaultPlanOptions o_;
  Random random_;
  std::vector<Fault> plan_;
};

}  // namespace

std::string_view name_of(FaultKinds kinds) {
  switch (kinds) {
    case FaultKinds::none:
      return "none";
    case FaultKinds::links:
      return "links";
    case FaultKinds::crashes:
      return "crashes";
    case FaultKinds::all:
      return "all";
  }
  return "none";
}

std::optional<FaultKinds> fault_kinds_from(std::string_view name) {
  for (const auto kinds :
       {FaultKinds::none, FaultKinds::links, FaultKinds::crashes, FaultKinds::all})
    if (name_of(kinds) == name) return kinds;
  return {};
}

std::vector<Fault> plan_faults(const FaultPlanOptions& options) {
  return Planner(options).plan();
}

}  // namespace aureole
