// Who is started how, and who is told of whom.
#include <algorithm>

#include "server/play/command_lines.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {
WorldPlan three_regions() {
  WorldPlan plan;
  plan.world = "w.json";
  plan.host = "127.0.0.1";
  plan.port = 8080;
  plan.web_root = "/page";
  plan.log_level = "info";
  plan.region_ports = {20'000, 20'001, 20'002};
  return plan;
}
}  // namespace

TEST_CASE("each region is told its number, its port and every other region") {
  const auto processes = processes_of(three_regions());
  REQUIRE(processes.size() == 4);
  REQUIRE(processes[1].name == "r1");
  REQUIRE(processes[1].arguments ==
          std::vector<std::string>{"region", "--world", "w.json", "--log-level", "info", "--region",
                                   "1", "--listen", "127.0.0.1:20001", "--peer",
                                   "r0=127.0.0.1:20000", "--peer", "r2=127.0.0.1:20002"});
}

TEST_CASE("each region is told where its state survives it, the gateway is not") {
  auto plan = three_regions();
  plan.state = "/state";
  for (const auto& process : processes_of(plan)) {
    const auto& words = process.arguments;
    const auto at = std::find(words.begin(), words.end(), "--state");
    REQUIRE((at != words.end()) == (process.name != "gateway"));
    if (at != words.end()) REQUIRE(*(at + 1) == "/state");
  }
}

TEST_CASE("every process is told where the secret is that they share") {
  auto plan = three_regions();
  plan.secret = "/secret";
  for (const auto& process : processes_of(plan)) {
    const auto& words = process.arguments;
    const auto at = std::find(words.begin(), words.end(), "--secret");
    REQUIRE(at != words.end());
    REQUIRE(*(at + 1) == "/secret");
  }
}

TEST_CASE("the gateway is told the page's address and every region") {
  const auto gateway = processes_of(three_regions()).back();
  REQUIRE(gateway.name == "gateway");
  REQUIRE(gateway.arguments ==
          std::vector<std::string>{"gateway", "--world", "w.json", "--log-level", "info",
                                   "--listen", "127.0.0.1:8080", "--web-root", "/page", "--region",
                                   "r0=127.0.0.1:20000", "--region", "r1=127.0.0.1:20001",
                                   "--region", "r2=127.0.0.1:20002"});
}

TEST_CASE("a split that the user asked for reaches every process") {
  auto plan = three_regions();
  plan.regions = 3;
  for (const auto& process : processes_of(plan)) {
    const auto& words = process.arguments;
    const auto at = std::find(words.begin(), words.end(), "--regions");
    REQUIRE(at != words.end());
    REQUIRE(*(at + 1) == "3");
  }
}

TEST_CASE("a mode that the user asked for reaches every process, and no other is named") {
  auto plan = three_regions();
  for (const std::string mode : {"", "paper"}) {
    plan.mode = mode;
    for (const auto& process : processes_of(plan)) {
      const auto& words = process.arguments;
      const auto at = std::find(words.begin(), words.end(), "--mode");
      REQUIRE((at == words.end()) == mode.empty());
      if (!mode.empty()) REQUIRE(*(at + 1) == mode);
    }
  }
}

TEST_CASE("the URL to open names this machine as a person would") {
  REQUIRE(page_url("127.0.0.1", 8080) == "http://localhost:8080");
  REQUIRE(page_url("0.0.0.0", 81) == "http://localhost:81");
  REQUIRE(page_url("192.168.1.5", 8080) == "http://192.168.1.5:8080");
  REQUIRE(page_url("fd00::1", 8080) == "http://[fd00::1]:8080");
}
