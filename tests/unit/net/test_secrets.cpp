// Who does not know a world's secret is none of its servers, whatever it has listened to.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "protocol/wire.h"
#include "server/net/links/handshake.h"
#include "server/net/rare_warning.h"
#include "tests/unit/net/linked_server.h"

using namespace aureole;
using namespace aureole::testing;
using boost::asio::ip::tcp;
using Side = Handshake::Side;

namespace {

Secret secret(const std::string& text = "sixteen characters") {
  return *Secret::from_text(text);
}

PeerLinksOptions region(std::uint16_t number, std::uint64_t incarnation = 1) {
  PeerLinksOptions self;
  self.self = PeerId{number};
  self.incarnation = Incarnation{incarnation};
  self.world_hash = world_hash;
  return self;
}

/// A file with a text, in the system's temporary folder, for as long as the object lives.
struct TemporaryFile {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("aureole-secret-{}", getpid());
  explicit TemporaryFile(const std::string& text) { std::ofstream(path, std::ios::binary) << text; }
  ~TemporaryFile() { std::filesystem::remove(path); }
};

/// Both sides' handshakes, the challenge heard.
struct Pair {
  Handshake dials, answers;
  explicit Pair(std::optional<Secret> of_who_dials = secret(),
                std::optional<Secret> of_who_answers = secret())
      : dials(Side::dials, PeerId{0}, of_who_dials),
        answers(Side::answers, PeerId{0}, of_who_answers) {
    const auto challenge = answers.challenge();
    REQUIRE(dials.hear_challenge(*decode_frame(*challenge)));
  }
};

Result<Handshake::Opened> open(Handshake& by, const SharedBytes& frame) {
  return by.open(*decode_frame(*frame));
}

/// The seal of the one with the nonce of the other; null: without any.
SharedBytes with_nonce_of(const SharedBytes& sealed, const SharedBytes& other) {
  const auto* one = verified<wire::Sealed>(decode_frame(*sealed)->payload);
  const auto* nonce =
      other ? verified<wire::Sealed>(decode_frame(*other)->payload)->nonce() : nullptr;
  flatbuffers::FlatBufferBuilder builder;
  const auto payload = builder.CreateVector(one->payload()->data(), one->payload()->size());
  return std::make_shared<const Bytes>(
      finish_frame(builder, wire::CreateSealed(builder, nonce, one->type(), payload, one->mac()),
                   FrameType::sealed));
}

bool says(const Error& error, const std::string& words) {
  return error.message.find(words) != std::string::npos;
}

/// A connection on which a test says what it wants.
struct Stranger {
  boost::asio::io_context& io;
  tcp::socket socket{io};
  FrameReader reader{max_payload_bytes};
  std::vector<Frame> heard;
  std::array<std::byte, 4096> bytes;
  bool closed = false;

  Stranger(boost::asio::io_context& context, std::uint16_t port) : io(context) {
    socket.connect({boost::asio::ip::address_v4::loopback(), port});
    read();
  }
  Stranger(boost::asio::io_context& context, tcp::socket accepted)
      : io(context), socket(std::move(accepted)) {
    read();
  }
  void read() {
    socket.async_read_some(boost::asio::buffer(bytes),
                           [this](const boost::system::error_code& ec, std::size_t n) {
                             if (ec) {
                               closed = true;
                               return;
                             }
                             REQUIRE(reader.feed(std::span(bytes).first(n)));
                             while (const auto frame = reader.next()) heard.push_back(*frame);
                             read();
                           });
  }
  void say(const SharedBytes& frame) { boost::asio::write(socket, boost::asio::buffer(*frame)); }
  const Frame& hear(std::size_t index) {
    REQUIRE(run_until(io, [&] { return heard.size() > index; }));
    return heard[index];
  }
};

}  // namespace

TEST_CASE("servers that know the same secret link, and frames pass") {
  boost::asio::io_context io;
  Server a(io, PeerId{0}, {.secret = secret()});
  Server b(io, PeerId{1}, {.dial = {at(PeerId{0}, a.port)}, .secret = secret()});
  Server gateway(io, PeerId::gateway(0), {.dial = {at(PeerId{0}, a.port)}, .secret = secret()});
  REQUIRE(run_until(io, [&] { return a.up.size() == 2 && !b.up.empty() && !gateway.up.empty(); }));
  a.links->send(PeerId{1}, message(64));
  b.links->send(PeerId{0}, message(32));
  REQUIRE(run_until(io, [&] { return a.frames.size() == 1 && b.frames.size() == 1; }));
  CHECK(a.down.empty());
}

