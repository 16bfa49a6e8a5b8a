// A request to stop arrives as a callback, once.
#include <boost/asio/steady_timer.hpp>
#include <csignal>

#include "server/ops/process/signals.h"
#include "tests/support/catch.h"

TEST_CASE("SIGTERM and SIGINT become a callback on the io_context") {
  const int wanted = GENERATE(SIGTERM, SIGINT);
  boost::asio::io_context io;
  int heard = 0;
  const aureole::StopSignals signals(io, [&](int number) { heard = number; });
  std::raise(wanted);
  io.run();
  REQUIRE(heard == wanted);
}

TEST_CASE("without a watch the io_context is not kept running") {
  boost::asio::io_context io;
  bool heard = false;
  {
    const aureole::StopSignals signals(io, [&](int) { heard = true; });
  }
  io.run();
  REQUIRE_FALSE(heard);
}
