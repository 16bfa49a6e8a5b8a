// A server's links with everything that they reported, and strangers that say whatever a test
// wants.
#pragma once

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/net/links/peer_links.h"
#include "tests/support/catch.h"

namespace aureole::testing {

inline constexpr std::uint64_t world_hash = 99;

/// One server's links with everything that they reported.
struct Server {
  WorldClock clock;
  std::vector<PeerId> up, down;
  std::vector<std::string> down_reasons;
  std::vector<Refusal> refusals;
  std::vector<Frame> frames;
  std::optional<PeerHello> hello;
  Status answer = Ok{};
  std::unique_ptr<PeerLinks> links;
  std::uint16_t port = 0;

  struct Options {
    std::vector<PeerAddress> dial = {};
    std::uint64_t world = world_hash;
    std::uint64_t incarnation = 1;
    std::size_t region_count = 16;
    std::size_t queue_bytes = 64u << 20;
    std::uint16_t port = 0;
    std::optional<Secret> secret = {};
  };

  Server(boost::asio::io_context& io, PeerId self) : Server(io, self, Options()) {}
  Server(boost::asio::io_context& io, PeerId self, Options given) {
    PeerLinksOptions options;
    options.self = self;
    options.incarnation = Incarnation{given.incarnation};
    options.world_hash = given.world;
    options.region_count = given.region_count;
    options.dial = std::move(given.dial);
    options.secret = std::move(given.secret);
    options.max_queued_bytes = given.queue_bytes;
    links = std::make_unique<PeerLinks>(
        io, std::move(options), clock,
        PeerLinks::Events{
            [this](PeerId p, const PeerHello& h) {
              up.push_back(p);
              hello = h;
            },
            [this](PeerId p, const std::string& why) {
              down.push_back(p);
              down_reasons.push_back(why);
            },
            [this](PeerId, Frame f) {
              frames.push_back(std::move(f));
              return answer;
            },
            [] { return true; },
            [this](PeerId, const Refusal& refusal) { refusals.push_back(refusal); },
        });
    port = *links->listen({"127.0.0.1", given.port});
    links->start();
  }
};

inline bool run_until(boost::asio::io_context& io, const std::function<bool()>& done) {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!done() && std::chrono::steady_clock::now() < limit) {
    io.restart();
    io.run_for(std::chrono::milliseconds(5));
  }
  return done();
}

inline PeerAddress at(PeerId peer, std::uint16_t port) {
  return {peer, {"127.0.0.1", port}};
}

inline SharedBytes message(std::size_t size) {
  return std::make_shared<const Bytes>(
      encode_frame(FrameType::commands, 0, Bytes(size, std::byte{7})));
}

/// Connects, sends raw bytes and waits until the other side hangs up. Returns what it said after
/// its challenge.
inline Bytes talk_raw(boost::asio::io_context& io, std::uint16_t port, const Bytes& bytes) {
  boost::asio::ip::tcp::socket socket(io);
  socket.connect({boost::asio::ip::address_v4::loopback(), port});
  boost::asio::write(socket, boost::asio::buffer(bytes));
  Bytes heard(4096);
  std::size_t got = 0;
  bool closed = false;
  boost::asio::async_read(socket, boost::asio::buffer(heard),
                          [&](const boost::system::error_code&, std::size_t n) {
                            got = n;
                            closed = true;
                          });
  REQUIRE(run_until(io, [&] { return closed; }));
  FrameReader reader(max_payload_bytes);
  REQUIRE(reader.feed(std::span(heard).first(got)));
  const auto challenge = reader.next();
  REQUIRE(challenge);
  REQUIRE(challenge->type == FrameType::challenge);
  const std::size_t first = sizeof(FrameHeader) + challenge->payload.size();
  return {heard.begin() + static_cast<std::ptrdiff_t>(first),
          heard.begin() + static_cast<std::ptrdiff_t>(got)};
}

}  // namespace aureole::testing
