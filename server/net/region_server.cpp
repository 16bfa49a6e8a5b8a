// The shell around a RegionCore: links feed it, a clock steps it, its outbox goes back to the
// links.
#include "server/net/region_server.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cmath>
#include <optional>

#include "protocol/wire.h"
#include "server/net/links/handshake.h"
#include "server/net/tolerance_log.h"
#include "server/ops/frame_statistics.h"
#include "server/region/region_core.h"

namespace aureole {
namespace {

using boost::system::error_code;

/// A server that falls behind may take this many steps in the time of one…
constexpr int catch_up_steps_max = 2;
/// … and once it is this far behind it leaves ticks out: it never pretends.
constexpr std::int64_t behind_ticks_max = 8;
/// Overruns are counted one by one and told of in one line for this many ticks (5 s).
constexpr std::int64_t report_interval_ticks = 312;
/// A whole world that starts again from its disks goes on so many ticks after region 0's state:
/// later than any other region's.
constexpr std::int64_t state_margin = 2 * RegionCore::snapshot_interval_ticks;

}  // namespace

struct RegionServer::Impl {
  boost::asio::io_context& io;
  RegionServerOptions options;
  std::function<void(const std::string&)> failed;
  std::size_t region_count;
  RegionCore core;
  WorldClock clock;
  std::optional<PeerLinks> links;
  boost::asio::steady_timer timer;
  FrameStatistics frames{tick_us};
  bool begun = false;
  bool stopped = false;
  Tick next_tick, next_report;
  double last_frame_ms = 0;
  ToleranceLog tolerance_log;
  std::uint64_t skipped_ticks = 0;
  std::uint64_t reported_overruns = 0;
  std::uint64_t reported_skipped = 0;
  std::uint64_t reported_let_go = 0;
  Tick found_tick;          ///< Of the state on the disk; 0: none.
  bool world_runs = false;  ///< Others step already.
  bool told_recovered = true;
  std::string told_waits_for;
  bool disk_failed = false;

  Impl(boost::asio::io_context& context, const WorldDefinition& world, RegionServerOptions o,
       std::function<void(const std::string&)> on_failure)
      : io(context),
        options(std::move(o)),
        failed(std::move(on_failure)),
        region_count(world.regions.size()),
        core(world, options.self, options.incarnation),
        timer(context) {
    PeerLinksOptions link_options;
    link_options.self = PeerId::region(options.self);
    link_options.incarnation = options.incarnation;
    link_options.world_hash = world.hash;
    link_options.region_count = region_count;
    link_options.secret = options.secret;
    for (const PeerAddress& address : options.regions)
      if (address.peer < link_options.self) link_options.dial.push_back(address);
    if (options.state) find_state();
    links.emplace(io, std::move(link_options), clock,
                  PeerLinks::Events{
                      [this](PeerId peer, const PeerHello& hello) { up(peer, hello); },
                      [this](PeerId peer, const std::string&) { core.peer_down(peer); },
                      [this](PeerId peer, const FrameView& f) { return core.receive(peer, f); },
                      [this] { return begun; },
                      [this](PeerId peer, const Refusal& refusal) { refused(peer, refusal); },
                      [this](PeerId peer) { measured(peer); },
                  });
  }

  void refused(PeerId peer, const Refusal& refusal) {
    const std::string what =
        refusal.is_ours ? fmt::format("no link with {}: {}", describe(peer), refusal.reason)
                        : fmt::format("{} refused this server: {}", describe(peer), refusal.reason);
    // A world that runs is not ended by whoever happens to answer somewhere. A newer start of this
    // very region is another matter: two that simulate the same bodies help nobody.
    if (begun && !refusal.replaced)
      spdlog::error("{}", what);
    else
      fail(what);
  }

  void fail(const std::string& why) {
    if (stopped) return;
    stop();
    failed(why);
  }

  void stop() {
    stopped = true;
    timer.cancel();
    links->stop();
  }

