// Finds out by binding: nothing else tells the truth about a port.
#include "server/ops/ports.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace aureole {
namespace {

constexpr std::uint32_t lowest_port = 15'000;
constexpr std::uint32_t end_port = 32'000;  // outgoing connections begin at 32768

}  // namespace

Status check_port_is_free(const std::string& address, std::uint16_t port) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  addrinfo* found = nullptr;
  if (getaddrinfo(address.c_str(), std::to_string(port).c_str(), &wanted, &found) != 0) {
    return Error::format("'{}' is not a numeric address; expected one like 127.0.0.1", address);
  }
  int error = 0;
  const int fd = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) {
    error = errno;
  } else {
    // As servers do it: a port whose last connections are still timing out counts as free.
    const int yes = 1;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (bind(fd, found->ai_addr, found->ai_addrlen) != 0) error = errno;
    close(fd);
  }
  freeaddrinfo(found);
  if (error == 0) return Ok{};
  if (error == EADDRINUSE) return Error::format("port {} is taken by another program", port);
  return Error::format("port {} of {} cannot be used: {}", port, address, std::strerror(error));
}

Result<std::vector<std::uint16_t>> free_loopback_ports(int count, std::uint32_t seed) {
  std::vector<std::uint16_t> ports;
  constexpr std::uint32_t span = end_port - lowest_port;
  const std::uint32_t start = (seed * 2'654'435'761u >> 8) % span;  // spreads neighbouring seeds
  for (std::uint32_t i = 0; i < span && std::ssize(ports) < count; ++i) {
    const auto port = static_cast<std::uint16_t>(lowest_port + (start + i) % span);
    if (check_port_is_free("127.0.0.1", port)) ports.push_back(port);
  }
  if (std::ssize(ports) < count) {
    return Error::format("only {} of {} ports are free between {} and {}", ports.size(), count,
                         lowest_port, end_port);
  }
  return ports;
}

}  // namespace aureole
