// Scene `handoff`: groups leave one server's world and come into another's.
#include <algorithm>
#include <array>

#include "server/base/check.h"
#include "server/bench/samples.h"
#include "server/bench/situations.h"
#include "server/region/hosting.h"

namespace aureole {
namespace {

/// Groups that leave one after the other, each from another place.
constexpr int groups_per_repeat = 8;
constexpr std::array<std::size_t, 4> group_sizes{1, 10, 100, 1000};

/// The body that lies in the middle of those that are left, and those around it; ascending.
std::vector<BodyId> group_around(const PhysicsWorld& physics, std::size_t pick, std::size_t size) {
  const std::span<const BodyId> ids = physics.ids();
  const WorldPosition middle = physics.position(ids[pick * 7919 % ids.size()]);
  std::vector<std::pair<double, BodyId>> by_distance;
  for (BodyId id : ids) by_distance.emplace_back(distance(physics.position(id), middle), id);
  std::sort(by_distance.begin(), by_distance.end());
  std::vector<BodyId> group;
  for (std::size_t i = 0; i < std::min(size, by_distance.size()); ++i)
    group.push_back(by_distance[i].second);
  std::sort(group.begin(), group.end());
  return group;
}

struct Measured {
  explicit Measured(const std::string& group)
      : release(group, "release (bodies, contacts)"),
        encode(group, "encode"),
        decode(group, "decode and check"),
        accept(group, "accept (bodies, contacts)") {}
  Samples release, encode, decode, accept;
};

void hand_over(Hosting& from, Hosting& to, std::span<const BodyId> ids, Measured& measured) {
  constexpr Tick now{1000};
  Hosting::Released released;
  const double release_us =
      cpu_us_of([&] { released = from.release(ids, now, Hosting::Cut::at_rest); });
  const HandoffGroup& group = released.group;
  Bytes payload;
  const double encode_us = cpu_us_of([&] { payload = encode_handoff(group); });
  Result<HandoffGroup> read = Error{};
  const double decode_us = cpu_us_of(
      [&] { read = decode_handoff(payload, from.definitions().size(), from.statics().size()); });
  AUREOLE_CHECK(read, "what was encoded here can be read back");
  // What an earlier group took along is a body there, as whoever leans on it needs it to be.
  std::erase_if(read->stand_ins, [&](const NewBody& body) { return to.hosts(body.id); });
  to.physics().add_stand_ins(read->stand_ins);
  std::vector<BodyId> taken;
  const double accept_us = cpu_us_of([&] { taken = to.accept(*read, RegionId{0}, now + 1); });
  AUREOLE_CHECK(taken.size() == ids.size(), "the whole group is taken");
  const auto awake = static_cast<std::size_t>(
      std::count_if(group.bodies.begin(), group.bodies.end(),
                    [](const auto& b) { return b.body.state.activation != Activation::asleep; }));
  const Samples::Size size{ids.size(), awake, payload.size()};
  measured.release.add(release_us, size);
  measured.encode.add(encode_us, size);
  measured.decode.add(decode_us, size);
  measured.accept.add(accept_us, size);
}

}  // namespace

std::vector<BenchRow> bench_handoff(const BenchOptions& options) {
  const Situation situation = poured(options);
  std::vector<BenchRow> rows;
  for (const std::size_t size : group_sizes) {
    if (2 * size > situation.bodies.size()) break;
    Measured measured(std::to_string(size) + (size == 1 ? " body" : " bodies"));
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
      Hosting from(situation.world, RegionId{0}, Incarnation{1});
      Hosting to(situation.world, RegionId{1}, Incarnation{1});
      from.spawn(situation.bodies);
      from.physics().install_contacts(situation.contacts);
      for (int n = 0; n < groups_per_repeat && from.physics().size() >= 2 * size; ++n)
        hand_over(from, to, group_around(from.physics(), static_cast<std::size_t>(n + 1), size),
                  measured);
    }
    for (Samples* one : {&measured.release, &measured.encode, &measured.decode, &measured.accept})
      rows.push_back(one->row());
  }
  return rows;
}

}  // namespace aureole
