// Events of the links, and what they mean for the store and the clock.
#include "server/gateway/region_subscriber.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "server/base/check.h"
#include "server/replica/recovery_answer.h"
#include "server/worlds/region_tiling.h"

namespace aureole {
namespace {

std::vector<RegionId> region_ids(const std::vector<PeerAddress>& addresses) {
  std::vector<RegionId> ids;
  for (const PeerAddress& address : addresses) ids.push_back(address.peer.as_region());
  std::sort(ids.begin(), ids.end());
  return ids;
}

HomeLines lines_of(const WorldDefinition& world) {
  const PartitionMap map = partition_of(world);
  return HomeLines(map, RegionId{0}, HomeLines::rule_in(world.mode, map));
}

PeerLinksOptions link_options(const WorldDefinition& world,
                              const RegionSubscriberOptions& options) {
  PeerLinksOptions links;
  links.self = PeerId::gateway(options.gateway);
  links.incarnation = options.incarnation;
  links.world_hash = world.hash;
  links.dial = options.regions;
  return links;
}

}  // namespace

RegionSubscriber::RegionSubscriber(boost::asio::io_context& io, const WorldDefinition& world,
                                   RegionSubscriberOptions options, Events events)
    : world_(world),
      regions_(region_ids(options.regions)),
      events_(std::move(events)),
      store_(world.prototypes.size()),
      lines_(lines_of(world)),
      reports_(world.regions.size()),
      links_(io, link_options(world, options), world_clock_,
             {.up = [this](PeerId peer, const PeerHello&) { on_up(peer); },
              .down = [this](PeerId peer, const std::string& why) { on_down(peer, why); },
              .frame = [this](PeerId peer, const FrameView& f) { return on_frame(peer, f); },
              .running = [] { return false; },
              .refused =
                  [](PeerId peer, const std::string& why) {
                    spdlog::error("region {} refused this gateway: {}", peer.value, why);
                  }}) {
  for (const RegionId region : regions_)
    AUREOLE_CHECK(region.value < world.regions.size(), "a gateway dials regions of its world");
}

void RegionSubscriber::on_up(PeerId peer) {
  const RegionId region = peer.as_region();
  spdlog::info("region {} is linked", name_of(region));
  store_.region_up(region);
  reports_[region.value].up = true;
  events_.changed();
}

void RegionSubscriber::on_down(PeerId peer, const std::string& reason) {
  const RegionId region = peer.as_region();
  spdlog::warn("region {} is lost: {}", name_of(region), reason);
  store_.region_down(region);
  draw_clock_.forget(region);
  reports_[region.value].up = false;
  reports_[region.value].outside.clear();
  reports_[region.value].recovering = false;
  events_.changed();
}

Status RegionSubscriber::on_frame(PeerId from, const FrameView& frame) {
  const RegionId region = from.as_region();
  if (frame.type == FrameType::region_status) return on_status(region, frame);
  if (frame.type == FrameType::recovery_query) return on_recovery_query(region, frame);
  if (frame.type != FrameType::replica_update)
    return Error::format(
        "a region sent a gateway a frame of type {}; expected replicas, its status or a question",
        static_cast<unsigned>(frame.type));
  const bool was_complete = store_.is_complete(region);
  if (auto applied = store_.apply(region, frame.payload); !applied) return applied;
  if (const auto tick = store_.newest_tick(region))
    draw_clock_.arrived(region, *tick, monotonic_us());
  events_.updated(region);
  if (!was_complete && store_.is_complete(region)) events_.changed();
  return Ok{};
}

Status RegionSubscriber::on_recovery_query(RegionId from, const FrameView& frame) {
  auto answer = answer_recovery(store_, from, frame.payload);
  if (!answer) return answer.error();
  spdlog::info("region {} recovers and asks for what is known of its bodies", name_of(from));
  for (SharedBytes& part : *answer) links_.send(PeerId::region(from), std::move(part));
  return Ok{};
}

Status RegionSubscriber::on_status(RegionId from, const FrameView& frame) {
  const auto* status = verified<wire::RegionStatus>(frame.payload);
  if (!status) return Error{"a region's status cannot be read"};
  if (!is_wire_tick(status->tick()))
    return Error::format("a region's status of tick {}; expected at most {} from 0", status->tick(),
                         wire_tick_max);
  auto outside = read_outside(*status);
  if (!outside) return outside.error();
  auto lines = read_line_news(*status);
  if (!lines) return lines.error();
  lines_.hear(from, Tick{status->tick()}, *lines);
  RegionReport& report = reports_[from.value];
  report.bodies = status->bodies();
  report.awake = status->awake();
  report.frame_ms_p50 = status->frame_us_p50() / 1e3;
  report.frame_ms_max = status->frame_us_max() / 1e3;
  report.migrations_in = status->migrations_in();
  report.migrations_out = status->migrations_out();
  report.overruns = status->overruns();
  report.skipped_ticks = status->skipped_ticks();
  report.removed_strays = status->removed_strays();
  report.unacknowledged = status->unacknowledged();
  report.outside = std::move(*outside);
  report.tolerance_events = status->tolerance_events();
  report.missed_blows = status->missed_blows();
  report.whole_looks = status->whole_looks();
  report.recovering = status->recovering();
  return Ok{};
}

const PartitionMap& RegionSubscriber::map_at(std::int64_t world_us) {
  lines_.move(Tick{world_us / tick_us});
  return lines_.map();
}

Result<std::vector<ToleranceEvent>> RegionSubscriber::read_outside(
    const wire::RegionStatus& status) const {
  std::vector<ToleranceEvent> all;
  if (status.outside() == nullptr) return all;
  for (const wire::ToleranceMark* mark : *status.outside()) {
    const bool known = all.size() < ToleranceEvent::kinds && mark->kind() < ToleranceEvent::kinds &&
                       mark->peer() < world_.regions.size() && std::isfinite(mark->value()) &&
                       std::isfinite(mark->limit());
    if (!known) return Error{"a region's status marks a tolerance that cannot be"};
    all.push_back({ToleranceEvent::Kind{mark->kind()},
                   true,
                   Tick{mark->tick()},
                   RegionId{mark->peer()},
                   {},
                   mark->value(),
                   mark->limit()});
  }
  return all;
}

bool RegionSubscriber::is_complete(RegionId region) const {
  return is_linked(region) && store_.is_complete(region);
}

bool RegionSubscriber::all_complete() const {
  return std::all_of(regions_.begin(), regions_.end(), [&](RegionId r) { return is_complete(r); });
}

std::vector<std::string> RegionSubscriber::missing() const {
  std::vector<std::string> names;
  for (const RegionId region : regions_)
    if (!is_complete(region)) names.push_back(name_of(region));
  return names;
}

std::size_t RegionSubscriber::linked_count() const {
  return static_cast<std::size_t>(
      std::count_if(regions_.begin(), regions_.end(), [&](RegionId r) { return is_linked(r); }));
}

void RegionSubscriber::send(RegionId to, std::span<const wire::Command> commands) {
  if (commands.empty()) return;
  flatbuffers::FlatBufferBuilder builder(64 + commands.size_bytes());
  const auto vector = builder.CreateVectorOfStructs(commands.data(), commands.size());
  const auto root = wire::CreateCommands(builder, vector);
  links_.send(PeerId::region(to),
              std::make_shared<const Bytes>(finish_frame(builder, root, FrameType::commands)));
}

}  // namespace aureole