  void up(PeerId peer, const PeerHello& hello) {
    const bool knows_this_start = hello.known_incarnation == options.incarnation;
    const bool knows_another_start = hello.known_incarnation != Incarnation{} && !knows_this_start;
    world_runs |= peer.is_region() && hello.running;
    // A world begins when all are linked: one that runs without this server had an earlier start.
    const bool succeeds = knows_another_start || (hello.running && !knows_this_start);
    if (!begun && succeeds && !core.recovering()) recover({});
    core.peer_up(peer, hello.incarnation);
    if (!begun) begin_if_ready();
  }

  /// The shortest of recent round trips: the others have waited for a step on one of the two sides,
  /// and that is frame time, not latency.
  void measured(PeerId peer) {
    if (!begun || !peer.is_region() || peer.value >= region_count) return;
    core.link_measured(peer.as_region(), static_cast<double>(links->round_trip_us(peer)) / 2e3);
  }

  void find_state() {
    core.enable_snapshots();
    const auto found = options.state->newest();
    if (!found) return;
    if (!is_wire_tick(found->tick.value) || found->tick < Tick{}) {
      spdlog::error("the state on the disk counts as none: it is of tick {}; expected 0 to {}",
                    found->tick.value, wire_tick_max);
      return recover({});
    }
    found_tick = found->tick;
    recover(found->bytes);
  }

  void recover(std::span<const std::byte> snapshot) {
    told_recovered = false;
    const Status read = core.recover(snapshot);
    if (!read) spdlog::error("the state on the disk counts as none: {}", read.error().message);
    spdlog::warn("an earlier start of r{} ended; {}", options.self.value,
                 !snapshot.empty() && read
                     ? fmt::format("going on from its state of tick {}", found_tick.value)
                     : "asking the others what they know of its bodies");
  }

  bool all_linked() const {
    for (std::size_t i = 0; i < region_count; ++i) {
      const PeerId peer = PeerId::region(RegionId{static_cast<std::uint16_t>(i)});
      if (i != options.self.value && !links->is_linked(peer)) return false;
    }
    return true;
  }

  void begin_if_ready() {
    if (begun || stopped) return;
    // Region 0 sets the clock, unless others have one already: then it goes on with theirs.
    if (options.self.value == 0 && all_linked() && (!world_runs || clock.is_set()))
      clock.start_as_reference(
          monotonic_us(), found_tick.value == 0 ? 0 : (found_tick + state_margin).value * tick_us);
    // Whoever recovers can say so, and answer others who do, before everyone is there.
    if (!clock.is_set() || !(all_linked() || core.recovering())) return;
    begun = true;
    next_tick = Tick{*clock.world_us(monotonic_us()) / tick_us + 1};
    next_report = next_tick + report_interval_ticks;
    tolerance_log.begin(next_tick);
    spdlog::info("the world runs, from tick {} on", next_tick.value);
    wait_until(clock.local_us(next_tick.value * tick_us));
  }

  /// Until region 0 has set the clock, asks again and again.
  void await_beginning() {
    if (begun || stopped) return;
    begin_if_ready();
    if (begun) return;
    timer.expires_after(std::chrono::milliseconds(5));
    timer.async_wait([this](const error_code& ec) {
      if (!ec) await_beginning();
    });
  }

  void wait_until(std::int64_t local_us) {
    timer.expires_at(std::chrono::steady_clock::time_point(std::chrono::microseconds(local_us)));
    timer.async_wait([this](const error_code& ec) {
      if (!ec && !stopped) wake();
    });
  }

  void wake() {
    const std::int64_t woken_us = monotonic_us();
    const auto due = [&] { return *clock.world_us(monotonic_us()) / tick_us; };
    int steps = 0;
    while (next_tick.value <= due() && steps < catch_up_steps_max) {
      step();
      ++steps;
    }
    if (due() - next_tick.value > behind_ticks_max) {
      const std::int64_t left_out = due() - next_tick.value;
      skipped_ticks += static_cast<std::uint64_t>(left_out);
      next_tick = next_tick + left_out;
    }
    report();
    report_recovery();
    const std::int64_t earliest = steps == catch_up_steps_max ? woken_us + tick_us : 0;
    wait_until(std::max(earliest, clock.local_us(next_tick.value * tick_us)));
  }

