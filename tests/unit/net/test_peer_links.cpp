// Links between servers over loopback TCP: introductions, refusals, resets, hostile bytes.
#include "protocol/wire.h"
#include "server/net/links/handshake.h"
#include "server/net/links/peer_links.h"
#include "tests/unit/net/linked_server.h"

using namespace aureole;
using namespace aureole::testing;
using namespace std::chrono_literals;
using boost::asio::ip::tcp;

TEST_CASE("two servers introduce themselves and frames pass both ways, in order") {
  boost::asio::io_context io;
  Server a(io, PeerId{0});
  Server b(io, PeerId{1}, {.dial = {at(PeerId{0}, a.port)}});
  REQUIRE(run_until(io, [&] { return !a.up.empty() && !b.up.empty(); }));
  REQUIRE(a.up[0] == PeerId{1});
  REQUIRE(b.up[0] == PeerId{0});
  for (std::size_t i = 1; i <= 100; ++i) {
    a.links->send(PeerId{1}, message(8 * i));
    b.links->send(PeerId{0}, message(16 * i));
  }
  REQUIRE(run_until(io, [&] { return a.frames.size() == 100 && b.frames.size() == 100; }));
  for (std::size_t i = 1; i <= 100; ++i) {
    REQUIRE(b.frames[i - 1].payload.size() == 8 * i);
    REQUIRE(a.frames[i - 1].payload.size() == 16 * i);
  }
}