TEST_CASE("a server with another secret is told so, and is no link") {
  boost::asio::io_context io;
  Server a(io, PeerId{0}, {.secret = secret()});
  Server b(io, PeerId{1},
           {.dial = {at(PeerId{0}, a.port)}, .secret = secret("another sixteen characters")});
  REQUIRE(run_until(io, [&] { return !b.refusals.empty(); }));
  CHECK(b.refusals[0].reason.find("it knows another secret") != std::string::npos);
  CHECK_FALSE(b.refusals[0].replaced);
  CHECK(a.up.empty());
  CHECK(b.up.empty());
}

TEST_CASE("one secret and none do not go together, whoever has it, and who dials is told") {
  const bool who_dials_has_it = GENERATE(true, false);
  boost::asio::io_context io;
  const std::optional<Secret> some = secret();
  Server a(io, PeerId{0}, {.secret = who_dials_has_it ? std::nullopt : some});
  Server b(io, PeerId{1},
           {.dial = {at(PeerId{0}, a.port)}, .secret = who_dials_has_it ? some : std::nullopt});
  REQUIRE(run_until(io, [&] { return !b.refusals.empty(); }));
  CHECK(b.refusals[0].reason.find(who_dials_has_it ? "it has no secret, and this server has one"
                                                   : "it asks for a secret") != std::string::npos);
  CHECK(b.refusals[0].reason.find("--secret") != std::string::npos);
  CHECK(a.up.empty());
  CHECK(b.up.empty());
}

TEST_CASE("a hello without a proof is refused with a sentence") {
  boost::asio::io_context io;
  Server a(io, PeerId{0}, {.secret = secret()});
  const Bytes answer = talk_raw(io, a.port, *make_hello(region(1), {}, false));
  const auto refusal = decode_frame(answer);
  REQUIRE(refusal);
  REQUIRE(refusal->type == FrameType::refusal);
  CHECK(read_refusal(*refusal).reason.find("does not prove that it knows") != std::string::npos);
  CHECK(a.up.empty());
}

TEST_CASE("a proof that somebody has listened to is worth nothing on another connection") {
  boost::asio::io_context io;
  Server a(io, PeerId{0}, {.secret = secret()});
  Stranger honest(io, a.port);
  Handshake handshake(Side::dials, PeerId{0}, secret());
  REQUIRE(handshake.hear_challenge(honest.hear(0)));
  const SharedBytes hello = handshake.seal(make_hello(region(1), {}, false));
  honest.say(hello);
  REQUIRE(run_until(io, [&] { return a.up.size() == 1; }));

  Stranger thief(io, a.port);
  thief.hear(0);
  thief.say(hello);
  REQUIRE(run_until(io, [&] { return thief.closed; }));
  CHECK(a.up.size() == 1);
  CHECK(a.down.empty());
  CHECK(a.links->is_linked(PeerId{1}));
}

TEST_CASE("a proof to one server proves nothing to another one") {
  boost::asio::io_context io;
  Server b(io, PeerId{1}, {.secret = secret()});
  // Somebody has taken the address of region 0, which region 2 dials, and passes words on.
  Stranger thief(io, b.port);
  Handshake honest(Side::dials, PeerId{0}, secret());
  REQUIRE(honest.hear_challenge(thief.hear(0)));
  thief.say(honest.seal(make_hello(region(2), {}, false)));
  REQUIRE(run_until(io, [&] { return thief.closed; }));
  CHECK(b.up.empty());
  // What it is told is no proof of anything either, and nothing to try secrets on.
  REQUIRE(thief.heard.size() == 2);
  CHECK(thief.heard[1].type == FrameType::refusal);
}

TEST_CASE("on a link, too, only who proves it says that a server has been replaced") {
  boost::asio::io_context io;
  Server a(io, PeerId{0}, {.secret = secret()});
  for (const bool proven : {false, true}) {
    Stranger peer(io, a.port);
    Handshake handshake(Side::dials, PeerId{0}, secret());
    REQUIRE(handshake.hear_challenge(peer.hear(0)));
    peer.say(handshake.seal(make_hello(region(1), {}, false)));
    peer.hear(1);
    const SharedBytes refusal = make_refusal({"go away", true});
    a.refusals.clear();
    peer.say(proven ? handshake.seal(refusal) : refusal);
    REQUIRE(run_until(io, [&] { return !a.refusals.empty(); }));
    CHECK(a.refusals[0].replaced == proven);
  }
}

