// Buckets: which ticks they hold, and what is made of their frames.
#include "server/measure/run_record.h"

#include <nlohmann/json.hpp>

#include "tests/support/catch.h"

using namespace aureole;

namespace {

/// Two servers whose frames are what the test says.
class ToldRun final : public MeasuredRun {
 public:
  std::vector<FrameTime> told = {FrameTime{}, FrameTime{}};
  std::uint64_t moved = 0;
  std::optional<Outside> outside;
  void tick() override {}
  const std::vector<FrameTime>& frames() const override { return told; }
  std::vector<ServerLoad> loads() const override { return {{30, 3, 1}, {10, 1, 0}}; }
  std::uint64_t migrations() const override { return moved; }
  std::optional<Outside> outside_tolerances() const override { return outside; }
  std::optional<double> latency_tolerance_ms() const override { return 7; }
  std::vector<LinkTraffic> traffic() const override { return {{0, 2, moved * 2, moved * 100}}; }
  std::uint64_t state_hash() const override { return 0; }
  std::uint64_t refused_messages() const override { return 0; }
};

}  // namespace

TEST_CASE("every tick is in the bucket in whose five seconds its step ends") {
  const BucketClock clock(12);
  CHECK(clock.last() == Tick{750});
  CHECK(clock.count() == 3);
  CHECK(clock.of(Tick{312}) == 0);  // 4.992 s
  CHECK(clock.of(Tick{313}) == 1);
  CHECK(clock.of(Tick{625}) == 1);  // 10 s
  CHECK(clock.ends_with(Tick{312}));
  CHECK_FALSE(clock.ends_with(Tick{311}));
  CHECK(clock.ends_with(Tick{750}));
  CHECK(clock.end_s(0) == 5);
  CHECK(clock.end_s(2) == 12);
}

TEST_CASE(
    "the busiest server is the one with the largest mean, not the one with the largest frame") {
  RunRecord record(2, 0.16);
  ToldRun run;
  for (int repeat = 0; repeat < 2; ++repeat) {
    record.begin_repeat();
    for (Tick now{1}; now <= Tick{10}; now = now + 1) {
      run.told[0] = {3, 0.5, 0.25, 0.25};
      // One frame that sticks out, by 10 ms in the first repeat and by 14 in the second.
      run.told[1] = {now == Tick{5} ? 10.0 + 4 * repeat : 1.0, 0, 0, 0};
      run.moved = static_cast<std::uint64_t>(now.value);
      record.note(now, run);
    }
  }
  const nlohmann::json bucket = record.to_json(0);
  CHECK(bucket["worst_server_ms"].get<double>() == Approx(4));
  CHECK(bucket["split"]["physics"].get<double>() == Approx(3));
  CHECK(bucket["split"]["aura"].get<double>() == Approx(0.5));
  CHECK(bucket["split"]["decide"].get<double>() == Approx(0.25));
  CHECK(bucket["split"]["wire"].get<double>() == Approx(0.25));
  CHECK(bucket["max_frame_ms"].get<double>() == Approx(12));
  CHECK(bucket["p99_frame_ms"].get<double>() == Approx(14));
  CHECK(bucket["server_ms"][1].get<double>() == Approx(2.1));
  CHECK(bucket["bodies"] == nlohmann::json({30, 10}));
  CHECK(bucket["awake"] == nlohmann::json({3, 1}));
  CHECK(bucket["foreign_hosted_share"].get<double>() == Approx(1.0 / 40));
  CHECK(bucket["migrations"] == 10);
  CHECK(bucket["links"] ==
        nlohmann::json::parse(R"([{"from":0,"to":"gateway","messages":20,"bytes":1000}])"));
  CHECK(bucket["frames_in_tolerance_share"].get<double>() == Approx(1));
}

TEST_CASE("a bucket counts what came since the one before it") {
  RunRecord record(2, 10);
  ToldRun run;
  record.begin_repeat();
  for (Tick now{1}; now <= Tick{625}; now = now + 1) {
    run.moved = static_cast<std::uint64_t>(now.value);
    run.told[0] = {now.value <= 312 ? 1.0 : 17.0, 0, 0, 0};
    record.note(now, run);
  }
  CHECK(record.to_json(0)["migrations"] == 312);
  CHECK(record.to_json(1)["migrations"] == 313);
  CHECK(record.to_json(1)["links"][0]["bytes"] == 31'300);
  CHECK(record.to_json(1)["frames_in_tolerance_share"].get<double>() == Approx(0.5));
  CHECK(total_ms(record.worst_server(0, 2)) == Approx((312 + 313 * 17) / 625.0));
}

TEST_CASE("a tick is in its tolerances if all frames were short and no server says anything else") {
  RunRecord record(2, 0.16, 10);
  ToldRun run;
  record.begin_repeat();
  for (Tick now{1}; now <= Tick{10}; now = now + 1) {
    run.outside = MeasuredRun::Outside{};
    auto& outside = *run.outside;
    outside[static_cast<std::size_t>(ToleranceEvent::Kind::latency)] = now.value <= 2;
    outside[static_cast<std::size_t>(ToleranceEvent::Kind::speed)] = now.value == 2;
    run.told[1] = {now.value == 5 || now.value == 2 ? 11.0 : 10.0, 0, 0, 0};
    record.note(now, run);
  }
  const nlohmann::json bucket = record.to_json(0);
  CHECK(bucket["frames_in_tolerance_share"].get<double>() == Approx(0.9));
  CHECK(bucket["ticks_in_tolerance_share"].get<double>() == Approx(0.7));
  CHECK(bucket["ticks_outside"]["frame_time"].get<double>() == Approx(0.2));
  CHECK(bucket["ticks_outside"]["latency"].get<double>() == Approx(0.2));
  CHECK(bucket["ticks_outside"]["speed"].get<double>() == Approx(0.1));
  CHECK(bucket["ticks_outside"]["link"] == 0);
  CHECK(bucket["latency_tolerance_ms"] == 7);
}

TEST_CASE("nobody's tolerances are nothing, not all of them") {
  RunRecord record(2, 0.16);
  ToldRun run;
  record.begin_repeat();
  for (Tick now{1}; now <= Tick{10}; now = now + 1) record.note(now, run);
  CHECK(record.to_json(0)["ticks_in_tolerance_share"].is_null());
  CHECK(record.to_json(0)["ticks_outside"].is_null());
}

TEST_CASE("the median server is one that half of all do not pass") {
  for (const auto& [servers, expected] :
       {std::pair(5, 3.0), std::pair(4, 2.0), std::pair(1, 1.0)}) {
    RunRecord record(static_cast<std::size_t>(servers), 0.016);
    ToldRun run;
    run.told.clear();
    for (int n = 0; n < servers; ++n)
      run.told.push_back({1.0 + (n * 3) % servers, 0, 0, 0});  // Not in their order.
    record.begin_repeat();
    record.note(Tick{1}, run);
    CHECK(record.median_server_ms(0, 1) == Approx(expected));
    CHECK(record.to_json(0)["median_server_ms"].get<double>() == Approx(expected));
  }
}
