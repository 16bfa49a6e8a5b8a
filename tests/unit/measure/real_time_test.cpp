// Real time beside virtual time: how long a process ran, and what stands in the comparison.
#include "server/measure/real_time.h"

#include <unistd.h>

#include <nlohmann/json.hpp>

#include "server/measure/measured/measured_run.h"
#include "server/measure/workload/workload.h"
#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("a process's first thread has run as long as it says itself") {
  const auto before = thread_cpu_of_process_ns(getpid());
  REQUIRE(before);
  const std::int64_t from = thread_cpu_ns();
  volatile double sum = 0;
  while (thread_cpu_ns() - from < 50'000'000) sum = sum + 1;
  const auto after = thread_cpu_of_process_ns(getpid());
  REQUIRE(after);
  // The kernel brings it up to date at each of its ticks.
  CHECK(static_cast<double>(*after - *before) / 1e6 == Approx(50).margin(25));
}

TEST_CASE("a process that is not there has no time") {
  const auto spent = thread_cpu_of_process_ns(0);
  REQUIRE_FALSE(spent);
  CHECK(spent.error().message ==
        "/proc/0/task/0/schedstat does not say how long the process has run");
}

TEST_CASE("buckets of both kinds of time stand side by side, warm caches and cold") {
  const nlohmann::json report = {
      {"experiment", {{"servers", 2}}},
      {"buckets",
       {{{"worst_server_ms", 4.0}, {"server_ms", {4.0, 3.0}}, {"bodies", {10, 9}}},
        {{"worst_server_ms", 5.0}, {"server_ms", {4.0, 5.0}}, {"bodies", {20, 19}}}}}};
  const nlohmann::json cold = {{"buckets",
                                {{{"worst_server_ms", 5.0}, {"server_ms", {5.0, 4.5}}},
                                 {{"worst_server_ms", 8.0}, {"server_ms", {8.0, 6.0}}}}}};
  const nlohmann::json both = compare_with_virtual_time(
      {{5, {3.0, 5.0}, {11, 8}, {0, 2}, 9, 0}, {10, {6.0, 2.0}, {20, 19}, {0, 0}, 9, 1}}, report,
      cold);
  REQUIRE(both["buckets"].size() == 2);
  CHECK(both["buckets"][0]["worst_server_ms"] == 5);
  CHECK(both["buckets"][0]["skipped_ticks"] == nlohmann::json({0, 2}));
  CHECK(both["buckets"][0]["ratio"] == 1.25);
  CHECK(both["buckets"][1]["virtual_server_ms"] == nlohmann::json({4.0, 5.0}));
  CHECK(both["buckets"][1]["ratio"] == 1.2);
  CHECK(both["buckets"][0]["ratio_cold"] == 1);
  CHECK(both["buckets"][1]["ratio_cold"] == 0.75);
  CHECK(both["buckets"][1]["cold_worst_server_ms"] == 8);
  CHECK(both["buckets"][0]["cold_server_ms"] == nlohmann::json({5.0, 4.5}));
  CHECK(both["experiment"]["servers"] == 2);
}

TEST_CASE("servers that cannot be started are an error in a sentence") {
  WorkloadOptions options;
  const auto world = workload_world(options);
  REQUIRE(world);
  RealTimeOptions real_time;
  real_time.executable = "/nowhere/aureole";
  const auto buckets = run_in_real_time(*world, real_time, [](const std::string&) {});
  REQUIRE_FALSE(buckets);
  CHECK(buckets.error().message.find(" ended (exit code 127)") != std::string::npos);
}
