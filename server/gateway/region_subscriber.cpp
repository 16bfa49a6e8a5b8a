// Events of the links, and what they mean for the store and the clock.
#include "server/gateway/region_subscriber.h"

#include <spdlog/spdlog.h>

#include <algorithm>

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
  links.region_count = world.regions.size();
  links.dial = options.regions;
  links.secret = options.secret;
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
      links_(
          io, link_options(world, options), world_clock_,
          {.up = [this](PeerId peer, const PeerHello&) { on_up(peer); },
           .down = [this](PeerId peer, const std::string& why) { on_down(peer, why); },
           .frame = [this](PeerId peer, const FrameView& f) { return on_frame(peer, f); },
           .running = [] { return false; },
           .refused = [this](PeerId peer, const Refusal& refusal) { on_refused(peer, refusal); }}) {
  for (const RegionId region : regions_)
    AUREOLE_CHECK(region.value < world.regions.size(), "a gateway dials regions of its world");
}

void RegionSubscriber::on_up(PeerId peer) {
  const RegionId region = peer.as_region();
  spdlog::info("region {} is linked", name_of(region));
  was_linked_ = true;
  store_.region_up(region);
  reports_[region.value].up = true;
  events_.changed();
}

void RegionSubscriber::on_refused(PeerId peer, const Refusal& refusal) {
  const std::string& name = name_of(peer.as_region());
  const std::string what =
      refusal.is_ours ? fmt::format("no link with region {}: {}", name, refusal.reason)
                      : fmt::format("region {} refused this gateway: {}", name, refusal.reason);
  if (refusal.replaced)
    events_.rejected(what + "; each gateway of a world needs its own --number");
  else if (!was_linked_)
    events_.rejected(what);
  else  // A gateway that shows a world is not ended by whoever happens to answer somewhere.
    spdlog::error("{}", what);
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
  auto status = decode_status(frame.payload, world_.regions.size());
  if (!status) return status.error();
  lines_.hear(from, status->tick, status->lines);
  RegionReport& report = reports_[from.value];
  status->report.up = report.up;
  report = std::move(status->report);
  return Ok{};
}

const PartitionMap& RegionSubscriber::map_at(std::int64_t world_us) {
  lines_.move(Tick{world_us / tick_us});
  return lines_.map();
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
