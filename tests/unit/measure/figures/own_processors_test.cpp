// Who is measured shares its processor with nobody, where there are enough of them.
#include "server/measure/figures/own_processors.h"

#include <algorithm>
#include <set>

#include "server/play/child_process.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

std::set<int> processors_of(pid_t process) {
  cpu_set_t set;
  CPU_ZERO(&set);
  REQUIRE(sched_getaffinity(process, sizeof(set), &set) == 0);
  std::set<int> all;
  for (int n = 0; n < CPU_SETSIZE; ++n)
    if (CPU_ISSET(static_cast<std::size_t>(n), &set)) all.insert(n);
  return all;
}

ChildProcess sleeper() {
  auto child = ChildProcess::start("/bin/sleep", {"60"});
  REQUIRE(child);
  return std::move(*child);
}

}  // namespace

TEST_CASE("processes that are measured and who waits for them keep to a processor each") {
  const std::set<int> before = processors_of(0);
  if (before.size() < 2) return;  // Then there is nothing to be shared out.
  const std::size_t processes = std::min<std::size_t>(2, before.size() - 1);
  {
    OwnProcessors own(processes);
    std::set<int> taken = processors_of(0);
    REQUIRE(taken.size() == 1);
    std::vector<ChildProcess> children;
    std::optional<int> last;
    for (std::size_t n = 0; n < processes; ++n) {
      children.push_back(sleeper());
      last = own.take(children.back().pid());
      REQUIRE(last);
      CHECK(processors_of(children.back().pid()) == std::set{*last});
      CHECK(before.contains(*last));
      CHECK(taken.insert(*last).second);
    }
    // Whoever comes next has the place of who has gone.
    own.give_back(last);
    const ChildProcess next = sleeper();
    CHECK(own.take(next.pid()) == last);
  }
  CHECK(processors_of(0) == before);
}

TEST_CASE("where there are too few processors all share them") {
  const std::set<int> before = processors_of(0);
  OwnProcessors own(before.size());
  CHECK(processors_of(0) == before);
  const ChildProcess child = sleeper();
  CHECK_FALSE(own.take(child.pid()));
  CHECK(processors_of(child.pid()) == before);
}
