// Messages taken apart, sums kept.
#include "server/measure/wire_census.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "protocol/wire.h"
#include "protocol/wire_values.h"
#include "server/base/check.h"
#include "server/region/auras/aura_wire.h"

namespace aureole {
namespace {

using aura_wire::asleep_flag;
using aura_wire::resting_flag;

template <class List>
std::size_t size_of(const List* list) {
  return list == nullptr ? 0 : list->size();
}

nlohmann::json ratio(std::uint64_t of, std::uint64_t to) {
  if (to == 0) return nullptr;
  return static_cast<double>(of) / static_cast<double>(to);
}

}  // namespace

WireCounts WireCounts::operator-(const WireCounts& before) const {
  WireCounts less = *this;
  less.aura_bytes -= before.aura_bytes;
  less.resting_bytes -= before.resting_bytes;
  less.sign_of_life_bytes -= before.sign_of_life_bytes;
  less.moving_auras -= before.moving_auras;
  less.replica_bytes -= before.replica_bytes;
  less.key_bytes -= before.key_bytes;
  less.moving_replicas -= before.moving_replicas;
  return less;
}

nlohmann::json to_json(const WireCounts& c) {
  return {{"aura_bytes_per_moving_tick", ratio(c.aura_bytes, c.moving_auras)},
          {"aura_resting_share", ratio(c.resting_bytes, c.aura_bytes)},
          {"replica_bytes_per_moving_tick", ratio(c.replica_bytes, c.moving_replicas)},
          {"replica_key_share", ratio(c.key_bytes, c.replica_bytes)},
          {"moving_auras", c.moving_auras},
          {"aura_bytes", c.aura_bytes},
          {"resting_bytes", c.resting_bytes},
          {"sign_of_life_bytes", c.sign_of_life_bytes},
          {"moving_replicas", c.moving_replicas},
          {"replica_bytes", c.replica_bytes},
          {"key_bytes", c.key_bytes}};
}

void WireCensus::note(int from, int to, const Bytes& bytes) {
  const auto frame = decode_frame(bytes);
  AUREOLE_CHECK(frame, "a core's own frame can be read");
  if (frame->type == FrameType::auras) note_auras(links_[{from, to}], *frame);
  if (frame->type == FrameType::replica_update && to == gateway_) note_replicas(from, *frame);
}

void WireCensus::note_auras(Link& link, const FrameView& frame) {
  const auto* message = verified<wire::Auras>(frame.payload);
  AUREOLE_CHECK(message != nullptr, "a core's own message is valid");
  const auto know = [&](std::uint64_t body, bool moves) {
    bool& known = link.moves[body];
    if (moves && !known) ++link.moving;
    if (!moves && known) --link.moving;
    known = moves;
  };
  const auto forget = [&](const flatbuffers::Vector<std::uint64_t>* list) {
    if (list == nullptr) return;
    for (const std::uint64_t body : *list) {
      know(body, false);
      link.moves.erase(body);
    }
  };
  forget(message->removed());
  forget(message->handed_over());
  const auto moves = [](std::uint8_t flags) { return (flags & (asleep_flag | resting_flag)) == 0; };
  if (message->auras() != nullptr)
    for (const wire::Aura* aura : *message->auras()) {
      know(aura->id(), moves(aura->flags()));
      link.slots[aura->slot()] = aura->id();
    }
  if (message->moved() != nullptr)
    for (const wire::AuraMotion* aura : *message->moved())
      know(link.slots[aura->slot()], moves(aura->flags()));
  const std::size_t resting = size_of(message->resting());
  const bool says_something = size_of(message->auras()) + size_of(message->moved()) + resting +
                                  size_of(message->removed()) + size_of(message->handed_over()) +
                                  size_of(message->pulls()) >
                              0;
  const std::uint64_t resting_bytes = resting * sizeof(wire::Resting);
  counts_.resting_bytes += resting_bytes;
  (says_something ? counts_.aura_bytes : counts_.sign_of_life_bytes) +=
      frame.payload.size() - resting_bytes;
  counts_.moving_auras += link.moving;
}

void WireCensus::moved(Pose& known, const Pose& now) {
  if (!(known == now)) ++counts_.moving_replicas;
  known = now;
}

void WireCensus::note_replicas(int from, const FrameView& frame) {
  const auto* message = verified<wire::ReplicaUpdate>(frame.payload);
  AUREOLE_CHECK(message != nullptr, "a core's own message is valid");
  auto& poses = poses_[from];
  if (message->motions() != nullptr) {
    for (const wire::ReplicaMotion* motion : *message->motions()) {
      Pose pose;
      std::copy(motion->position()->begin(), motion->position()->end(), pose.position.begin());
      std::copy(motion->orientation()->begin(), motion->orientation()->end(),
                pose.orientation.begin());
      moved(poses[slot_of(*motion)], pose);
    }
  }
  const std::size_t keys = size_of(message->keys());
  if (message->keys() != nullptr)
    for (const wire::ReplicaKey* key : *message->keys())
      moved(poses[key->slot()],
            {quantise(from_wire(key->position())), quantise(from_wire(key->orientation()))});
  const std::uint64_t key_bytes = keys * sizeof(wire::ReplicaKey);
  counts_.key_bytes += key_bytes;
  counts_.replica_bytes += frame.payload.size() - key_bytes;
}

}  // namespace aureole
