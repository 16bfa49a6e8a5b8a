// `aureole play` as an operator meets it: with real processes, most of them stand-ins that
// misbehave.
#include <arpa/inet.h>
#include <sys/socket.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "server/ops/ports.h"
#include "server/play/supervisor.h"
#include "tests/processes/running.h"

using namespace aureole;
using aureole::test::is_gone;
using aureole::test::Running;
namespace fs = std::filesystem;

namespace {

/// A folder in which the stand-ins leave their names and process numbers.
class Fakes {
 public:
  explicit Fakes(const std::string& orders) {
    std::string pattern = (fs::temp_directory_path() / "aureole-play-XXXXXX").string();
    REQUIRE(mkdtemp(pattern.data()) != nullptr);
    folder_ = pattern;
    setenv("FAKE_FOLDER", folder_.c_str(), 1);
    setenv("FAKE_ORDERS", orders.c_str(), 1);
  }
  ~Fakes() { fs::remove_all(folder_); }

  std::multimap<std::string, pid_t> started() const {
    std::multimap<std::string, pid_t> out;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const int pid = std::stoi(entry.path().extension().string().substr(1));
      if (pid != 0) out.emplace(entry.path().stem().string(), pid);
    }
    return out;
  }
  bool all_gone() const {
    for (const auto& [name, pid] : started()) {
      if (!is_gone(pid)) return false;
    }
    return true;
  }

 private:
  fs::path folder_;
};

std::vector<std::string> play_with(std::vector<std::string> more) {
  std::vector<std::string> out{"play", "--regions", "3", "--server-binary", FAKE_SERVER};
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

Running play() {
  return Running(AUREOLE_BINARY, play_with({"--port", "0"}));
}

}  // namespace

TEST_CASE("play starts every region and a gateway, says where to look, and stops all when asked") {
  const int signal = GENERATE(SIGTERM, SIGINT);
  const Fakes fakes("");
  auto world = play();
  const std::string line = world.wait_for_line("Open ");
  REQUIRE(line.rfind("Open http://localhost:", 0) == 0);
  REQUIRE(world.out == std::vector<std::string>{line});
  const auto started = fakes.started();
  REQUIRE(started.size() == 4);
  for (const char* name : {"r0", "r1", "r2", "gateway"}) REQUIRE(started.count(name) == 1);
  REQUIRE(world.line_with("12:00:00.000 r2 info: listening"));

  world.signal(signal);
  REQUIRE(world.wait_for_end() == "exit code 0");
  REQUIRE_FALSE(world.line_with("did not stop when asked"));
  REQUIRE(fakes.all_gone());
}

TEST_CASE("a taken port is told with a free one to try, before anything is started") {
  const Fakes fakes("");
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(bind(fd, reinterpret_cast<sockaddr*>(&at), sizeof at) == 0);
  REQUIRE(::listen(fd, 1) == 0);
  socklen_t size = sizeof at;
  getsockname(fd, reinterpret_cast<sockaddr*>(&at), &size);
  const std::string port = std::to_string(ntohs(at.sin_port));

  Running world(AUREOLE_BINARY, play_with({"--port", port}));
  REQUIRE(world.wait_for_end() == "exit code 2");
  close(fd);
  REQUIRE(world.err.size() == 1);
  REQUIRE(world.err[0].rfind("aureole: port " + port + " is taken by another program; try --port ",
                             0) == 0);
  REQUIRE(fakes.started().empty());
}

TEST_CASE("a world file that is not there is told by its name, before anything is started") {
  const Fakes fakes("");
  Running world(AUREOLE_BINARY, play_with({"--port", "0", "--world", "/nowhere/lake.json"}));
  REQUIRE(world.wait_for_end() == "exit code 2");
  REQUIRE(world.err.size() == 1);
  REQUIRE(world.err[0].find("/nowhere/lake.json") != std::string::npos);
  REQUIRE(world.out.empty());
  REQUIRE(fakes.started().empty());
}

TEST_CASE("a wrong option is told in one sentence that names the help") {
  Running world(AUREOLE_BINARY, {"play", "--regions", "0"});
  REQUIRE(world.wait_for_end() == "exit code 2");
  REQUIRE(world.err.size() == 1);
  REQUIRE(world.err[0].find("see `aureole play --help`") != std::string::npos);
}

TEST_CASE("a subcommand that does not exist is told beside those that do") {
  Running top(AUREOLE_BINARY, {"plya", "--regions", "2"});
  REQUIRE(top.wait_for_end() == "exit code 2");
  REQUIRE(top.err == std::vector<std::string>{
                         "aureole: there is no 'plya'; expected one of play, region, gateway, "
                         "status, bench, simulate, experiment (see `aureole --help`)"});
  Running scene(AUREOLE_BINARY, {"bench", "nonsense"});
  REQUIRE(scene.wait_for_end() == "exit code 2");
  REQUIRE(scene.err.size() == 1);
  REQUIRE(scene.err[0].rfind("aureole: there is no 'nonsense'; expected one of physics, auras, ",
                             0) == 0);
  REQUIRE(scene.err[0].find("see `aureole bench --help`") != std::string::npos);
  Running deep(AUREOLE_BINARY, {"experiment", "figures", "--jobs", "0"});
  REQUIRE(deep.wait_for_end() == "exit code 2");
  REQUIRE(deep.err.size() == 1);
  REQUIRE(deep.err[0].find("see `aureole experiment figures --help`") != std::string::npos);
  Running none(AUREOLE_BINARY, {"bench"});
  REQUIRE(none.wait_for_end() == "exit code 2");
  REQUIRE(none.err.size() == 1);
  REQUIRE(none.err[0].find("subcommand is required") != std::string::npos);
}

