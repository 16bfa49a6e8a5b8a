// The stream of an injector: repeatable, uniform, and counted by world time alone.
#include "server/worlds/injector.h"

#include <map>
#include <set>

#include "tests/support/catch.h"

namespace aureole {
namespace {

Injector example() {
  Injector i;
  i.rate_per_s = 160;
  i.volume = {{-10, 5, -75}, {10, 25, 75}};
  i.velocity_min = {-10, -10, -10};
  i.velocity_max = {10, 0, 10};
  i.mix = {{PrototypeId{3}, 1}, {PrototypeId{5}, 2}, {PrototypeId{7}, 1}};
  i.seed = 42;
  i.duration_s = 60;
  return i;
}

}  // namespace

TEST_CASE("the n-th body is the same whoever computes it, and others are others") {
  const Injector a = example();
  std::set<double> xs;
  for (std::uint64_t n = 0; n < 1000; ++n) {
    const InjectedBody one = injected_body(a, n), two = injected_body(a, n);
    REQUIRE(one.n == n);
    REQUIRE(one.prototype == two.prototype);
    REQUIRE(one.state.position == two.state.position);
    REQUIRE(one.state.linear_velocity == two.state.linear_velocity);
    xs.insert(one.state.position.x);
  }
  CHECK(xs.size() == 1000);
  Injector b = a;
  b.seed = 43;
  for (std::uint64_t n = 0; n < 1000; ++n)
    CHECK_FALSE(xs.contains(injected_body(b, n).state.position.x));
}

TEST_CASE("positions, velocities and prototypes are uniform in their ranges") {
  const Injector i = example();
  constexpr int count = 20'000;
  Eigen::Vector3d position{0, 0, 0}, velocity{0, 0, 0};
  std::map<std::uint16_t, int> made;
  for (std::uint64_t n = 0; n < count; ++n) {
    const InjectedBody b = injected_body(i, n);
    const Eigen::Vector3d p = b.state.position.vector(), v = b.state.linear_velocity.cast<double>();
    REQUIRE((p.array() >= i.volume.min.array() && p.array() <= i.volume.max.array()).all());
    REQUIRE((v.array() >= -10 && v.array() <= 10).all());
    REQUIRE(v.y() <= 0);
    position += p / count;
    velocity += v / count;
    ++made[b.prototype.value];
  }
  // Six standard errors of a mean of 20,000: width / sqrt(12 × 20,000) × 6 = 1.2 % of the width.
  CHECK(std::abs(position.x() - 0) < 0.25);
  CHECK(std::abs(position.y() - 15) < 0.25);
  CHECK(std::abs(position.z() - 0) < 1.84);
  CHECK(std::abs(velocity.x() - 0) < 0.25);
  CHECK(std::abs(velocity.y() + 5) < 0.13);
  CHECK(std::abs(velocity.z() - 0) < 0.25);
  // Binomial, six standard deviations: 6 × sqrt(20,000 × p (1 − p)) ≤ 425.
  CHECK(std::abs(made[3] - 5000) < 425);
  CHECK(std::abs(made[5] - 10000) < 425);
  CHECK(std::abs(made[7] - 5000) < 425);
}

TEST_CASE("the count follows world time, starts late and ends with the duration") {
  Injector i = example();
  CHECK(injected_count(i, Tick{0}) == 0);
  CHECK(injected_count(i, Tick{1}) == 2);    // 160/s × 0.016 s = 2.56
  CHECK(injected_count(i, Tick{25}) == 64);  // exactly
  CHECK(injected_count(i, Tick{3750}) == 9600);
  CHECK(injected_count(i, Tick{100'000}) == 9600);
  i.start_s = 1.6;
  CHECK(injected_count(i, Tick{100}) == 0);
  CHECK(injected_count(i, Tick{125}) == 64);
  CHECK(injected_count(i, Tick{100'000}) == 9600);
  std::uint64_t before = 0;
  for (std::int64_t t = 0; t < 5000; ++t) {
    const std::uint64_t now = injected_count(i, Tick{t});
    REQUIRE(now >= before);
    REQUIRE(now - before <= 3);
    before = now;
  }
}

}  // namespace aureole
