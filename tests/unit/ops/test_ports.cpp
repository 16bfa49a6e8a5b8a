// Free and taken ports of this machine, as the kernel sees them.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <set>

#include "server/ops/ports.h"
#include "server/ops/process/incarnation.h"
#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("a port is taken while somebody listens on it, and free afterwards") {
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(bind(fd, reinterpret_cast<sockaddr*>(&at), sizeof at) == 0);
  REQUIRE(::listen(fd, 1) == 0);
  socklen_t size = sizeof at;
  getsockname(fd, reinterpret_cast<sockaddr*>(&at), &size);
  const auto port = ntohs(at.sin_port);

  const Status taken = check_port_is_free("127.0.0.1", port);
  REQUIRE_FALSE(taken);
  REQUIRE(taken.error().message == "port " + std::to_string(port) + " is taken by another program");
  // Listening everywhere would meet the same listener.
  REQUIRE_FALSE(check_port_is_free("0.0.0.0", port));
  close(fd);
  REQUIRE(check_port_is_free("127.0.0.1", port));
}

TEST_CASE("an address that is a name, or of another machine, is refused with a sentence") {
  REQUIRE(check_port_is_free("localhost", 8080).error().message.find("not a numeric address") !=
          std::string::npos);
  // 192.0.2.0/24 belongs to nobody (RFC 5737).
  REQUIRE(check_port_is_free("192.0.2.1", 8080).error().message.find("cannot be used") !=
          std::string::npos);
}

TEST_CASE("free ports differ from each other and lie below those of outgoing connections") {
  const auto ports = free_loopback_ports(64, 7);
  REQUIRE(ports);
  REQUIRE(std::set(ports->begin(), ports->end()).size() == 64);
  for (const auto port : *ports) REQUIRE((port >= 15'000 && port < 32'000));
  const auto elsewhere = free_loopback_ports(4, 8);
  REQUIRE(elsewhere);
  REQUIRE(std::abs(elsewhere->front() - ports->front()) > 64);
}

TEST_CASE("each start has a higher incarnation than the one before") {
  const auto first = incarnation_of_this_start();
  usleep(2);
  REQUIRE(incarnation_of_this_start() > first);
  REQUIRE(first.value > 1'600'000'000'000'000u);
}