  void step() {
    const std::int64_t from_us = monotonic_us();
    core.step(next_tick, {static_cast<std::uint32_t>(std::lround(frames.p50_ms() * 1000)),
                          static_cast<std::uint32_t>(std::lround(frames.max_ms() * 1000)),
                          frames.overruns(), skipped_ticks, last_frame_ms});
    for (const Outgoing& out : core.outbox()) links->send(out.to, out.frame);
    write_state();
    const std::int64_t done_us = monotonic_us();
    frames.add(done_us - from_us);
    // Others wait for the messages of a step from its tick on, whether it was long or began late.
    const std::int64_t due_us = std::min(from_us, clock.local_us(next_tick.value * tick_us));
    last_frame_ms = static_cast<double>(done_us - due_us) / 1e3;
    tolerance_log.add(next_tick, core.tolerance_events());
    next_tick = next_tick + 1;
  }

  void write_state() {
    const SharedBytes snapshot = core.snapshot_due();
    if (!snapshot || !options.state) return;
    if (auto ok = options.state->write(*snapshot, options.incarnation, next_tick); !ok) {
      // The world goes on; what others hold for us they go on holding.
      if (!disk_failed) spdlog::error("the state cannot be written: {}", ok.error().message);
      disk_failed = true;
      return;
    }
    disk_failed = false;
    core.snapshot_written(next_tick);
  }

  void report_recovery() {
    if (told_recovered) return;
    if (!core.recovering()) {
      told_recovered = true;
      const RegionStatistics s = core.statistics();
      spdlog::info("recovered {} bodies at tick {}", s.recovered, next_tick.value);
      if (s.unrecoverable > 0)
        spdlog::error("{} bodies are known by name, but nobody knows where they were",
                      s.unrecoverable);
      return;
    }
    const std::string waits_for = fmt::format("{}", fmt::join(core.recovery_waits_for(), ", "));
    if (waits_for != told_waits_for) spdlog::info("recovering; waiting for {}", waits_for);
    told_waits_for = waits_for;
  }

  void report() {
    if (next_tick < next_report) return;
    next_report = next_tick + report_interval_ticks;
    const std::uint64_t overruns = frames.overruns() - reported_overruns;
    const std::uint64_t skipped = skipped_ticks - reported_skipped;
    if (overruns + skipped > 0)
      spdlog::warn(
          "outside the frame-time tolerance: {} steps of the last 5 s took longer than 16 ms "
          "(the longest {:.1f} ms), {} ticks were left out, at tick {}",
          overruns, frames.max_ms(), skipped, next_tick.value);
    reported_overruns = frames.overruns();
    reported_skipped = skipped_ticks;
    const std::uint64_t let_go = core.statistics().let_go;
    if (let_go > reported_let_go)
      spdlog::error(
          "let go {} messages that a neighbour has taken, but not written to its disk for long; "
          "what it had of them is lost if it dies now",
          let_go - reported_let_go);
    reported_let_go = let_go;
  }
};

RegionServer::RegionServer(boost::asio::io_context& io, const WorldDefinition& world,
                           RegionServerOptions options,
                           std::function<void(const std::string&)> failed)
    : impl_(std::make_unique<Impl>(io, world, std::move(options), std::move(failed))) {}

RegionServer::~RegionServer() = default;

Result<std::uint16_t> RegionServer::start() {
  auto port = impl_->links->listen(impl_->options.listen);
  if (!port) return port;
  impl_->links->start();
  impl_->await_beginning();
  return port;
}

void RegionServer::stop() {
  impl_->stop();
}

}  // namespace aureole