TEST_CASE("a follower learns the reference's time and the round trip of its link") {
  boost::asio::io_context io;
  Server a(io, PeerId{0});
  a.clock.start_as_reference(monotonic_us(), 5'000'000);
  Server b(io, PeerId{1}, {.dial = {at(PeerId{0}, a.port)}});
  REQUIRE(run_until(io, [&] { return b.clock.is_set(); }));
  const auto now = monotonic_us();
  REQUIRE(std::abs(*a.clock.world_us(now) - *b.clock.world_us(now)) < 20'000);
  REQUIRE(b.links->round_trip_us(PeerId{0}) > 0);
  REQUIRE_FALSE(a.clock.world_us(now) == std::nullopt);
}

TEST_CASE("a server of another world is refused with a sentence on both sides") {
  boost::asio::io_context io;
  Server a(io, PeerId{0});
  Server b(io, PeerId{1}, {.dial = {at(PeerId{0}, a.port)}, .world = world_hash + 1});
  REQUIRE(run_until(io, [&] { return !b.refusals.empty(); }));
  REQUIRE(b.refusals[0].reason.find("same world file") != std::string::npos);
  REQUIRE(a.up.empty());
  REQUIRE(b.up.empty());
}

TEST_CASE("a region that the world does not have is refused with a sentence") {
  boost::asio::io_context io;
  Server a(io, PeerId{0}, {.region_count = 2});
  Server b(io, PeerId{2}, {.dial = {at(PeerId{0}, a.port)}});
  REQUIRE(run_until(io, [&] { return !b.refusals.empty(); }));
  CHECK(b.refusals[0].reason.find("region r2 in a hello; this world has 2 regions") !=
        std::string::npos);
  CHECK(a.up.empty());
}

TEST_CASE("so many gateways are linked, and the next one is told that") {
  boost::asio::io_context io;
  Server region(io, PeerId{0});
  std::vector<std::unique_ptr<Server>> gateways;
  const auto come = [&] {
    gateways.push_back(
        std::make_unique<Server>(io, PeerId::gateway(static_cast<std::uint16_t>(gateways.size())),
                                 Server::Options{.dial = {at(PeerId{0}, region.port)}}));
  };
  while (gateways.size() < 64) come();
  REQUIRE(run_until(io, [&] { return region.up.size() == 64; }));
  come();
  REQUIRE(run_until(io, [&] { return !gateways.back()->refusals.empty(); }));
  CHECK(gateways.back()->refusals[0].reason.find("64 gateways") != std::string::npos);
  CHECK(region.up.size() == 64);
  CHECK(region.down.empty());
  // One that comes again takes its own place.
  Server again(io, PeerId::gateway(7), {.dial = {at(PeerId{0}, region.port)}, .incarnation = 2});
  REQUIRE(run_until(io, [&] { return !again.up.empty(); }));
}

TEST_CASE("who dials the wrong server is told so") {
  boost::asio::io_context io;
  Server a(io, PeerId{0});
  Server b(io, PeerId{2}, {.dial = {at(PeerId{1}, a.port)}});
  // The one that was dialled takes it for a link, until it hears the refusal.
  REQUIRE(run_until(io, [&] { return !a.down.empty(); }));
  REQUIRE(a.down_reasons[0].find("region r0 answered where region r1 was expected") !=
          std::string::npos);
  REQUIRE(b.up.empty());
}

TEST_CASE("a server of another protocol version is refused, and told to run the same release") {
  boost::asio::io_context io;
  Server a(io, PeerId{0});
  flatbuffers::FlatBufferBuilder builder;
  const auto hello = wire::CreateHello(builder, protocol_version + 1, world_hash,
                                       wire::Role::region, 1, 1, 0, false);
  const Bytes heard = talk_raw(io, a.port, finish_frame(builder, hello, FrameType::hello));
  const auto answer = decode_frame(heard);
  REQUIRE(answer);
  REQUIRE(answer->type == FrameType::refusal);
  REQUIRE(read_refusal(*answer).reason.find("run the same release everywhere") !=
          std::string::npos);
  REQUIRE(a.up.empty());
}

TEST_CASE("a server that is not there is dialled less and less often") {
  boost::asio::io_context io;
  tcp::acceptor deaf(io, {boost::asio::ip::address_v4::loopback(), 0});
  std::vector<std::chrono::steady_clock::time_point> calls;
  std::function<void()> hang_up = [&] {
    deaf.async_accept([&](const boost::system::error_code& ec, tcp::socket) {
      if (ec) return;
      calls.push_back(std::chrono::steady_clock::now());
      hang_up();
    });
  };
  hang_up();
  Server b(io, PeerId{1}, {.dial = {at(PeerId{0}, deaf.local_endpoint().port())}});
  REQUIRE(run_until(io, [&] { return calls.size() >= 6; }));
  // Pauses double from 50 ms with up to half of each left to chance: the fifth takes at least 400
  // ms, and a slow machine only makes it longer.
  REQUIRE(calls[5] - calls[4] >= 399ms);
  REQUIRE(calls[4] - calls[3] >= 199ms);
}

TEST_CASE("a link is made anew when the other side comes back, and the new start is told apart") {
  boost::asio::io_context io;
  auto a = std::make_unique<Server>(io, PeerId{0});
  const auto port = a->port;
  Server b(io, PeerId{1}, {.dial = {at(PeerId{0}, port)}});
  REQUIRE(run_until(io, [&] { return b.up.size() == 1; }));
  a.reset();
  REQUIRE(run_until(io, [&] { return b.down.size() == 1; }));
  a = std::make_unique<Server>(io, PeerId{0}, Server::Options{.incarnation = 2, .port = port});
  REQUIRE(run_until(io, [&] { return b.up.size() == 2; }));
  REQUIRE(b.hello->incarnation == Incarnation{2});
  REQUIRE(a->hello->known_incarnation == Incarnation{1});
}

TEST_CASE("a message that the receiver refuses ends the link and it is made anew") {
  boost::asio::io_context io;
  Server a(io, PeerId{0});
  Server b(io, PeerId{1}, {.dial = {at(PeerId{0}, a.port)}});
  REQUIRE(run_until(io, [&] { return b.up.size() == 1; }));
  a.answer = Error{"no"};
  b.links->send(PeerId{0}, message(8));
  REQUIRE(run_until(io, [&] { return b.up.size() == 2 && a.up.size() == 2; }));
  REQUIRE(a.down.size() == 1);
}

TEST_CASE("bytes that are no frames, and frames that are no hello, end only their own connection") {
  boost::asio::io_context io;
  Server a(io, PeerId{0});
  Server b(io, PeerId{1}, {.dial = {at(PeerId{0}, a.port)}});
  REQUIRE(run_until(io, [&] { return b.up.size() == 1; }));
  talk_raw(io, a.port, Bytes(64, std::byte{0xff}));
  talk_raw(io, a.port, encode_frame(FrameType::hello, 0, Bytes(64, std::byte{0xff})));
  const Bytes answer = talk_raw(io, a.port, encode_frame(FrameType::handoff, 1, Bytes(8)));
  const auto refusal = decode_frame(answer);
  REQUIRE(refusal);
  REQUIRE(refusal->type == FrameType::refusal);
  REQUIRE(read_refusal(*refusal).reason.find("no hello") != std::string::npos);
  REQUIRE(a.down.empty());
  REQUIRE(b.links->is_linked(PeerId{0}));
}

TEST_CASE("a stranger under the name of a server that we dial does not take its place") {
  boost::asio::io_context io;
  Server a(io, PeerId{0});
  Server b(io, PeerId{1}, {.dial = {at(PeerId{0}, a.port)}});
  REQUIRE(run_until(io, [&] { return b.up.size() == 1; }));
  PeerLinksOptions stranger;
  stranger.self = PeerId{0};
  stranger.incarnation = Incarnation{7};
  stranger.world_hash = world_hash;
  const Bytes heard = talk_raw(io, b.port, *make_hello(stranger, {}, false));
  const auto answer = decode_frame(heard);
  REQUIRE(answer);
  REQUIRE(answer->type == FrameType::refusal);
  REQUIRE(b.down.empty());
  REQUIRE(b.links->is_linked(PeerId{0}));
}

TEST_CASE("a time reply from before all time is refused") {
  boost::asio::io_context io;
  Server a(io, PeerId{0});
  PeerLinksOptions self;
  self.self = PeerId{1};
  self.incarnation = Incarnation{1};
  self.world_hash = world_hash;
  flatbuffers::FlatBufferBuilder builder;
  const Bytes reply = finish_frame(builder, wire::CreateTimeReply(builder, INT64_MIN, 5, true),
                                   FrameType::time_reply);
  Bytes both = *make_hello(self, {}, false);
  both.insert(both.end(), reply.begin(), reply.end());
  talk_raw(io, a.port, both);
  REQUIRE(a.up.size() == 1);
  REQUIRE(run_until(io, [&] { return a.down.size() == 1; }));
}

TEST_CASE("a peer that does not take its messages is cut off at the queue's bound") {
  boost::asio::io_context io;
  Server a(io, PeerId{0}, {.queue_bytes = 1u << 20});
  tcp::socket lazy(io);
  lazy.connect({boost::asio::ip::address_v4::loopback(), a.port});
  PeerLinksOptions self;
  self.self = PeerId{1};
  self.incarnation = Incarnation{1};
  self.world_hash = world_hash;
  const auto hello = make_hello(self, {}, false);
  boost::asio::write(lazy, boost::asio::buffer(*hello));
  REQUIRE(run_until(io, [&] { return a.up.size() == 1; }));
  for (int i = 0; i < 400 && a.down.empty(); ++i) {
    a.links->send(PeerId{1}, message(64 << 10));
    io.restart();
    io.poll();
  }
  REQUIRE(a.down.size() == 1);
}

TEST_CASE("two servers on one address: the second is told that the port is taken") {
  boost::asio::io_context io;
  Server a(io, PeerId{0});
  WorldClock clock;
  PeerLinks second(io, {}, clock, {});
  const auto port = second.listen({"127.0.0.1", a.port});
  REQUIRE_FALSE(port);
  REQUIRE(port.error().message.find(std::to_string(a.port)) != std::string::npos);
}

TEST_CASE("a peer that falls silent without closing its connection is given up") {
  boost::asio::io_context io;
  WorldClock clock;
  PeerLinksOptions options;
  options.self = PeerId{0};
  options.incarnation = Incarnation{1};
  options.world_hash = world_hash;
  options.silence_us = 300'000;
  std::vector<std::string> gone;
  PeerLinks links(io, options, clock,
                  {[](PeerId, const PeerHello&) {},
                   [&](PeerId, const std::string& why) { gone.push_back(why); },
                   [](PeerId, const FrameView&) -> Status { return Ok{}; },
                   [] { return true; },
                   {}});
  const auto port = *links.listen({"127.0.0.1", 0});
  tcp::socket mute(io);
  mute.connect({boost::asio::ip::address_v4::loopback(), port});
  PeerLinksOptions self;
  self.self = PeerId{1};
  self.incarnation = Incarnation{1};
  self.world_hash = world_hash;
  const auto hello = make_hello(self, {}, false);
  boost::asio::write(mute, boost::asio::buffer(*hello));
  REQUIRE(run_until(io, [&] { return links.is_linked(PeerId{1}); }));
  REQUIRE(run_until(io, [&] { return !gone.empty(); }));
  REQUIRE(gone[0].find("said nothing") != std::string::npos);

  // Two that talk to each other answer, and stay.
  Server a(io, PeerId{4});
  Server b(io, PeerId{5}, {.dial = {at(PeerId{4}, a.port)}});
  REQUIRE(run_until(io, [&] { return !b.up.empty(); }));
  io.restart();
  io.run_for(800ms);
  REQUIRE(b.down.empty());
}
