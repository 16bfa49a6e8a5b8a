// What a region says of itself, and what nobody can say.
#include "server/region/status/status_message.h"

#include <limits>
#include <string>
#include <vector>

#include "protocol/wire.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr std::size_t regions = 3;

struct Said {
  std::int64_t tick = 640;
  std::vector<wire::ToleranceMark> outside{};
  std::vector<std::uint8_t> crowd{};

  Bytes bytes() const {
    flatbuffers::FlatBufferBuilder builder;
    const auto outside_at = builder.CreateVectorOfStructs(outside);
    const auto crowd_at = builder.CreateVector(crowd);
    wire::RegionStatusBuilder status(builder);
    status.add_tick(tick);
    status.add_bodies(70);
    status.add_awake(12);
    status.add_frame_us_p50(1500);
    status.add_frame_us_max(9250);
    status.add_migrations_in(3);
    status.add_migrations_out(4);
    status.add_overruns(5);
    status.add_skipped_ticks(6);
    status.add_removed_strays(7);
    status.add_unacknowledged(8);
    status.add_recovering(true);
    status.add_tolerance_events(9);
    status.add_missed_blows(10);
    status.add_whole_looks(11);
    status.add_level(20);
    status.add_next_level(21);
    status.add_line_level(22);
    status.add_next_line_level(23);
    if (!outside.empty()) status.add_outside(outside_at);
    if (!crowd.empty()) status.add_crowd_below(crowd_at);
    builder.Finish(status.Finish());
    const auto written = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
    Bytes payload(written.begin(), written.end());
    payload.resize((payload.size() + 7) / 8 * 8);
    return payload;
  }
};

std::string refusal(const Said& said) {
  const Bytes payload = said.bytes();
  const auto status = decode_status(payload, regions);
  return status ? "" : status.error().message;
}

/// When, value, limit, region, kind.
Said marking(std::int64_t tick, double value, double limit, std::uint16_t peer, std::uint8_t kind) {
  Said said;
  said.outside.emplace_back(tick, value, limit, peer, kind);
  return said;
}

}  // namespace

TEST_CASE("a status is read as it was said") {
  Said said = marking(600, 3.5, 2, 2, 1);
  said.outside.emplace_back(-5, 40, 32, std::uint16_t{0}, std::uint8_t{0});
  const Bytes payload = said.bytes();
  const auto status = decode_status(payload, regions);
  REQUIRE(status);
  CHECK(status->tick == Tick{640});
  CHECK(status->level.now == 20);
  CHECK(status->level.next == 21);
  CHECK(status->lines.level.now == 22);
  CHECK(status->lines.level.next == 23);
  CHECK(status->lines.awake == 12);
  const RegionReport& report = status->report;
  CHECK_FALSE(report.up);
  CHECK(report.bodies == 70);
  CHECK(report.awake == 12);
  CHECK(report.frame_ms_p50 == 1.5);
  CHECK(report.frame_ms_max == 9.25);
  CHECK(report.migrations_in == 3);
  CHECK(report.migrations_out == 4);
  CHECK(report.overruns == 5);
  CHECK(report.skipped_ticks == 6);
  CHECK(report.removed_strays == 7);
  CHECK(report.unacknowledged == 8);
  CHECK(report.tolerance_events == 9);
  CHECK(report.missed_blows == 10);
  CHECK(report.whole_looks == 11);
  CHECK(report.recovering);
  REQUIRE(report.outside.size() == 2);
  CHECK(report.outside[0].kind == ToleranceEvent::Kind::latency);
  CHECK(report.outside[0].outside);
  CHECK(report.outside[0].tick == Tick{600});
  CHECK(report.outside[0].peer == RegionId{2});
  CHECK(report.outside[0].value == 3.5);
  CHECK(report.outside[0].limit == 2);
  CHECK(report.outside[1].kind == ToleranceEvent::Kind::speed);
}

TEST_CASE("a status that cannot be is refused with what is wrong in it") {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const double endless = std::numeric_limits<double>::infinity();
  CHECK(refusal({}).empty());
  CHECK(refusal({.tick = wire_tick_max}).empty());
  CHECK(refusal({.tick = wire_tick_max + 1}).find("of tick 1099511627777; expected at most") !=
        std::string::npos);
  CHECK(refusal({.tick = std::numeric_limits<std::int64_t>::min()}).find("of tick -92233") !=
        std::string::npos);
  CHECK(
      refusal(marking(1, 1, 1, 0, 4)).find("of kind 4 and region 0; expected less than 4 and 3") !=
      std::string::npos);
  CHECK(refusal(marking(1, 1, 1, 3, 1)).find("of kind 1 and region 3") != std::string::npos);
  CHECK(refusal(marking(1, none, 1, 0, 0)).find("left with nan") != std::string::npos);
  CHECK(refusal(marking(1, 1, endless, 0, 0)).find("of inf left") != std::string::npos);
  CHECK(refusal(marking(wire_tick_max + 1, 1, 1, 0, 0)).find("at tick 1099511627777") !=
        std::string::npos);
  Said many;
  for (int n = 0; n < 5; ++n) many.outside.emplace_back(1, 1, 1, std::uint16_t{0}, std::uint8_t{0});
  CHECK(refusal(many).find("marks 5 tolerances; there are 4") != std::string::npos);
  CHECK_FALSE(refusal({.crowd = {1, 2, 3}}).empty());
  CHECK(decode_status(Bytes(16), regions).error().message.find("not a valid message") !=
        std::string::npos);
}
