// Commands: in order, exactly once, through losses, handoffs and rebuilt regions.
#include <map>

#include "server/gateway/players/command_stream.h"
#include "server/gateway/players/player_session.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr RegionId west{0}, east{1};

CommandStreamOptions options() {
  return {PlayerId{9}, 3, 100, 1};
}

CommandIntent input(std::uint8_t keys, std::uint32_t browser_seq, float yaw = 0) {
  return {.kind = wire::CommandKind::input, .keys = keys, .yaw = yaw, .browser_seq = browser_seq};
}

std::vector<std::uint32_t> sequences(const std::vector<wire::Command>& commands) {
  std::vector<std::uint32_t> out;
  for (const auto& c : commands) out.push_back(c.sequence());
  return out;
}
using Sequences = std::vector<std::uint32_t>;

PlayerSession a_session() {
  PlayerSession::Options o;
  o.token = "t";
  o.name = "Ada";
  o.stream = options();
  return PlayerSession(o);
}

}  // namespace

TEST_CASE("A session begins with join, and commands are numbered from there") {
  CommandStream stream(options());
  REQUIRE(stream.push(input(1, 1)));
  const auto sent = stream.due(west, 0);
  REQUIRE(sequences(sent) == Sequences{1, 2});
  REQUIRE(sent[0].kind() == wire::CommandKind::join);
  REQUIRE(sent[0].session() == 100);
  REQUIRE(sent[0].gateway() == 3);
  REQUIRE(sent[0].spawn() == 1);
  REQUIRE(sent[1].kind() == wire::CommandKind::input);
  REQUIRE(sent[1].player() == 9);
}

TEST_CASE("Only a join of an avatar that exists names it") {
  CommandStream stream(options());
  REQUIRE(stream.due(west, 0)[0].target() == 0);
  stream.set_avatar_exists(true);
  REQUIRE(stream.due(east, 0)[0].target() == BodyId::avatar(PlayerId{9}).value);
}

