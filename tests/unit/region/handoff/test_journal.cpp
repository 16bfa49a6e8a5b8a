// Messages that must arrive: repeats, resets, restarts.
#include "server/region/handoff/journal.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

Bytes text(char c) {
  return Bytes(8, static_cast<std::byte>(c));
}

std::vector<std::uint64_t> sequences(const std::vector<SharedBytes>& frames) {
  std::vector<std::uint64_t> all;
  for (const auto& frame : frames) all.push_back(decode_frame(*frame)->sequence);
  return all;
}

using Numbers = std::vector<std::uint64_t>;

}  // namespace

TEST_CASE("each message is sent once over a link that holds") {
  Journal journal;
  journal.link_up(Incarnation{7});
  journal.append(FrameType::handoff, text('a'));
  journal.append(FrameType::handoff, text('b'));
  REQUIRE(sequences(journal.take_unsent()) == Numbers{1, 2});
  REQUIRE(journal.take_unsent().empty());
}

TEST_CASE("what is not acknowledged stays, what is acknowledged goes") {
  Journal journal;
  journal.link_up(Incarnation{7});
  for (char c : {'a', 'b', 'c'}) journal.append(FrameType::handoff, text(c));
  journal.take_unsent();
  REQUIRE(journal.acknowledge(2, 2));
  REQUIRE(journal.unacknowledged().size() == 1);
  REQUIRE(journal.unacknowledged().front().sequence == 3);
  REQUIRE(journal.acknowledge(1, 1));  // An old acknowledgement, come late.
  REQUIRE(journal.unacknowledged().size() == 1);
}

TEST_CASE("after a reset what is in doubt is sent again with the same numbers") {
  Journal journal;
  journal.link_up(Incarnation{7});
  for (char c : {'a', 'b', 'c'}) journal.append(FrameType::handoff, text(c));
  journal.take_unsent();
  REQUIRE(journal.acknowledge(1, 1));
  journal.link_up(Incarnation{7});
  journal.append(FrameType::handoff, text('d'));
  const auto frames = journal.take_unsent();
  REQUIRE(sequences(frames) == Numbers{2, 3, 4});
  REQUIRE(Frame(*decode_frame(*frames[0])).payload == text('b'));
}

TEST_CASE("towards a restarted peer everything is numbered anew") {
  Journal journal;
  journal.link_up(Incarnation{7});
  for (char c : {'a', 'b', 'c'}) journal.append(FrameType::handoff, text(c));
  journal.take_unsent();
  REQUIRE(journal.acknowledge(2, 2));
  journal.link_up(Incarnation{8});
  REQUIRE(sequences(journal.take_unsent()) == Numbers{1});
}

TEST_CASE("a message that comes twice is taken once and acknowledged twice") {
  Journal journal;
  journal.link_up(Incarnation{7});
  REQUIRE(*journal.arrive(1) == Journal::Arrival::fresh);
  REQUIRE(journal.take_acknowledgement_due());
  REQUIRE_FALSE(journal.take_acknowledgement_due());
  REQUIRE(*journal.arrive(1) == Journal::Arrival::repeated);
  REQUIRE(journal.take_acknowledgement_due());
  REQUIRE(journal.taken() == 1);
}

TEST_CASE("a gap is a fault of the sender and nothing is taken") {
  Journal journal;
  journal.link_up(Incarnation{7});
  REQUIRE(journal.arrive(1));
  REQUIRE_FALSE(journal.arrive(3));
  REQUIRE(journal.taken() == 1);
}

TEST_CASE("the numbers of a restarted sender begin anew") {
  Journal journal;
  journal.link_up(Incarnation{7});
  REQUIRE(journal.arrive(1));
  REQUIRE(journal.arrive(2));
  journal.link_up(Incarnation{8});
  REQUIRE(*journal.arrive(1) == Journal::Arrival::fresh);
}

TEST_CASE("an acknowledgement of what was never sent is a fault") {
  Journal journal;
  journal.link_up(Incarnation{7});
  journal.append(FrameType::handoff, text('a'));
  REQUIRE_FALSE(journal.acknowledge(1, 1));
  journal.take_unsent();
  REQUIRE_FALSE(journal.acknowledge(2, 2));
  REQUIRE(journal.acknowledge(1, 1));
}

