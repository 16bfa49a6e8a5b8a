// decode_status, and what loads and lines make of it: whatever regions say, lines stay lines.
#include <cmath>

#include "protocol/wire.h"
#include "server/aura/partition/partition_map.h"
#include "server/region/lines/home_lines.h"
#include "server/region/status/status_message.h"
#include "tests/fuzz/fuzz_target.h"

using namespace aureole;

namespace {

constexpr std::size_t regions = 4;
constexpr double edge_m = 150;

/// The n-th of `count` ranges of a row that has no ends.
void put(Rectangle& area, double Rectangle::*min, double Rectangle::*max, std::size_t n,
         std::size_t count) {
  if (n > 0) area.*min = static_cast<double>(n) * edge_m;
  if (n + 1 < count) area.*max = static_cast<double>(n + 1) * edge_m;
}

/// In a row, or around the point in which four meet.
PartitionMap a_map(bool corner) {
  std::vector<Rectangle> areas(regions);
  for (std::size_t k = 0; k < regions; ++k) {
    const std::size_t columns = corner ? 2 : regions;
    put(areas[k], &Rectangle::min_x, &Rectangle::max_x, k % columns, columns);
    put(areas[k], &Rectangle::min_z, &Rectangle::max_z, k / columns, regions / columns);
  }
  return PartitionMap(std::move(areas));
}

void check(const PartitionMap& moved, const PartitionMap& still) {
  for (std::uint16_t k = 0; k < regions; ++k) {
    const Rectangle &now = moved.area(RegionId{k}), &before = still.area(RegionId{k});
    FUZZ_EXPECT(now.min_x < now.max_x && now.min_z < now.max_z);
    for (const double Rectangle::*side :
         {&Rectangle::min_x, &Rectangle::max_x, &Rectangle::min_z, &Rectangle::max_z})
      FUZZ_EXPECT(now.*side == before.*side || std::abs(now.*side - before.*side) <= 45);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes payload = payload_of(data, size);
  const auto status = decode_status(payload, regions);
  if (!status) {
    FUZZ_EXPECT(!status.error().message.empty());
    return 0;
  }
  FUZZ_EXPECT(is_wire_tick(status->tick.value));
  FUZZ_EXPECT(status->report.outside.size() <= ToleranceEvent::kinds);
  for (const ToleranceEvent& mark : status->report.outside) {
    FUZZ_EXPECT(static_cast<std::size_t>(mark.kind) < ToleranceEvent::kinds);
    FUZZ_EXPECT(mark.peer.value < regions && is_wire_tick(mark.tick.value));
    FUZZ_EXPECT(std::isfinite(mark.value) && std::isfinite(mark.limit));
  }
  // Everybody says so, in two terms; time goes on from where it was, and to where it is said to be.
  for (const bool corner : {false, true}) {
    const PartitionMap map = a_map(corner);
    HomeLines lines(map, RegionId{1}, HomeLines::rule_in(MigrationMode::adaptive, map));
    LoadLevels levels(regions, RegionId{1}, 1.1);
    for (const std::int64_t later : {0, 128}) {
      for (std::uint16_t k = 0; k < regions; ++k) {
        lines.hear(RegionId{k}, status->tick + later, status->lines);
        levels.hear(RegionId{k}, status->tick + later, status->level);
      }
      lines.move(Tick{1000 + later});
      check(lines.map(), map);
    }
    FUZZ_EXPECT(levels.in_force(Tick{2000}).size() == regions);
    if (status->tick.value <= 2000) continue;
    lines.move(status->tick + 300);
    check(lines.map(), map);
    FUZZ_EXPECT(levels.in_force(status->tick + 300).size() == regions);
  }
  return 0;
}

std::vector<Bytes> aureole_fuzz_seeds() {
  std::vector<Bytes> seeds;
  for (const bool full : {false, true}) {
    flatbuffers::FlatBufferBuilder builder;
    std::vector<wire::ToleranceMark> outside;
    for (std::uint8_t kind = 0; kind < ToleranceEvent::kinds; ++kind)
      outside.emplace_back(990, 40.5, 32, std::uint16_t{3}, kind);
    const auto outside_at = full ? builder.CreateVectorOfStructs(outside) : 0;
    Crowd crowd;
    const auto crowd_at = full ? builder.CreateVector(crowd.encoded()) : 0;
    wire::RegionStatusBuilder status(builder);
    status.add_tick(full ? 1000 : 3000);
    status.add_awake(300);
    status.add_level(60);
    status.add_next_level(61);
    status.add_line_level(full ? 30 : 2000);
    status.add_next_line_level(full ? 31 : 2100);
    status.add_line_level_below(12);
    status.add_line_gain(-40);
    if (full) status.add_outside(outside_at);
    if (full) status.add_crowd_below(crowd_at);
    builder.Finish(status.Finish());
    const auto written = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
    seeds.emplace_back(written.begin(), written.end());
  }
  return seeds;
}
