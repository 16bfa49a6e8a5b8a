// The commands of docs/operating.md, run as they stand there.
#include <filesystem>
#include <fstream>
#include <sstream>

#include "server/ops/ports.h"
#include "tests/processes/running.h"
#include "tests/support/temporary_folder.h"

using namespace aureole;
using aureole::test::Running;
using aureole::testing::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

/// The shell block of the document, without its fence.
std::string commands_of(const std::string& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  const std::string all = text.str();
  const std::string fence = "```sh\n";
  const auto begin = all.find(fence);
  REQUIRE(begin != std::string::npos);
  const auto end = all.find("```", begin + fence.size());
  REQUIRE(end != std::string::npos);
  return all.substr(begin + fence.size(), end - begin - fence.size());
}

/// Ports of a machine where other worlds may be running.
std::string with_free_ports(std::string text) {
  const auto ports = free_loopback_ports(5, static_cast<std::uint32_t>(getpid()));
  REQUIRE(ports);
  const char* written[] = {":7000", ":7001", ":7002", ":7003", ":8080"};
  for (std::size_t i = 0; i < 5; ++i) {
    std::size_t at = text.find(written[i]);
    REQUIRE(at != std::string::npos);
    for (; at != std::string::npos; at = text.find(written[i])) {
      text.replace(at, 5, ":" + std::to_string((*ports)[i]));
    }
  }
  return text;
}

}  // namespace

TEST_CASE("the five commands of the operating page make a world in which every region is up") {
  const TemporaryFolder checkout;
  fs::create_directories(checkout.path() / "build/release");
  fs::create_directory_symlink(fs::path(AUREOLE_BINARY).parent_path(),
                               checkout.path() / "build/release/server");
  const std::string commands =
      with_free_ports(commands_of(std::string(SOURCE_FOLDER) + "/docs/operating.md"));
  // On a busy machine three seconds may be too short: the page's last line is repeated here.
  const std::string last_line = commands.substr(commands.rfind('\n', commands.size() - 2) + 1);
  REQUIRE(last_line.rfind("$aureole status", 0) == 0);
  const std::string script = "cd " + checkout.path().string() + "\n" + commands +
                             "for i in $(seq 60); do\n  sleep 0.5\n" + last_line +
                             "  test $? = 0 && break\ndone\necho all up: $?\n" +
                             "test $(jobs -p | wc -l) = 5 && kill $(jobs -p)\nwait\necho stopped\n";
  Running shell("/bin/bash", {"-c", script});
  shell.wait_for_line("all up: 0", 60);
  shell.wait_for_line("stopped");
  REQUIRE(shell.wait_for_end() == "exit code 0");
  for (const char* role : {"r0 127.0.0.1", "r1 127.0.0.1", "r2 127.0.0.1", "r3 127.0.0.1"}) {
    REQUIRE(shell.line_with("ready region " + std::string(role)));
  }
  REQUIRE(shell.line_with("ready gateway http://localhost:"));
}