TEST_CASE("what is taken but not durable is kept, and not sent again over a mere reset") {
  Journal journal;
  journal.link_up(Incarnation{7});
  for (char c : {'a', 'b', 'c'}) journal.append(FrameType::handoff, text(c));
  journal.take_unsent();
  REQUIRE(journal.acknowledge(2, 1));
  REQUIRE(journal.unacknowledged().size() == 2);
  REQUIRE(journal.is_taken(journal.unacknowledged().front()));
  REQUIRE_FALSE(journal.is_taken(journal.unacknowledged().back()));
  journal.link_up(Incarnation{7});
  REQUIRE(sequences(journal.take_unsent()) == Numbers{3});
}

TEST_CASE("a restarted peer is sent again what was taken but not durable") {
  Journal journal;
  journal.link_up(Incarnation{7});
  for (char c : {'a', 'b', 'c'}) journal.append(FrameType::handoff, text(c));
  journal.take_unsent();
  REQUIRE(journal.acknowledge(3, 1));
  journal.link_up(Incarnation{8});
  const auto frames = journal.take_unsent();
  REQUIRE(sequences(frames) == Numbers{1, 2});
  REQUIRE(Frame(*decode_frame(*frames[0])).payload == text('b'));
  REQUIRE_FALSE(journal.is_taken(journal.unacknowledged().front()));
}

TEST_CASE("what is said to be durable must be taken") {
  Journal journal;
  journal.link_up(Incarnation{7});
  for (char c : {'a', 'b'}) journal.append(FrameType::handoff, text(c));
  journal.take_unsent();
  REQUIRE_FALSE(journal.acknowledge(1, 2));
  REQUIRE(journal.unacknowledged().size() == 2);
}

TEST_CASE("an acknowledgement is due when more becomes durable") {
  Journal journal;
  journal.link_up(Incarnation{7});
  REQUIRE(journal.arrive(1));
  REQUIRE(journal.take_acknowledgement_due());
  journal.note_durable(1);
  REQUIRE(journal.take_acknowledgement_due());
  journal.note_durable(1);
  REQUIRE_FALSE(journal.take_acknowledgement_due());
}

TEST_CASE(
    "of what a receiver takes and never makes durable the oldest is let go, nothing untaken is") {
  Journal journal;
  journal.link_up(Incarnation{7});
  const std::uint64_t count = Journal::taken_max + 100;
  for (std::uint64_t n = 0; n < count; ++n) journal.append(FrameType::handoff, text('a'));
  CHECK(journal.untaken() == count);
  CHECK(journal.take_unsent().size() == count);
  REQUIRE(journal.acknowledge(count - 10, 3));
  CHECK(journal.untaken() == 10);
  CHECK(journal.let_go() == 100 - 10 - 3);
  CHECK(journal.unacknowledged().size() == Journal::taken_max + 10);
  CHECK(journal.unacknowledged().front().sequence == 100 - 10 + 1);
  // After a restart of the receiver what is left is sent again.
  journal.link_up(Incarnation{8});
  CHECK(journal.take_unsent().size() == Journal::taken_max + 10);
}

TEST_CASE("the bytes of what is taken and not durable are bounded, too") {
  Journal journal;
  journal.link_up(Incarnation{7});
  constexpr std::size_t large = 8u << 20;
  for (int n = 0; n < 10; ++n) journal.append(FrameType::handoff, Bytes(large));
  journal.take_unsent();
  // All of them wait for being taken, however many.
  CHECK(journal.unacknowledged().size() == 10);
  REQUIRE(journal.acknowledge(1, 0));
  CHECK(journal.unacknowledged().size() == 10);
  REQUIRE(journal.acknowledge(10, 0));
  CHECK(journal.unacknowledged().size() == Journal::taken_bytes_max / large);
  CHECK(journal.let_go() == 6);
  // Time and again.
  for (int n = 0; n < 3; ++n) {
    journal.append(FrameType::handoff, Bytes(large));
    journal.take_unsent();
    REQUIRE(journal.acknowledge(11 + static_cast<std::uint64_t>(n), 0));
    CHECK(journal.unacknowledged().size() == Journal::taken_bytes_max / large);
  }
  // A receiver that starts anew has taken nothing: what is left is sent again, and kept.
  journal.link_up(Incarnation{8});
  CHECK(journal.take_unsent().size() == Journal::taken_bytes_max / large);
  REQUIRE(journal.acknowledge(4, 0));
  CHECK(journal.unacknowledged().size() == 4);
  REQUIRE(journal.acknowledge(4, 4));
  CHECK(journal.unacknowledged().empty());
  CHECK(journal.let_go() == 9);
}
