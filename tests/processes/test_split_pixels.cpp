// The same sleeping scene, split over 1, 2 and 4 region processes, renders to the same pixels.
#include <nlohmann/json.hpp>
#include <thread>

#include "server/ops/http_get.h"
#include "server/worlds/world_file.h"
#include "tests/support/catch.h"
#include "tests/support/world_processes.h"

using namespace aureole;
using namespace aureole::testing;
using namespace std::chrono_literals;

namespace {

/// Everything asleep, on and around all seams, poses that no grid point is near.
std::string sleeping_scene() {
  nlohmann::json world = nlohmann::json::parse(R"({
    "name": "sleeping", "bounds": {"min": [-100, -20, -100], "max": [100, 100, 100]},
    "regions": [{"name": "all", "area": {}}],
    "statics": [{"name": "ground", "shape": {"type": "plane"}, "position": [0, 0, 0]},
                {"name": "ramp", "shape": {"type": "box", "size": [4, 0.3, 6]}, "position": [-6, 1, 2],
                 "orientation": {"pitch_deg": 20}}],
    "spawn_points": [{"position": [20, 1, 20]}], "bodies": []
  })");
  const char* colours[] = {"#d94f4f", "#4f8fd9", "#e0b040", "#58a868"};
  for (int i = 0; i < 60; ++i) {
    nlohmann::json b;
    if (i % 3 == 0) b["body"]["shape"] = {{"type", "box"}, {"size", {0.8, 0.8, 0.8}}};
    if (i % 3 == 1) b["body"]["shape"] = {{"type", "sphere"}, {"radius", 0.4}};
    if (i % 3 == 2) b["body"]["shape"] = {{"type", "capsule"}, {"radius", 0.25}, {"height", 1.1}};
    b["body"]["mass_kg"] = 1;
    b["colour"] = colours[i % 4];
    b["asleep"] = true;
    b["position"] = {-5.0 + 1.0137 * (i % 10), 0.4 + 0.01 * (i % 7), -3.0 + 1.0291 * (i / 10)};
    b["orientation"] = {{"yaw_deg", 17.0 * (i % 20)}};
    world["bodies"].push_back(b);
  }
  return world.dump();
}

constexpr const char* view =
    "/api/frame.jpg?x=1&y=4&z=11&yaw=0.1&pitch=-0.3&w=640&h=360&tint=0&boundaries=0&format=ppm";

std::string picture(const std::filesystem::path& path, int regions, const std::string& query) {
  WorldProcesses processes(path, regions, true);
  processes.await_gateway();
  std::this_thread::sleep_for(300ms);
  const auto answer = http_get(processes.gateway_url(query), 10'000);
  REQUIRE((answer ? "" : answer.error().message) == "");
  REQUIRE(answer->status == 200);
  REQUIRE(answer->body.size() > 640 * 360 * 3);
  return answer->body;
}

}  // namespace

TEST_CASE("a sleeping scene split over one, two and four processes renders to the same pixels") {
  const auto path = temporary_file("sleeping.json", sleeping_scene());
  const std::string whole = picture(path, 1, view);
  REQUIRE(picture(path, 2, view) == whole);
  REQUIRE(picture(path, 4, view) == whole);
  // Something is to be seen at all, and another view is another picture.
  const std::string aside =
      "/api/frame.jpg?x=1.01&y=4&z=11&yaw=0.1&pitch=-0.3&w=640&h=360&format=ppm";
  REQUIRE(picture(path, 1, aside) != whole);
}
