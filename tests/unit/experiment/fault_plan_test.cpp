// Faults are drawn from the seed, and stop in time.
#include <set>

#include "server/experiment/network/fault_plan.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr Micros until_us = 12'000'000;

std::vector<Fault> plan(FaultKinds kinds, std::uint64_t seed) {
  return plan_faults({kinds, 4, until_us, seed});
}

}  // namespace

TEST_CASE("every kind of fault comes up, and nothing when none is wanted") {
  REQUIRE(plan(FaultKinds::none, 1).empty());
  std::set<Fault::Kind> links, crashes, all;
  bool lost_disk = false, gateway = false;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    for (const Fault& f : plan(FaultKinds::links, seed)) links.insert(f.kind);
    for (const Fault& f : plan(FaultKinds::crashes, seed)) crashes.insert(f.kind);
    for (const Fault& f : plan(FaultKinds::all, seed)) {
      all.insert(f.kind);
      lost_disk |= f.loses_disk;
      gateway |= f.kind == Fault::Kind::crash && f.a == 4;
    }
  }
  REQUIRE(links.size() == 4);
  REQUIRE(crashes == std::set{Fault::Kind::crash});
  REQUIRE(all.size() == 5);
  REQUIRE(lost_disk);
  REQUIRE(gateway);
}

TEST_CASE("faults begin and end before the time that is left for calm") {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Micros last = 0;
    for (const Fault& f : plan(FaultKinds::all, seed)) {
      REQUIRE(f.at_us >= last);
      REQUIRE(f.at_us + f.duration_us <= until_us);
      last = f.at_us;
    }
  }
}

TEST_CASE("a disk is lost only while nothing else is down or has just come back") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto faults = plan(FaultKinds::all, seed);
    for (const Fault& lost : faults) {
      if (!lost.loses_disk) continue;
      for (const Fault& other : faults) {
        if (other.kind != Fault::Kind::crash || &other == &lost) continue;
        const bool apart = other.at_us + other.duration_us + 1'000'000 < lost.at_us ||
                           lost.at_us + lost.duration_us + 1'000'000 < other.at_us;
        INFO("seed " << seed);
        REQUIRE(apart);
      }
    }
  }
}

TEST_CASE("the same seed gives the same faults, another seed others") {
  const auto at = [](std::uint64_t seed) {
    std::vector<Micros> times;
    for (const Fault& f : plan(FaultKinds::all, seed)) times.push_back(f.at_us);
    return times;
  };
  REQUIRE(at(5) == at(5));
  REQUIRE(at(5) != at(6));
}
