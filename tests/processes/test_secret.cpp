// A world whose servers share a secret, and those who come with another one or with none.
#include <cstdlib>
#include <fstream>

#include "server/ops/ports.h"
#include "tests/processes/running.h"
#include "tests/support/temporary_folder.h"

using namespace aureole;
using aureole::test::Running;
using aureole::testing::TemporaryFolder;

namespace {

/// The path of a new file of a folder.
std::string written(const TemporaryFolder& folder, const std::string& name,
                    const std::string& text) {
  std::ofstream(folder.file(name)) << text << '\n';
  return folder.file(name);
}

struct Ports {
  std::uint16_t r0, r1;
};

Running region(int number, Ports ports, std::vector<std::string> more) {
  std::vector<std::string> words{"region", "--world",  "columns-4",           "--regions",
                                 "2",      "--region", std::to_string(number)};
  const auto at = [](std::uint16_t port) { return fmt::format("127.0.0.1:{}", port); };
  const bool first = number == 0;
  words.insert(words.end(), {"--listen", at(first ? ports.r0 : ports.r1), "--peer",
                             first ? "r1=" + at(ports.r1) : "r0=" + at(ports.r0)});
  words.insert(words.end(), more.begin(), more.end());
  return Running(AUREOLE_BINARY, words);
}

Running gateway(Ports ports, std::vector<std::string> more) {
  std::vector<std::string> words{"gateway",
                                 "--world",
                                 "columns-4",
                                 "--regions",
                                 "2",
                                 "--listen",
                                 "127.0.0.1:0",
                                 "--region",
                                 fmt::format("r0=127.0.0.1:{}", ports.r0),
                                 "--region",
                                 fmt::format("r1=127.0.0.1:{}", ports.r1)};
  words.insert(words.end(), more.begin(), more.end());
  return Running(AUREOLE_BINARY, words);
}

}  // namespace

TEST_CASE("servers with the same secret make a world, and nobody with another one takes a place") {
  const TemporaryFolder folder;
  const std::string secret = written(folder, "secret", "correct horse battery staple");
  const std::string other = written(folder, "other", "another horse battery staple");
  const auto free = free_loopback_ports(3, static_cast<std::uint32_t>(getpid()) * 31u);
  REQUIRE(free);
  const Ports ports{(*free)[0], (*free)[1]};

  Running r0 = region(0, ports, {"--secret", secret});
  r0.wait_for_line("ready region r0");
  // They take a place before anybody has it, if they can; and once somebody has.
  const Ports elsewhere{ports.r0, (*free)[2]};
  for (const bool world_runs : {false, true}) {
    INFO("the world runs: " << world_runs);
    std::optional<Running> r1;
    if (world_runs) {
      r1.emplace(region(1, ports, {"--secret", secret}));
      r1->wait_for_line("the world runs");
    }
    Running wrong = region(1, elsewhere, {"--secret", other});
    CHECK(wrong.wait_for_end() == "exit code 1");
    CHECK(wrong.line_with("region r0 refused this server: it knows another secret"));
    Running without = region(1, elsewhere, {});
    CHECK(without.wait_for_end() == "exit code 1");
    CHECK(without.line_with(
        "no link with region r0: it asks for a secret, and this server has none"));
    Running blind = gateway(ports, {});
    CHECK(blind.wait_for_end() == "exit code 1");
    CHECK(blind.line_with("it asks for a secret, and this server has none: start every server"));
    CHECK_FALSE(r0.line_with("lost region r1"));
    if (!world_runs) continue;

    setenv("AUREOLE_SECRET", secret.c_str(), 1);
    Running sees = gateway(ports, {});
    unsetenv("AUREOLE_SECRET");
    sees.wait_for_line("region r0 is linked");
    sees.wait_for_line("region r1 is linked");
  }
}

TEST_CASE("a secret that is no secret ends a server before it listens, with exit code 2") {
  const TemporaryFolder folder;
  const Ports ports{1, 2};  // Nobody comes so far.
  Running missing = region(0, ports, {"--secret", folder.file("nowhere")});
  CHECK(missing.wait_for_end() == "exit code 2");
  CHECK(missing.line_with("--secret: cannot read"));
  Running poor = gateway(ports, {"--secret", written(folder, "short", "1234")});
  CHECK(poor.wait_for_end() == "exit code 2");
  CHECK(poor.line_with("a secret of 4 characters; expected 16 to 4096"));
  // What a variable that is not set leaves behind.
  Running empty = region(0, ports, {"--secret", ""});
  CHECK(empty.wait_for_end() == "exit code 2");
  CHECK(empty.line_with("names no file"));
  setenv("AUREOLE_SECRET", "", 1);
  Running unset = gateway(ports, {});
  unsetenv("AUREOLE_SECRET");
  CHECK(unset.wait_for_end() == "exit code 2");
  CHECK(unset.line_with("names no file"));
}
