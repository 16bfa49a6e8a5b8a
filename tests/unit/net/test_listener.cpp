// Listening: who comes is handed on, and what keeps a place from being listened at is said.
#include "server/net/listener.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <boost/asio/connect.hpp>
#include <chrono>

#include "tests/support/catch.h"

using namespace aureole;
using boost::asio::ip::tcp;

namespace {

const boost::asio::ip::address here = boost::asio::ip::make_address("127.0.0.1");

/// Nothing is opened by this process while it lives, but what was open before stays.
class NoMoreDescriptors {
 public:
  NoMoreDescriptors() {
    const int lowest_free = dup(STDERR_FILENO);
    REQUIRE(lowest_free >= 0);
    close(lowest_free);
    REQUIRE(getrlimit(RLIMIT_NOFILE, &before_) == 0);
    rlimit fewer = before_;
    fewer.rlim_cur = static_cast<rlim_t>(lowest_free);
    REQUIRE(setrlimit(RLIMIT_NOFILE, &fewer) == 0);
  }
  ~NoMoreDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }
  NoMoreDescriptors(const NoMoreDescriptors&) = delete;
  NoMoreDescriptors& operator=(const NoMoreDescriptors&) = delete;

 private:
  rlimit before_{};
};

}  // namespace

TEST_CASE("a port that somebody else listens on, and an address that is not here, are named") {
  boost::asio::io_context io;
  const auto one = std::make_shared<Listener>(io, [](tcp::socket) {});
  const auto port = one->listen({"127.0.0.1", 0});
  REQUIRE(port);
  const auto other = std::make_shared<Listener>(io, [](tcp::socket) {});
  CHECK(other->listen({"127.0.0.1", *port}).error().message ==
        fmt::format("port {} of 127.0.0.1 is taken by another program", *port));
  // 192.0.2.0/24 is for documentation: nobody has it.
  const auto nowhere = std::make_shared<Listener>(io, [](tcp::socket) {});
  CHECK(nowhere->listen({"192.0.2.1", 7}).error().message.starts_with(
      "cannot listen on 192.0.2.1:7: "));
}

TEST_CASE("who comes while there are no descriptors left is accepted once there are") {
  boost::asio::io_context io;
  std::size_t accepted = 0;
  const auto listener = std::make_shared<Listener>(io, [&](tcp::socket) { ++accepted; });
  const auto port = listener->listen({"127.0.0.1", 0});
  REQUIRE(port);
  tcp::socket client(io);
  client.open(tcp::v4());
  {
    const NoMoreDescriptors none;
    client.connect({here, *port});
    io.run_for(std::chrono::milliseconds(50));
    CHECK(accepted == 0);
  }
  io.run_for(std::chrono::milliseconds(500));
  CHECK(accepted == 1);
  listener->stop();
}

TEST_CASE("after stop() nobody is handed on, not even by the one that stopped it") {
  boost::asio::io_context io;
  std::size_t accepted = 0;
  std::shared_ptr<Listener> listener;
  listener = std::make_shared<Listener>(io, [&](tcp::socket) {
    ++accepted;
    listener->stop();
  });
  const auto port = listener->listen({"127.0.0.1", 0});
  REQUIRE(port);
  tcp::socket first(io), second(io);
  first.connect({here, *port});
  second.connect({here, *port});
  io.run_for(std::chrono::milliseconds(100));
  CHECK(accepted == 1);
  // What was under way has let go of it.
  const std::weak_ptr<Listener> weak = listener;
  listener.reset();
  CHECK(weak.expired());
}
