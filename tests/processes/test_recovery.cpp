// Region processes that are killed while the world runs: it goes on, and no body is lost.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "server/ops/http_get.h"
#include "server/ops/snapshot_file.h"
#include "server/ops/temporary_folder.h"
#include "server/worlds/world_file.h"
#include "tests/processes/running.h"
#include "tests/support/temporary_folder.h"

using namespace aureole;
using aureole::test::is_gone;
using aureole::test::Running;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// Balls that roll outwards from the middle of a 2×2 world over its seams, and boxes that sleep.
std::string rolling_world() {
  Json world = Json::parse(R"({
    "name": "rolling", "bounds": {"min": [-100, -20, -100], "max": [100, 100, 100]},
    "regions": [{"name": "all", "area": {}}],
    "statics": [{"name": "ground", "shape": {"type": "plane"}, "position": [0, 0, 0]}],
    "spawn_points": [{"position": [20, 1, 20]}], "bodies": []
  })");
  for (int i = 0; i < 60; ++i) {
    const double side = i % 2 ? 1 : -1, along = -30 + i;
    world["bodies"].push_back(
        {{"body", {{"shape", {{"type", "sphere"}, {"radius", 0.3}}}, {"mass_kg", 2}}},
         {"position", {side * 8, 0.3, along}},
         {"velocity", {-side * 5, 0, 0}}});
  }
  for (int i = 0; i < 20; ++i)
    world["bodies"].push_back(
        {{"body", {{"shape", {{"type", "box"}, {"size", {1, 1, 1}}}}, {"mass_kg", 2}}},
         {"position", {i % 2 ? 40 : -40, 0.5, -30 + 3 * i}},
         {"asleep", true}});
  return world.dump();
}

class Play {
 public:
  explicit Play(const fs::path& folder, std::vector<std::string> more = {})
      : process_(AUREOLE_BINARY, arguments(folder, std::move(more))) {
    const std::string line = process_.wait_for_line("Open http", 60);
    url_ = line.substr(5);
  }

