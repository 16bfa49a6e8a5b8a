// Who is awake near a line, and how that travels.
#include "server/region/lines/crowd.h"

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/unit/region/lines/crowds.h"

using namespace aureole;
using testing::put;

TEST_CASE("a crowd is counted between any two places, a bin in part if they cut it") {
  Crowd crowd;
  put(crowd, -4, 8);
  put(crowd, 8, 20);
  CHECK(crowd.between(-56, 56) == 28);
  CHECK(crowd.between(-2, 9) == 4 + 5);
  CHECK(crowd.between(12, 56) == 0);
  CHECK(crowd.between(3, -3) == 0);
  CHECK(crowd.at(4) == 8 + 20);  // Whoever is within 8 m.
  CHECK(crowd.at(-6) == 8);
}

TEST_CASE("a crowd travels as a byte for each bin, nearly as it is") {
  Crowd crowd;
  put(crowd, -56, 0.5);
  put(crowd, 0, 37);
  put(crowd, 52, 12'345);
  const std::vector<std::uint8_t> bytes = crowd.encoded();
  REQUIRE(bytes.size() == 28);
  const auto read = Crowd::decoded(bytes);
  REQUIRE(read);
  for (std::size_t i = 0; i < crowd.awake.size(); ++i)
    CHECK(read->awake[i] == Approx(crowd.awake[i]).epsilon(0.026).margin(0.04));
  put(crowd, 8, 1e12);  // More than there can be: as many as a byte can say.
  CHECK(Crowd::decoded(crowd.encoded())->awake[16] == Approx(std::expm1(255 * std::log(1.05))));
}

TEST_CASE("a crowd of another size is refused, with what was expected") {
  for (const std::size_t size : {std::size_t{0}, std::size_t{27}, std::size_t{29}}) {
    const auto read = Crowd::decoded(std::vector<std::uint8_t>(size, 1));
    REQUIRE_FALSE(read);
    CHECK(read.error().message == "a crowd of " + std::to_string(size) + " bins; expected 28");
  }
}