TEST_CASE("a server that is dialled is told that it has been replaced, with a secret and without") {
  const bool with_secret = GENERATE(true, false);
  boost::asio::io_context io;
  const std::optional<Secret> some = with_secret ? std::optional(secret()) : std::nullopt;
  auto newer =
      std::make_unique<Server>(io, PeerId{0}, Server::Options{.incarnation = 2, .secret = some});
  const auto port = newer->port;
  Server b(io, PeerId{1}, {.dial = {at(PeerId{0}, port)}, .secret = some});
  REQUIRE(run_until(io, [&] { return b.up.size() == 1; }));
  newer.reset();
  REQUIRE(run_until(io, [&] { return b.down.size() == 1; }));
  Server older(io, PeerId{0}, {.incarnation = 1, .port = port, .secret = some});
  REQUIRE(run_until(io, [&] { return !older.refusals.empty(); }));
  CHECK(older.refusals[0].replaced);
  CHECK(older.refusals[0].reason.find("a newer start of region r0 is known") != std::string::npos);
}

TEST_CASE("strangers that say nothing, however many, keep no server out") {
  boost::asio::io_context io;
  Server a(io, PeerId{0}, {.secret = secret()});
  std::vector<std::unique_ptr<Stranger>> crowd;
  for (int n = 0; n < 300; ++n) crowd.push_back(std::make_unique<Stranger>(io, a.port));
  const auto closed = [&] {
    return std::count_if(crowd.begin(), crowd.end(), [](const auto& s) { return s->closed; });
  };
  REQUIRE(run_until(io, [&] { return closed() >= 44; }));
  CHECK(closed() == 44);
  CHECK(crowd.front()->closed);
  CHECK_FALSE(crowd.back()->closed);
  Server b(io, PeerId{1}, {.dial = {at(PeerId{0}, a.port)}, .secret = secret()});
  REQUIRE(run_until(io, [&] { return !b.up.empty() && !a.up.empty(); }));
}

