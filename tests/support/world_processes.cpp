// Starting, watching and ending a world of real processes.
#include "tests/support/world_processes.h"

#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "protocol/wire.h"
#include "server/ops/http_get.h"
#include "server/ops/ports.h"
#include "server/region/handoff/handoff.h"
#include "tests/support/temporary_folder.h"

namespace aureole::testing {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Waits for the child's "ready" line.
void await_ready(ChildProcess& child) {
  const auto limit = Clock::now() + 30s;
  std::string said, complaint;
  while (Clock::now() < limit) {
    pollfd ends[2] = {{child.descriptor(Output::standard), POLLIN, 0},
                      {child.descriptor(Output::error), POLLIN, 0}};
    poll(ends, 2, 50);
    bool ready = false;
    child.read(Output::standard,
               [&](const std::string& line) { ready = ready || line.starts_with("ready "); });
    child.read(Output::error, [&](const std::string& line) { complaint = line; });
    if (ready) return;
    if (!child.is_running())
      throw std::runtime_error("a server ended before it was ready: " + complaint);
  }
  throw std::runtime_error("a server did not get ready in 30 s: " + complaint);
}

}  // namespace

WorldProcesses::WorldProcesses(std::filesystem::path world, int count, bool with_gateway,
                               bool own_rectangles)
    : world_(std::move(world)) {
  auto ports = free_loopback_ports(count + 1, static_cast<std::uint32_t>(getpid()));
  if (!ports) throw std::runtime_error(ports.error().message);
  gateway_port_ = ports->back();
  ports->pop_back();
  ports_ = *ports;

  std::vector<std::string> common{"--world", world_.string(), "--log-level", "warning"};
  if (!own_rectangles) common.insert(common.end(), {"--regions", std::to_string(count)});
  std::vector<std::string> gateway{"gateway", "--listen",
                                   "127.0.0.1:" + std::to_string(gateway_port_)};
  for (int i = 0; i < count; ++i) {
    const auto address = [&](int k) {
      return "r" + std::to_string(k) +
             "=127.0.0.1:" + std::to_string(ports_[static_cast<std::size_t>(k)]);
    };
    std::vector<std::string> region{"region", "--region", std::to_string(i), "--listen",
                                    address(i).substr(address(i).find('=') + 1)};
    for (int k = 0; k < count; ++k)
      if (k != i) region.insert(region.end(), {"--peer", address(k)});
    region.insert(region.end(), common.begin(), common.end());
    start(region);
    gateway.insert(gateway.end(), {"--region", address(i)});
  }
  gateway.insert(gateway.end(), common.begin(), common.end());
  if (with_gateway) start(gateway);
}

void WorldProcesses::start(const std::vector<std::string>& arguments) {
  auto child = ChildProcess::start(AUREOLE_BINARY, arguments);
  if (!child) throw std::runtime_error(child.error().message);
  children_.push_back(std::move(*child));
  await_ready(children_.back());
}

WorldProcesses::~WorldProcesses() {
  for (const ChildProcess& child : children_) child.signal(SIGTERM);
  const auto limit = Clock::now() + 2s;
  for (ChildProcess& child : children_)
    while (child.is_running() && Clock::now() < limit) {
      child.read(Output::error, [](const std::string&) {});
      std::this_thread::sleep_for(5ms);
    }
}

std::vector<PeerAddress> WorldProcesses::addresses() const {
  std::vector<PeerAddress> all;
  for (std::size_t i = 0; i < ports_.size(); ++i)
    all.push_back({PeerId{static_cast<std::uint16_t>(i)}, {"127.0.0.1", ports_[i]}});
  return all;
}

std::string WorldProcesses::gateway_url(const std::string& path) const {
  return "http://127.0.0.1:" + std::to_string(gateway_port_) + path;
}

void WorldProcesses::await_gateway(std::chrono::seconds limit) {
  const auto end = Clock::now() + limit;
  std::string last;
  while (Clock::now() < end) {
    const auto answer = http_get(gateway_url("/healthz"), 1000);
    if (answer && answer->status == 200) return;
    last = answer ? answer->body : answer.error().message;
    std::this_thread::sleep_for(50ms);
  }
  throw std::runtime_error("the gateway did not become healthy: " + last);
}

Watcher::Watcher(const WorldDefinition& world, const std::vector<PeerAddress>& regions)
    : store_(world.prototypes.size()), regions_(regions.size()) {
  PeerLinksOptions options;
  options.self = PeerId::gateway(7);
  options.incarnation = Incarnation{1};
  options.world_hash = world.hash;
  options.dial = regions;
  links_ = std::make_unique<PeerLinks>(
      io_, std::move(options), clock_,
      PeerLinks::Events{
          [this](PeerId peer, const PeerHello&) { store_.region_up(peer.as_region()); },
          [this](PeerId peer, const std::string&) { store_.region_down(peer.as_region()); },
          [this](PeerId peer, const Frame& frame) -> Status {
            if (frame.type == FrameType::region_status)
              hosted_[peer.as_region()] = verified<wire::RegionStatus>(frame.payload)->bodies();
            if (frame.type != FrameType::replica_update) return Ok{};
            auto taken = store_.apply(peer.as_region(), frame.payload);
            if (!taken) faults_.push_back(taken.error().message);
            std::vector<ReplicaPose> poses;
            store_.sample(0, poses);
            for (const ReplicaPose& pose : poses) {
              const Version version = *store_.version(pose.id);
              auto [it, fresh] = versions_.try_emplace(pose.id, version);
              if (it->second.region != version.region) ++owner_changes_;
              it->second = version;
            }
            return taken;
          },
          [] { return false; },
          {},
      });
  links_->start();
}

Watcher::~Watcher() {
  links_->stop();
  io_.restart();
  io_.run_for(100ms);
}

bool Watcher::watch(const std::function<bool()>& done, std::chrono::seconds limit) {
  const auto end = Clock::now() + limit;
  while (!done()) {
    if (Clock::now() > end) return false;
    io_.restart();
    io_.run_for(5ms);
  }
  return true;
}

void Watcher::watch_for(std::chrono::milliseconds time) {
  const auto end = Clock::now() + time;
  watch([&] { return Clock::now() > end; },
        std::chrono::duration_cast<std::chrono::seconds>(time) + 1s);
}

std::size_t Watcher::hosted() const {
  std::size_t all = 0;
  for (const auto& [region, bodies] : hosted_) all += bodies;
  return all;
}

bool Watcher::all_complete() const {
  for (std::size_t i = 0; i < regions_; ++i)
    if (!store_.is_complete(RegionId{static_cast<std::uint16_t>(i)})) return false;
  return true;
}

void Watcher::command(RegionId to, const PlayerCommand& command) {
  links_->send(PeerId::region(to),
               std::make_shared<const Bytes>(
                   encode_frame(FrameType::commands, 0, encode_commands(std::span(&command, 1)))));
}

std::filesystem::path temporary_file(const std::string& name, const std::string& text) {
  static std::deque<TemporaryFolder> folders;  // They go with the test's process.
  const auto path = folders.emplace_back().path() / name;
  std::ofstream(path) << text;
  return path;
}

}  // namespace aureole::testing
