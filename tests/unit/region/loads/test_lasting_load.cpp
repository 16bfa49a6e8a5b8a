// How hard a server pushes at its lines: the harder the longer it has had more than the others.
#include "server/region/loads/lasting_load.h"

#include <cmath>

#include "tests/support/catch.h"

using namespace aureole;

namespace {

/// Looked at four times a second, as statuses go.
constexpr std::int64_t look_ticks = 16;
constexpr double looks_per_s = 1000.0 / 16 / look_ticks;

struct Server {
  LoadLevels levels{2, RegionId{0}, 1.0025};
  LastingLoad load;
  std::int64_t tick = 0;

  /// What is told at the end of so many seconds.
  double run(double seconds, double lately, double mean) {
    double told = 0;
    for (int look = 0; look < seconds * looks_per_s; ++look) {
      load.note_awake(lately, mean);
      told = load.tell(Tick{tick += look_ticks}, lately, levels);
    }
    return told;
  }
};

}  // namespace

TEST_CASE("who has as much as the others tells the mean, however that comes and goes") {
  Server server;
  CHECK(server.run(60, 1000, 1000) == 1000);
  for (int second = 0; second < 60; ++second)
    server.run(1, second % 2 == 0 ? 1100 : 1000 / 1.1, 1000);
  CHECK(server.load.told() == Approx(1000).epsilon(0.005));
  // The mean itself follows what there is in some 20 s.
  CHECK(server.run(20, 2000, 2000) == Approx(1632).epsilon(0.01));
}

TEST_CASE("a difference of two hundredths that lasts pushes as hard as a larger one, in the end") {
  Server server;
  double before = 1000;
  for (int n = 0; n < 4; ++n) {
    const double told = server.run(15, 1020, 1000);
    CHECK(told > before + 5);  // 1,010 where it is summed up over 30 s.
    before = told;
  }
  CHECK(before > 1030);
  Server with_less;
  CHECK(with_less.run(60, 980, 1000) < 970);
}

TEST_CASE("what has been summed up has bounds, and goes back by itself") {
  Server server;
  const double most = server.run(600, 5000, 1000);
  CHECK(most == Approx(1000 * std::exp(0.25)));
  CHECK(server.run(120, 1000, 1000) < 1000 * std::exp(0.25 / 2));
}

TEST_CASE("who has far less than the others says so before differences have been summed up") {
  Server server;
  CHECK(server.run(20, 180, 1000) == Approx(360));
  CHECK(server.run(0.1, 140, 1000) > 355);  // What comes and goes is smoothed here too.
  // But nobody tells a world of which it knows nothing.
  Server alone;
  CHECK(alone.run(1, 150, 0) == 0);
}

TEST_CASE("who calms down tells of less at once, and for ten seconds nothing when all is calm") {
  Server server;
  server.run(60, 1000, 1000);
  CHECK(server.run(0.1, 600, 1000) > 990);  // As it comes and goes.
  CHECK(server.run(0.1, 250, 1000) < 520);
  CHECK(server.run(0.1, 100, 1000) == 0);  // Below what counts.
  CHECK(server.run(9, 1000, 1000) == 0);
  CHECK(server.run(2, 1000, 1000) > 900);
}

TEST_CASE("who has calmed down has forgotten what it had too much of") {
  Server server;
  REQUIRE(server.run(60, 1200, 1000) > 1200);
  server.run(1, 0, 1000);
  CHECK(server.run(10.5, 1000, 1000) <= 1000);
}