TEST_CASE("warnings that strangers cause are a few a second, and say how many were left out") {
  RareWarning warning;
  for (int n = 0; n < RareWarning::per_second; ++n) CHECK(warning.line_at(1'000, "no") == "no");
  for (int n = 0; n < 7; ++n) CHECK(warning.line_at(900'000, "no").empty());
  CHECK(warning.line_at(1'001'000, "no") == "no (7 more such before that)");
  CHECK(warning.line_at(1'002'000, "no") == "no");
}

TEST_CASE("only who has proven that it knows the secret says that a server has been replaced") {
  const bool proven = GENERATE(true, false);
  boost::asio::io_context io;
  tcp::acceptor acceptor(io, {boost::asio::ip::address_v4::loopback(), 0});
  std::unique_ptr<Stranger> stranger;
  acceptor.async_accept([&](const boost::system::error_code&, tcp::socket socket) {
    stranger = std::make_unique<Stranger>(io, std::move(socket));
  });
  Server b(io, PeerId{1},
           {.dial = {at(PeerId{0}, acceptor.local_endpoint().port())}, .secret = secret()});
  REQUIRE(run_until(io, [&] { return stranger != nullptr; }));
  Handshake handshake(Side::answers, PeerId{0}, secret());
  stranger->say(handshake.challenge());
  REQUIRE(handshake.open(stranger->hear(0)));
  const SharedBytes refusal = make_refusal({"go away", true});
  stranger->say(proven ? handshake.seal(refusal) : refusal);
  REQUIRE(run_until(io, [&] { return !b.refusals.empty(); }));
  CHECK(b.refusals[0].reason == "go away");
  CHECK(b.refusals[0].replaced == proven);
  CHECK(b.up.empty());
}

TEST_CASE("an older start is told, with a proof, that it has been replaced") {
  boost::asio::io_context io;
  Server a(io, PeerId{0}, {.secret = secret()});
  Server newer(io, PeerId{1},
               {.dial = {at(PeerId{0}, a.port)}, .incarnation = 2, .secret = secret()});
  REQUIRE(run_until(io, [&] { return !newer.up.empty(); }));
  Server older(io, PeerId{1}, {.dial = {at(PeerId{0}, a.port)}, .secret = secret()});
  REQUIRE(run_until(io, [&] { return !older.refusals.empty(); }));
  CHECK(older.refusals[0].replaced);
  CHECK(older.refusals[0].reason.find("a newer start of region r1 is known") != std::string::npos);
  CHECK(newer.down.empty());
}

TEST_CASE("what a seal holds comes out as it was, and nothing that was changed on the way does") {
  Pair pair;
  const SharedBytes hello = make_hello(region(1), Incarnation{5}, true);
  const SharedBytes sealed = pair.dials.seal(hello);
  const auto opened = open(pair.answers, sealed);
  REQUIRE(opened);
  CHECK(opened->is_proven);
  CHECK(encode_frame(opened->frame.type, 0, opened->frame.payload) == *hello);
  const auto answer = open(pair.dials, pair.answers.seal(make_hello(region(0), {}, true)));
  REQUIRE(answer);
  CHECK(answer->is_proven);

  // Any one bit: no message, or one without a proof, or the very same one (padding says nothing).
  for (std::size_t at = sizeof(FrameHeader); at < sealed->size(); ++at) {
    Bytes changed = *sealed;
    changed[at] ^= std::byte{0x10};
    const auto result = pair.answers.open(*decode_frame(changed));
    if (result) CHECK(encode_frame(result->frame.type, 0, result->frame.payload) == *hello);
  }
}

TEST_CASE("a proof is of one side, and cannot be sent back to it") {
  Pair pair;
  const SharedBytes hello = make_hello(region(1), {}, false);
  REQUIRE(open(pair.answers, pair.dials.seal(hello)));
  // Who answers hears its own words from who dials: with a nonce or without one.
  const auto reflected = open(pair.answers, pair.answers.seal(hello));
  REQUIRE_FALSE(reflected);
  const auto own = open(pair.dials, pair.dials.seal(hello));
  REQUIRE_FALSE(own);
  // Nor as if they were the other side's.
  const SharedBytes from_answering = pair.answers.seal(hello),
                    from_dialling = pair.dials.seal(hello);
  const auto back = open(pair.answers, with_nonce_of(from_answering, from_dialling));
  REQUIRE_FALSE(back);
  CHECK(says(back.error(), "it knows another secret"));
  const auto home = open(pair.dials, with_nonce_of(from_dialling, nullptr));
  REQUIRE_FALSE(home);
  CHECK(says(home.error(), "it knows another secret"));
  REQUIRE(open(pair.dials, from_answering));
  Handshake impostor(Side::dials, PeerId{0}, secret());
  REQUIRE(impostor.hear_challenge(*decode_frame(*pair.answers.challenge())));
  Pair other;
  CHECK_FALSE(open(other.answers, impostor.seal(hello)));
}

TEST_CASE("a challenge of another version, no challenge, and seals out of place are refused") {
  Handshake dials(Side::dials, PeerId{0}, secret());
  flatbuffers::FlatBufferBuilder builder;
  const Bytes other = finish_frame(builder, wire::CreateChallenge(builder, protocol_version + 1),
                                   FrameType::challenge);
  const auto version = dials.hear_challenge(*decode_frame(other));
  REQUIRE_FALSE(version);
  CHECK(says(version.error(), "run the same release everywhere"));
  const auto hello = dials.hear_challenge(*decode_frame(*make_hello(region(1), {}, false)));
  REQUIRE_FALSE(hello);
  CHECK(says(hello.error(), "no challenge"));
  CHECK_FALSE(dials.has_heard_challenge());

  Pair pair;
  Handshake open_side(Side::answers, PeerId{0}, std::nullopt);
  const auto unwanted = open(open_side, pair.dials.seal(make_hello(region(1), {}, false)));
  REQUIRE_FALSE(unwanted);
  CHECK(says(unwanted.error(), "this server has none"));
}

TEST_CASE("a secret is the text of a file, whatever its line ends") {
  const auto key = [](const std::string& text) {
    const TemporaryFile file(text);
    const auto read = Secret::read(file.path);
    REQUIRE(read);
    return read->mac({});
  };
  CHECK(key("sixteen characters") == secret().mac({}));
  CHECK(key("sixteen characters\n") == secret().mac({}));
  CHECK(key("sixteen characters\r\n") == secret().mac({}));
  CHECK(key("sixteen  characters") != secret().mac({}));
  CHECK(Secret::from_text(random_secret())->mac({}) != Secret::from_text(random_secret())->mac({}));

  const auto refused = [](const std::filesystem::path& file, const std::string& words) {
    const auto read = Secret::read(file);
    return !read && says(read.error(), words) && says(read.error(), file.string());
  };
  CHECK(
      refused(TemporaryFile("too short\n").path, "a secret of 9 characters; expected 16 to 4096"));
  CHECK(refused(TemporaryFile(std::string(5000, 'x')).path, "expected 16 to 4096"));
  CHECK(refused("/nowhere/secret", "cannot read"));
  CHECK(refused(std::filesystem::temp_directory_path(), "cannot read"));
}
