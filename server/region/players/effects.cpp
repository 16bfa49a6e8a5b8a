// Blasts, removals and requests: to bytes and back, and the push of a blast.
#include "server/region/players/effects.h"

#include <cmath>

#include "protocol/quantise.h"
#include "protocol/wire_values.h"

namespace aureole {
namespace {

/// No body travels from farther away from the origin along any axis.
constexpr double blast_distance_max_m = 2 * position_limit_m;

}  // namespace

Bytes encode_effects(const EffectsMessage& message) {
  flatbuffers::FlatBufferBuilder builder(256);
  std::vector<wire::Blast> blasts;
  for (const auto& b : message.blasts)
    blasts.push_back(
        {b.id, b.tick.value, to_wire(b.position), b.radius_m, b.speed_mps, b.spared.value});
  std::vector<std::uint64_t> removals;
  for (BodyId id : message.removals) removals.push_back(id.value);
  std::vector<wire::BodyRequest> requests;
  for (const auto& r : message.requests) requests.push_back({r.body.value, r.player.value});
  builder.Finish(wire::CreateEffects(builder, builder.CreateVectorOfStructs(blasts),
                                     builder.CreateVector(removals),
                                     builder.CreateVectorOfStructs(requests)));
  const auto bytes = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
  return {bytes.begin(), bytes.end()};
}

Result<EffectsMessage> decode_effects(std::span<const std::byte> payload) {
  const auto* message = verified<wire::Effects>(payload);
  if (message == nullptr) return Error{"an effects message is not valid"};
  constexpr std::size_t most = EffectsMessage::max_of_a_kind;
  EffectsMessage effects;
  if (message->blasts() != nullptr) {
    if (message->blasts()->size() > most) return Error{"more than 4096 blasts in one message"};
    for (const auto* b : *message->blasts()) {
      BlastEffect blast{b->id(),       Tick{b->tick()}, from_wire(b->position()),
                        b->radius_m(), b->speed_mps(),  BodyId{b->spared()}};
      // Written so that what is not a number is out of range.
      const bool sane = is_wire_tick(b->tick()) &&
                        blast.position.vector().cwiseAbs().maxCoeff() <= blast_distance_max_m &&
                        blast.position.is_finite() && blast.radius_m > 0 &&
                        blast.radius_m <= 1000 && std::abs(blast.speed_mps) <= 1000;
      if (!sane) return Error{"a blast has numbers or a tick out of range"};
      effects.blasts.push_back(blast);
    }
  }
  if (message->removals() != nullptr) {
    if (message->removals()->size() > most) return Error{"more than 4096 removals in one message"};
    for (std::uint64_t id : *message->removals()) {
      // Whoever hosts an avatar decides itself when it goes; the world's own bodies never do.
      if (BodyId{id}.kind() != BodyId::Kind::thrown)
        return Error{"the removal of a body that nobody has thrown"};
      effects.removals.push_back(BodyId{id});
    }
  }
  if (message->requests() != nullptr) {
    if (message->requests()->size() > most) return Error{"more than 4096 requests in one message"};
    for (const auto* r : *message->requests()) {
      if (!BodyId{r->body()}.valid() || r->player() == 0)
        return Error{"a request for a body that cannot be"};
      effects.requests.push_back({BodyId{r->body()}, PlayerId{r->player()}});
    }
  }
  return effects;
}

void apply_blast(PhysicsWorld& world, const BlastEffect& blast) {
  for (BodyId id : world.overlapping_sphere(blast.position, blast.radius_m)) {
    if (id == blast.spared) continue;
    const BodyState state = world.state(id);
    // The push comes from a little below, so that things fly up instead of only sliding off.
    Eigen::Vector3f away = (state.position.vector() - blast.position.vector()).cast<float>() +
                           Eigen::Vector3f(0, 1, 0);
    const float distance = away.norm();
    if (distance >= blast.radius_m || distance < 1e-4f) continue;
    const float speed = blast.speed_mps * (1 - distance / blast.radius_m);
    world.set_velocity(id, state.linear_velocity + away / distance * speed, state.angular_velocity);
  }
}

}  // namespace aureole
