// The made-up region's ticks, updates and commands.
#include "tests/unit/gateway/support/fake_region.h"

#include <algorithm>
#include <cmath>

#include "server/base/check.h"
#include "tests/unit/gateway/support/small_world.h"
#include "tests/unit/replica/update.h"

namespace aureole::test {

FakeRegion::FakeRegion(const WorldDefinition& world, Options options)
    : world_(world), options_(options), timer_(io_) {
  clock_.start_as_reference(monotonic_us(), 1'000 * tick_us);
  tick_ = 1'000;
  PeerLinksOptions link;
  link.self = PeerId::region(options.id);
  link.incarnation = Incarnation{1};
  link.world_hash = world.hash;
  PeerLinks::Events events;
  events.up = [this](PeerId peer, const PeerHello&) {
    gateways_.push_back(peer);
    publish(/*whole=*/true);
  };
  events.down = [this](PeerId peer, const std::string&) { std::erase(gateways_, peer); };
  events.running = [] { return true; };
  events.frame = [this](PeerId, Frame frame) -> Status {
    const auto* commands = verified<wire::Commands>(frame.payload);
    if (frame.type != FrameType::commands || !commands || !commands->commands())
      return Error{"a gateway sends commands"};
    for (const wire::Command* command : *commands->commands()) take(*command);
    return Ok{};
  };
  links_ = std::make_unique<PeerLinks>(io_, link, clock_, std::move(events));
  const auto port = links_->listen({"127.0.0.1", 0});
  AUREOLE_CHECK(bool(port), "a made-up region finds a port");
  port_ = *port;
  links_->start();
  next_us_ = monotonic_us();
  tick();
  thread_ = std::thread([this] { io_.run(); });
}

FakeRegion::~FakeRegion() {
  io_.stop();
  thread_.join();
  links_->stop();
}

PeerAddress FakeRegion::address() const {
  return {PeerId::region(options_.id), {"127.0.0.1", port_}};
}

std::vector<wire::Command> FakeRegion::applied() const {
  const std::lock_guard lock(mutex_);
  return applied_;
}

bool FakeRegion::has_avatar(PlayerId player) const {
  const std::lock_guard lock(mutex_);
  return avatars_.contains(player.value);
}

void FakeRegion::make_up_session(PlayerId player, std::uint32_t session) {
  const std::lock_guard lock(mutex_);
  avatars_.at(player.value).session = session;
}

void FakeRegion::tick() {
  ++tick_;
  publish(false);
  if (tick_ % 16 == 0) publish_status();
  next_us_ += tick_us;
  timer_.expires_after(
      std::chrono::microseconds(std::max<std::int64_t>(next_us_ - monotonic_us(), 0)));
  timer_.async_wait([this](boost::system::error_code e) {
    if (!e) tick();
  });
}

void FakeRegion::publish(bool whole) {
  if (gateways_.empty()) return;
  const std::lock_guard lock(mutex_);
  Update update(tick_);
  const Version version = version_of(options_.id, 1);
  const double sign = options_.id.value == 0 ? -1 : 1;
  for (int i = 0; i < options_.bodies; ++i) {
    const bool moves = i < options_.moving;
    WorldPosition at{sign * (3 + i % 20), 0.3 + i / 200, -4.0 - i / 20 % 10};
    if (moves) at.y += 1 + std::sin(static_cast<double>(tick_) * 0.05 + i);
    const auto slot = static_cast<std::uint32_t>(i);
    const auto n = static_cast<std::uint32_t>(options_.id.value * 100'000 + i);
    if (whole)
      update.key({.id = BodyId::world(n),
                  .version = version,
                  .slot = slot,
                  .position = at,
                  .prototype = i % 3 == 0 ? crate_kind.value : ball_kind.value,
                  .activation = static_cast<std::uint8_t>(moves ? 0 : 2)});
    else if (moves)
      update.motion(slot, at);
  }
  std::uint32_t slot = 500'000;  // far from those of the rows
  for (const auto& [player, avatar] : avatars_) {
    const WorldPosition at = world_.spawn_points[0].position;
    update.key({.id = BodyId::avatar(PlayerId{player}),
                .version = version,
                .slot = slot++,
                .position = at,
                .prototype = avatar_kind.value});
    update.player(player, avatar.session, avatar.applied, BodyId{avatar.carried}, avatar.connected);
  }
  for (const std::uint32_t player : removed_)
    update.removed(BodyId::avatar(PlayerId{player}), version);
  removed_.clear();
  const auto frame = std::make_shared<const Bytes>(
      encode_frame(FrameType::replica_update, 0, update.complete().bytes()));
  for (const PeerId gateway : gateways_) links_->send(gateway, frame);
}

void FakeRegion::publish_status() {
  flatbuffers::FlatBufferBuilder builder(256);
  const auto outside = builder.CreateVectorOfStructs(options_.outside);
  wire::RegionStatusBuilder status(builder);
  status.add_tick(tick_);
  status.add_outside(outside);
  status.add_tolerance_events(options_.outside.size());
  status.add_missed_blows(options_.missed_blows);
  status.add_line_level(options_.line_level);
  status.add_next_line_level(options_.line_level);
  const auto frame = std::make_shared<const Bytes>(
      finish_frame(builder, status.Finish(), FrameType::region_status));
  for (const PeerId gateway : gateways_) links_->send(gateway, frame);
}

void FakeRegion::take(const wire::Command& command) {
  if (!options_.applies) return;
  const std::lock_guard lock(mutex_);
  if (command.kind() == wire::CommandKind::join) {
    const bool known = avatars_.contains(command.player());
    if (!known && command.target() != 0) return;
    Avatar& avatar = avatars_[command.player()];
    if (known && command.session() <= avatar.session) return;
    avatar.session = command.session();
    avatar.applied = command.sequence();
    avatar.connected = true;
    avatar.waiting.clear();
    applied_.push_back(command);
    return;
  }
  const auto at = avatars_.find(command.player());
  if (at == avatars_.end() || command.session() != at->second.session) return;
  if (command.sequence() > at->second.applied)
    at->second.waiting.emplace(command.sequence(), command);
  while (true) {
    const auto again = avatars_.find(command.player());
    if (again == avatars_.end()) return;
    const auto next = again->second.waiting.find(again->second.applied + 1);
    if (next == again->second.waiting.end()) return;
    const wire::Command due = next->second;
    again->second.waiting.erase(next);
    again->second.applied = due.sequence();
    apply(again->second, due);
  }
}

void FakeRegion::apply(Avatar& avatar, const wire::Command& command) {
  applied_.push_back(command);
  avatar.connected = command.kind() != wire::CommandKind::lost;
  if (command.kind() == wire::CommandKind::grab) avatar.carried = command.target();
  if (command.kind() != wire::CommandKind::leave) return;
  removed_.push_back(command.player());
  avatars_.erase(command.player());
}

}  // namespace aureole::test
