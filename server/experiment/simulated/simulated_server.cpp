// The shell's loop in virtual time.
#include "server/experiment/simulated/simulated_server.h"

#include <algorithm>
#include <set>

#include "server/base/check.h"
#include "server/base/prefetch.h"

namespace aureole {
namespace {

constexpr int catch_up_steps_max = 2;
constexpr std::int64_t behind_ticks_max = 8;
constexpr std::size_t refusals_max = 8;
/// Clocks of servers agree this well, and timers are as late as this.
constexpr Micros phase_us_max = 1000;

}  // namespace

SimulatedServer::SimulatedServer(const WorldDefinition& world, RegionId self, std::uint64_t seed,
                                 SimulatedPace pace)
    : world_(world), self_(self), incarnation_(0), random_(seed, 100 + self.value), pace_(pace) {
  if (!pace_.even) phase_us_ = random_.below(static_cast<int>(phase_us_max));
  if (pace_.clocks.whole != nullptr) profile_ = std::make_unique<StepProfile>(pace_.clocks);
  if (pace_.own_heaps) thread_ = std::make_unique<ServerThread>();
}

void SimulatedServer::start(SimulatedNetwork& network, Micros now) {
  const bool again = incarnation_.value > 0;
  incarnation_ = Incarnation{incarnation_.value + 1};
  run([&] { core_ = std::make_unique<RegionCore>(world_, self_, incarnation_); });
  if (pace_.snapshots) core_->enable_snapshots();
  if (pace_.follow_latency) core_->follow_latency();
  core_->level_from(pace_.level_from, pace_.crowd_share);
  core_->profile_steps(profile_.get());
  if (again) {
    const std::span<const std::byte> snapshot =
        disk_.written ? std::span<const std::byte>(*disk_.written) : std::span<const std::byte>();
    if (auto recovered = core_->recover(snapshot); !recovered && refusals_.size() < refusals_max)
      refusals_.push_back("recover: " + recovered.error().message);
  }
  network.start(self_.value, incarnation_, now);
  next_tick_ = Tick{std::max<std::int64_t>(1, now / tick_us + 1)};
  wakes_at_us_ = next_tick_.value * tick_us + phase_us_;
  last_frame_ms_ = 0;
}

void SimulatedServer::crash(SimulatedNetwork& network, Micros now, bool lose_disk) {
  core_.reset();
  disk_.writing.reset();
  if (lose_disk) disk_ = {};
  slow_until_us_ = 0;
  network.kill(self_.value, now);
}

void SimulatedServer::slow_down(double frame_ms, Micros until) {
  slow_frame_ms_ = frame_ms;
  slow_until_us_ = until;
}

double SimulatedServer::draw_frame_ms(Micros at) {
  if (at < slow_until_us_) return slow_frame_ms_ * random_.between(0.9, 1.1);
  // For a second at a time a server has little to do or nearly as much as the tolerance of 15 ms
  // allows: then what it sends misses the receiver's next step, and must be caught up with.
  if (at >= load_until_us_) {
    busy_ = random_.chance(0.35);
    load_until_us_ = at + 1'000'000;
  }
  return busy_ ? random_.between(10, 13.9) : random_.between(1, 5);
}

void SimulatedServer::wake(SimulatedNetwork& network, Micros now, const Observer& observer) {
  AUREOLE_CHECK(core_ != nullptr, "only what runs wakes");
  run([&] { take_turn(network, now, observer); });
}

void SimulatedServer::take_turn(SimulatedNetwork& network, Micros now, const Observer& observer) {
  if (pace_.before_frame) pace_.before_frame();
  if (profile_) profile_->clear();
  take_deliveries(network, now);
  Micros at = now;
  int steps = 0;
  while (next_tick_.value <= at / tick_us && steps < catch_up_steps_max) {
    step(network, at, observer);
    at = step_ended_us_;
    ++steps;
  }
  // What was taken belongs to the step's stretch: to begin another one would ask the slow clock
  // again. Here it ends if there was no step.
  if (profile_) profile_->stop();
  if (const std::int64_t left_out = at / tick_us - next_tick_.value; left_out > behind_ticks_max) {
    skipped_ticks_ += static_cast<std::uint64_t>(left_out);
    next_tick_ = next_tick_ + left_out;
  }
  const Micros earliest = steps == catch_up_steps_max ? now + tick_us : at;
  wakes_at_us_ = std::max({earliest, at, next_tick_.value * tick_us + phase_us_});
}

void SimulatedServer::take_deliveries(SimulatedNetwork& network, Micros now) {
  std::set<End> closed;
  std::vector<Delivery> deliveries = network.take(self_.value, now);
  if (profile_) profile_->enter(StepProfile::Part::wire);
  // What a socket has been read into is near; what other servers wrote in their turns is not.
  for (const Delivery& delivery : deliveries)
    if (delivery.frame) prefetch_beginning(*delivery.frame);
  for (Delivery& delivery : deliveries) {
    const bool gateway = static_cast<std::size_t>(delivery.from) == world_.regions.size();
    const PeerId peer =
        gateway ? PeerId::gateway(0) : PeerId{static_cast<std::uint16_t>(delivery.from)};
    switch (delivery.kind) {
      case Delivery::Kind::up:
        core_->peer_up(peer, delivery.incarnation);
        break;
      case Delivery::Kind::down:
        core_->peer_down(peer);
        break;
      case Delivery::Kind::measured:
        core_->link_measured(peer.as_region(), delivery.latency_ms);
        break;
      case Delivery::Kind::frame: {
        if (closed.contains(delivery.from)) break;
        const auto frame = decode_frame(*delivery.frame);
        Status taken = frame ? core_->receive(peer, *frame) : Status(frame.error());
        if (taken) break;
        if (refusals_.size() < refusals_max)
          refusals_.push_back(fmt::format("from {}: {}", delivery.from, taken.error().message));
        // A refused message ends its link.
        network.reset(self_.value, delivery.from, now, tick_us);
        closed.insert(delivery.from);
        break;
      }
    }
  }
  // Frames that have been taken are given back in the server's own time.
  deliveries.clear();
}

void SimulatedServer::step(SimulatedNetwork& network, Micros at, const Observer& observer) {
  finish_write();
  ShellMeasurements measured;
  measured.last_frame_ms = last_frame_ms_;
  measured.skipped_ticks = skipped_ticks_;
  core_->step(next_tick_, measured);
  if (profile_) profile_->stop();
  last_frame_ms_ = pace_.even ? 0 : draw_frame_ms(at);
  // Not at once: a server that steps later at the same moment must not hear of it.
  step_ended_us_ = at + std::max<Micros>(1, static_cast<Micros>(last_frame_ms_ * 1000));
  for (const Outgoing& out : core_->outbox()) {
    const End to = out.to.is_region() ? out.to.value : static_cast<End>(world_.regions.size());
    network.send(self_.value, to, out.frame, step_ended_us_);
  }
  write_disk(next_tick_);
  observer(*this, {next_tick_, at, step_ended_us_});
  next_tick_ = next_tick_ + 1;
}

void SimulatedServer::write_disk(Tick tick) {
  auto due = core_->snapshot_due();
  if (!due || due == disk_.written) return;
  disk_.writing = std::move(due);
  disk_.writing_tick = tick;
  // Half of the writes are over at once, the others when the next step begins: a crash in between
  // finds the snapshot before.
  if (random_.chance(0.5)) finish_write();
}

void SimulatedServer::finish_write() {
  if (!disk_.writing) return;
  disk_.written = std::move(disk_.writing);
  disk_.writing.reset();
  core_->snapshot_written(disk_.writing_tick);
}

}  // namespace aureole
