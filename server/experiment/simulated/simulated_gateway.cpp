// Frames from regions into the store, answers back.
#include "server/experiment/simulated/simulated_gateway.h"

#include <fmt/format.h>

#include "server/replica/recovery_answer.h"

namespace aureole {
namespace {

constexpr std::size_t refusals_max = 8;

}  // namespace

SimulatedGateway::SimulatedGateway(const WorldDefinition& world, std::size_t regions)
    : world_(world), self_(static_cast<End>(regions)), linked_(regions, false) {}

void SimulatedGateway::start(SimulatedNetwork& network, Micros now) {
  incarnation_ = Incarnation{incarnation_.value + 1};
  store_ = std::make_unique<ReplicaStore>(world_.prototypes.size());
  linked_.assign(linked_.size(), false);
  network.start(self_, incarnation_, now);
  wakes_at_us_ = now;
}

void SimulatedGateway::crash(SimulatedNetwork& network, Micros now) {
  store_.reset();
  network.kill(self_, now);
}

void SimulatedGateway::wake(SimulatedNetwork& network, Micros now) {
  for (const Delivery& delivery : network.take(self_, now)) take(network, delivery, now);
  wakes_at_us_ = now + interval_us;
}

void SimulatedGateway::take(SimulatedNetwork& network, const Delivery& delivery, Micros now) {
  const RegionId from{static_cast<std::uint16_t>(delivery.from)};
  switch (delivery.kind) {
    case Delivery::Kind::up:
      store_->region_up(from);
      linked_[from.value] = true;
      return;
    case Delivery::Kind::down:
      store_->region_down(from);
      linked_[from.value] = false;
      return;
    case Delivery::Kind::measured:
      return;
    case Delivery::Kind::frame:
      break;
  }
  if (!linked_[from.value]) return;
  const auto frame = decode_frame(*delivery.frame);
  Status taken = Ok{};
  if (!frame)
    taken = frame.error();
  else if (frame->type == FrameType::replica_update)
    taken = store_->apply(from, frame->payload);
  else if (frame->type == FrameType::recovery_query)
    taken = answer(network, from, *frame, now);
  if (taken) return;
  if (refusals_.size() < refusals_max)
    refusals_.push_back(fmt::format("from {}: {}", delivery.from, taken.error().message));
  store_->region_down(from);
  linked_[from.value] = false;
  network.reset(self_, delivery.from, now, interval_us);
}

void SimulatedGateway::send(SimulatedNetwork& network, RegionId to, SharedBytes frame, Micros now) {
  if (linked_[to.value]) network.send(self_, to.value, std::move(frame), now);
}

Status SimulatedGateway::answer(SimulatedNetwork& network, RegionId from, const FrameView& query,
                                Micros now) {
  const auto frames = answer_recovery(*store_, from, query.payload);
  if (!frames) return frames.error();
  for (const SharedBytes& frame : *frames) send(network, from, frame, now);
  return Ok{};
}

}  // namespace aureole