TEST_CASE("A command is sent once, and again only when nothing is confirmed for a while") {
  CommandStream stream(options());
  REQUIRE(sequences(stream.due(west, 0)) == Sequences{1});
  REQUIRE(stream.due(west, 50'000).empty());
  REQUIRE(stream.push(input(1, 1)));
  REQUIRE(sequences(stream.due(west, 60'000)) == Sequences{2});
  REQUIRE(sequences(stream.due(west, 100'000)) == Sequences{1, 2});
  stream.confirm(100, 2, Tick{5}, 110'000);
  REQUIRE(stream.all_applied());
  REQUIRE(stream.due(west, 500'000).empty());
}

TEST_CASE("New commands do not put off the repetition of old ones for ever") {
  CommandStream stream(options());
  std::map<std::uint32_t, int> times_sent;
  for (std::int64_t now = 0; now < 1'000'000; now += 16'000) {
    REQUIRE(stream.push(input(static_cast<std::uint8_t>(now / 16'000 % 2), 1)));
    for (const auto& c : stream.due(west, now)) ++times_sent[c.sequence()];
  }
  REQUIRE(times_sent[1] >= 8);
}

TEST_CASE("A new owner is sent everything that is not applied, at once") {
  CommandStream stream(options());
  REQUIRE(stream.push(input(1, 1)));
  REQUIRE(stream.push(input(2, 2)));
  (void)stream.due(west, 0);
  stream.confirm(100, 1, Tick{1}, 10'000);
  REQUIRE(sequences(stream.due(east, 20'000)) == Sequences{2, 3});
}

TEST_CASE("Angles merge into a command that has not left yet, but keys never do") {
  CommandStream stream(options());
  REQUIRE(stream.push(input(1, 1, 0.1f)));
  REQUIRE(stream.push(input(1, 2, 0.2f)));
  REQUIRE(stream.push(input(16, 3)));
  REQUIRE(stream.push(input(0, 4)));
  const auto sent = stream.due(west, 0);
  REQUIRE(sent.size() == 4);  // join, forward, jump, nothing
  REQUIRE(sent[1].yaw() == 0.2f);
  REQUIRE(stream.push(input(0, 5, 0.3f)));
  REQUIRE(stream.due(west, 1).size() == 1);  // what has left is not changed any more
}

TEST_CASE("A picture says the newest input that its moment contains") {
  CommandStream stream(options());
  REQUIRE(stream.push(input(1, 11)));
  REQUIRE(stream.push(input(2, 12)));
  (void)stream.due(west, 0);
  stream.confirm(100, 1, Tick{10}, 0);
  stream.confirm(100, 2, Tick{20}, 0);
  stream.confirm(100, 3, Tick{30}, 0);
  REQUIRE(stream.contained_input(10 * tick_us) == 0);
  REQUIRE(stream.contained_input(20 * tick_us - 1) == 0);
  REQUIRE(stream.contained_input(20 * tick_us) == 11);
  REQUIRE(stream.contained_input(29 * tick_us) == 11);
  REQUIRE(stream.contained_input(40 * tick_us) == 12);
}

TEST_CASE("A stream that nobody applies fills up and says so") {
  CommandStream stream(options());
  for (std::size_t i = 1; i < CommandStream::max_unapplied; ++i)
    REQUIRE(stream.push(input(static_cast<std::uint8_t>(i % 2), 1)));
  REQUIRE_FALSE(stream.push(input(9, 1)));
  REQUIRE(stream.unapplied() == CommandStream::max_unapplied);
}

TEST_CASE(
    "An owner that was rebuilt from an older state gets a new session with all that is open") {
  CommandStream stream(options());
  REQUIRE(stream.push(input(1, 1)));
  (void)stream.due(west, 0);
  stream.confirm(100, 2, Tick{1}, 0);
  REQUIRE(stream.push(input(2, 2)));
  (void)stream.due(west, 1'000);
  stream.confirm(100, 1, Tick{2}, 10'000);  // it knew 2 before
  REQUIRE_FALSE(stream.must_restart(10'000));
  stream.confirm(100, 1, Tick{30}, 400'000);
  REQUIRE(stream.must_restart(400'000));
  stream.restart(101);
  const auto sent = stream.due(west, 400'000);
  REQUIRE(sequences(sent) == Sequences{1, 2});
  REQUIRE(sent[0].kind() == wire::CommandKind::join);
  REQUIRE(sent[0].session() == 101);
  REQUIRE(sent[1].keys() == 2);
  REQUIRE_FALSE(stream.must_restart(900'000));
}

TEST_CASE("An old report that is put right at once does not restart the session") {
  CommandStream stream(options());
  REQUIRE(stream.push(input(1, 1)));
  (void)stream.due(west, 0);
  stream.confirm(100, 2, Tick{5}, 0);
  stream.confirm(100, 1, Tick{4}, 10'000);
  stream.confirm(100, 2, Tick{6}, 20'000);
  REQUIRE_FALSE(stream.must_restart(10'000'000));
}

TEST_CASE("A newer session of the same player takes over, an older one means nothing") {
  CommandStream stream(options());
  stream.confirm(99, 50, Tick{1}, 0);
  REQUIRE_FALSE(stream.superseded());
  REQUIRE(stream.unapplied() == 1);
  stream.confirm(101, 1, Tick{2}, 0);
  REQUIRE(stream.superseded());
}

TEST_CASE("A region that claims what was never sent is not believed") {
  CommandStream stream(options());
  (void)stream.due(west, 0);
  stream.confirm(100, 4'000'000'000u, Tick{1}, 0);
  REQUIRE(stream.unapplied() == 1);
  REQUIRE(stream.push(input(1, 1)));
  REQUIRE(sequences(stream.due(west, 1)) == Sequences{2});
}

TEST_CASE(
    "Head turns within one drawing interval become one command, and the camera has them at once") {
  PlayerSession session = a_session();
  REQUIRE(session.input({1, 1, {0.1f, 0}}, 0));
  (void)session.commands().due(west, 0);
  for (std::uint32_t seq = 2; seq <= 6; ++seq)
    REQUIRE(session.input({seq, 1, {0.1f * static_cast<float>(seq), 0}}, 1'000 * seq));
  REQUIRE(session.commands().due(west, 7'000).empty());
  REQUIRE(session.look().yaw == 0.1f * 6.0f);
  REQUIRE(session.tick(20'000));
  const auto sent = session.commands().due(west, 20'000);
  REQUIRE(sent.size() == 1);
  REQUIRE(sent[0].yaw() == 0.1f * 6.0f);
}

TEST_CASE("A key that is tapped between two pictures is not lost") {
  PlayerSession session = a_session();
  (void)session.commands().due(west, 0);
  REQUIRE(session.input({1, 0, {}}, 0));
  REQUIRE(session.input({2, 16, {}}, 1'000));
  REQUIRE(session.input({3, 0, {}}, 2'000));
  std::vector<unsigned> keys;
  for (const auto& c : session.commands().due(west, 3'000)) keys.push_back(c.keys());
  REQUIRE(keys == std::vector<unsigned>{0, 16, 0});
}

TEST_CASE("An action goes after the inputs before it and counts items from 0 between servers") {
  PlayerSession session = a_session();
  REQUIRE(session.input({1, 1, {}}, 0));
  REQUIRE(session.input({2, 1, {0.5f, 0}}, 1'000));
  REQUIRE(session.action({3, PlayerAction::throw_body, {0.7f, 0.1f}, 4}, {}, 2'000));
  const auto sent = session.commands().due(west, 3'000);
  REQUIRE(sent.size() == 3);  // join, both inputs in one, throw
  REQUIRE(sent[1].yaw() == 0.5f);
  REQUIRE(sent[2].kind() == wire::CommandKind::throw_body);
  REQUIRE(sent[2].item() == 3);
  REQUIRE(sent[2].yaw() == 0.7f);
}

TEST_CASE("Sequence numbers that do not grow are refused") {
  PlayerSession session = a_session();
  REQUIRE(session.input({5, 0, {}}, 0));
  REQUIRE_FALSE(session.input({5, 0, {}}, 0));
  REQUIRE_FALSE(session.action({4, PlayerAction::blast, {}, 1}, {}, 0));
  REQUIRE(session.input({6, 0, {}}, 0));
}

TEST_CASE("Grabbing twice in a row means to let go, before any region has answered") {
  PlayerSession session = a_session();
  REQUIRE_FALSE(session.will_carry(false));
  REQUIRE(session.action({1, PlayerAction::grab, {}, 1}, BodyId::world(3), 0));
  REQUIRE(session.will_carry(false));
  REQUIRE(session.action({2, PlayerAction::grab, {}, 1}, {}, 0));
  REQUIRE_FALSE(session.will_carry(true));
}

TEST_CASE("Whoever goes leaves a last command: lost, or leave") {
  PlayerSession session = a_session();
  session.depart(/*lost=*/true);
  REQUIRE(session.commands().due(west, 0).back().kind() == wire::CommandKind::lost);
  PlayerSession other = a_session();
  other.depart(/*lost=*/false);
  REQUIRE(other.commands().due(west, 0).back().kind() == wire::CommandKind::leave);
}