TEST_CASE(
    "a region that dies at the start is named with its last words, and all others are stopped") {
  const Fakes fakes("r1=die-at-start");
  auto world = play();
  REQUIRE(world.wait_for_end() == "exit code 1");
  REQUIRE(
      world.err.back() ==
      "aureole: r1 ended (exit code 3) while the world was starting, and said: the lake is frozen");
  REQUIRE(world.out.empty());
  REQUIRE(fakes.all_gone());
}

TEST_CASE("a region that dies while the world runs is started again, and the others stay") {
  const Fakes fakes("");
  auto world = play();
  world.wait_for_line("Open ");
  const auto before = fakes.started();
  kill(before.find("r2")->second, SIGKILL);
  world.wait_for_line("play: r2 ended (killed by signal 9); starting it again");
  for (int i = 0; i < 1000 && fakes.started().count("r2") < 2; ++i) usleep(10'000);
  REQUIRE(fakes.started().count("r2") == 2);
  for (const char* name : {"r0", "r1", "gateway"}) {
    REQUIRE(fakes.started().count(name) == 1);
    REQUIRE(kill(before.find(name)->second, 0) == 0);
  }
  world.signal(SIGTERM);
  REQUIRE(world.wait_for_end() == "exit code 0");
  REQUIRE(fakes.all_gone());
}

TEST_CASE("a gateway that dies is started again, and the regions stay") {
  const Fakes fakes("");
  auto world = play();
  world.wait_for_line("Open ");
  const auto before = fakes.started();
  kill(before.find("gateway")->second, SIGKILL);
  world.wait_for_line("play: gateway ended (killed by signal 9); starting it again");
  for (int i = 0; i < 1000 && fakes.started().count("gateway") < 2; ++i) usleep(10'000);
  REQUIRE(fakes.started().count("gateway") == 2);
  for (const char* name : {"r0", "r1", "r2"}) {
    REQUIRE(fakes.started().count(name) == 1);
    REQUIRE(kill(before.find(name)->second, 0) == 0);
  }
  world.signal(SIGTERM);
  REQUIRE(world.wait_for_end() == "exit code 0");
  REQUIRE(fakes.all_gone());
}

TEST_CASE("a gateway that keeps dying is given up after five restarts") {
  const Fakes fakes("gateway=die-once-open");
  auto world = play();
  world.wait_for_line("Open ");
  REQUIRE(world.wait_for_end() == "exit code 1");
  REQUIRE(world.err.back().find("gateway ended") != std::string::npos);
  REQUIRE(world.err.back().find("too often within a minute") != std::string::npos);
  REQUIRE(fakes.started().count("gateway") == 6);
  REQUIRE(fakes.all_gone());
}

TEST_CASE("a process that ignores the request to stop is killed, and play still ends well") {
  const Fakes fakes("r0=ignore-term gateway=ignore-term");
  auto world = play();
  world.wait_for_line("Open ");
  world.signal(SIGTERM);
  REQUIRE(world.wait_for_end() == "exit code 0");
  REQUIRE(world.line_with("play: r0 did not stop when asked; killed"));
  REQUIRE(fakes.all_gone());
}

TEST_CASE("play can be killed and still leaves no process behind") {
  const Fakes fakes("r0=ignore-term");
  auto world = play();
  world.wait_for_line("Open ");
  const auto started = fakes.started();
  REQUIRE(started.size() == 4);
  kill(world.pid(), SIGKILL);
  REQUIRE(world.wait_for_end() == "killed by signal 9");
  REQUIRE(fakes.all_gone());
}

TEST_CASE("a request to stop is heard while the world is still starting") {
  const Fakes fakes("gateway=ill");
  auto world = play();
  world.wait_for_line("gateway info: listening");
  world.signal(SIGTERM);
  REQUIRE(world.wait_for_end() == "exit code 0");
  REQUIRE(world.out.empty());
  REQUIRE(fakes.all_gone());
}

TEST_CASE("a world that does not get well in time is stopped, with what the gateway said") {
  const Fakes fakes("gateway=ill");
  const auto ports = free_loopback_ports(2, static_cast<std::uint32_t>(getpid()));
  REQUIRE(ports);
  WorldPlan plan;
  plan.world = "any";
  plan.host = "127.0.0.1";
  plan.port = ports->back();
  plan.region_ports = {ports->front()};
  SupervisorOptions options;
  options.executable = FAKE_SERVER;
  options.page_url = options.health_url = page_url(plan.host, plan.port);
  options.start_limit_ms = 1000;
  const PlayOutcome outcome = run_world(options, processes_of(plan));
  REQUIRE(outcome.end == PlayEnd::failed_at_start);
  REQUIRE(outcome.sentence.find("not ready within 1 s") != std::string::npos);
  REQUIRE(outcome.sentence.find("answers 503 text") != std::string::npos);
  REQUIRE(fakes.started().size() == 2);
  REQUIRE(fakes.all_gone());
}