  Json get(const std::string& path) const {
    const auto answer = http_get(url_ + path, 2000);
    if (!answer || answer->status != 200) return {};
    return Json::parse(answer->body, nullptr, false);
  }
  std::map<std::string, Json> bodies() const {
    std::map<std::string, Json> all;
    const Json answer = get("/api/replicas");
    if (!answer.is_object()) return all;
    for (const Json& body : answer["bodies"]) all[body["id"].get<std::string>()] = body["position"];
    return all;
  }
  /// All regions are there and simulate, and together they host each body once.
  bool is_whole(std::size_t count) const {
    const Json status = get("/api/status");
    if (!status.is_object() || !status["complete"].get<bool>()) return false;
    std::size_t hosted = 0;
    for (const Json& region : status["regions"]) {
      if (!region["up"].get<bool>() || region["recovering"].get<bool>()) return false;
      hosted += region["bodies"].get<std::size_t>();
    }
    return hosted == count && status["bodies"].get<std::size_t>() == count &&
           bodies().size() == count;
  }
  bool await_whole(std::size_t count, int limit_s) const {
    for (int n = 0; n < limit_s * 20; ++n) {
      if (is_whole(count)) return true;
      usleep(50'000);
    }
    return false;
  }
  /// The process of a region, by its command line.
  pid_t region(int number) const {
    std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", process_.pid()));
    for (pid_t pid = 0; children >> pid;) {
      std::ifstream file(fmt::format("/proc/{}/cmdline", pid));
      std::string line((std::istreambuf_iterator<char>(file)), {});
      std::replace(line.begin(), line.end(), '\0', ' ');
      if (line.find(fmt::format(" --region {} ", number)) != std::string::npos) return pid;
    }
    FAIL("no process of region " << number);
    return -1;
  }
  Running& process() { return process_; }

 private:
  static std::vector<std::string> arguments(const fs::path& folder, std::vector<std::string> more) {
    std::ofstream(folder / "rolling.json") << rolling_world();
    std::vector<std::string> all{
        "play", "--world", (folder / "rolling.json").string(), "--regions", "4", "--port", "0"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Running process_;
  std::string url_;
};

std::unique_ptr<TemporaryFolder> folder() {
  auto made = TemporaryFolder::make();
  REQUIRE(made);
  return std::move(*made);
}

template <class Map>
std::vector<std::string> names(const Map& map) {
  std::vector<std::string> all;
  for (const auto& [name, value] : map) all.push_back(name);
  return all;
}

double between(const Json& a, const Json& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double d = a[i].get<double>() - b[i].get<double>();
    sum += d * d;
  }
  return std::sqrt(sum);
}

}  // namespace

TEST_CASE(
    "each region in turn is killed while balls roll, and the world goes on with all of them") {
  const auto place = folder();
  Play play(place->path());
  REQUIRE(play.await_whole(80, 30));
  const auto before = names(play.bodies());
  REQUIRE(before.size() == 80);
  for (const int region : {2, 0, 3, 1}) {
    kill(play.region(region), SIGKILL);
    play.process().wait_for_line(
        fmt::format("play: r{} ended (killed by signal 9); starting it again", region));
    REQUIRE(play.await_whole(80, 10));
    REQUIRE(names(play.bodies()) == before);
  }
  play.process().signal(SIGTERM);
  REQUIRE(play.process().wait_for_end() == "exit code 0");
  REQUIRE_FALSE(play.process().line_with("error:"));
}

TEST_CASE("all regions but one are killed at once, and the world goes on with all bodies") {
  const auto place = folder();
  Play play(place->path());
  REQUIRE(play.await_whole(80, 30));
  const auto before = names(play.bodies());
  for (const int region : {0, 1, 3}) kill(play.region(region), SIGKILL);
  play.process().wait_for_line("play: r3 ended (killed by signal 9); starting it again");
  REQUIRE(play.await_whole(80, 15));
  REQUIRE(before.size() == 80);
  REQUIRE(names(play.bodies()) == before);
}

TEST_CASE("a world that is stopped and started with the same folder goes on where it was") {
  const auto place = folder();
  const std::string state = (place->path() / "state").string();
  std::map<std::string, Json> before;
  {
    Play play(place->path(), {"--state", state});
    REQUIRE(play.await_whole(80, 30));
    sleep(2);
    before = play.bodies();
    play.process().signal(SIGTERM);
    REQUIRE(play.process().wait_for_end() == "exit code 0");
  }
  Play play(place->path(), {"--state", state});
  REQUIRE(play.await_whole(80, 30));
  const auto after = play.bodies();
  REQUIRE(names(after) == names(before));
  // In a second or so from then on nothing rolls farther than this; begun anew, most would be
  // elsewhere.
  for (const auto& [id, position] : after) REQUIRE(between(position, before[id]) < 6);
}

TEST_CASE("a state on the disk that is of no tick counts as none, and the region says so") {
  const aureole::testing::TemporaryFolder folder;
  const auto world = load_world("columns-4", {1, {}});
  REQUIRE(world);
  const std::int64_t tick = GENERATE(std::int64_t{-5}, std::int64_t{1} << 50);
  {
    const auto state = SnapshotFile::open(folder.path(), {world->hash, RegionId{0}});
    REQUIRE(state);
    const std::vector<std::byte> bytes(64);
    REQUIRE((*state)->write(bytes, Incarnation{1}, Tick{tick}));
  }
  Running region(AUREOLE_BINARY,
                 {"region", "--world", "columns-4", "--regions", "1", "--region", "0", "--listen",
                  "127.0.0.1:0", "--state", folder.path().string()});
  region.wait_for_line("the state on the disk counts as none: it is of tick " +
                       std::to_string(tick));
  // It begins anew, at the beginning of time.
  const std::string runs = region.wait_for_line("the world runs, from tick ");
  CHECK(std::stoll(runs.substr(runs.rfind("tick ") + 5)) < 100'000);
  region.signal(SIGTERM);
  CHECK(region.wait_for_end() == "exit code 0");
}
