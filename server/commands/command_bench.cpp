// `aureole bench`: named scenes that print what things cost, as a table and as JSON.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "renderer/bench/render_bench.h"
#include "renderer/gl/offscreen_context.h"
#include "server/commands/commands.h"
#include "server/gateway/web/view_client.h"

namespace aureole {
namespace {

struct ViewOptions {
  render::RenderBenchOptions render;
  std::string json;
};

struct StreamOptions {
  std::string gateway = "127.0.0.1:8080";
  int width = 1280, height = 720;
  double seconds = 10;
  std::string json;
};

int write_json(const std::string& path, const nlohmann::json& json) {
  if (path.empty()) return exit_ok;
  std::ofstream file(path);
  file << json.dump(2) << '\n';
  if (file) return exit_ok;
  return complain(exit_failed, fmt::format("cannot write {}", path));
}

int bench_view(const ViewOptions& options) {
  render::configure_software_rasteriser(0);
  const auto results = render::run_render_bench(options.render);
  if (!results) {
    return complain(exit_failed, results.failure().message);
  }
  fmt::print("Medians over {} frames of {}×{}, in thread CPU time; JPEG quality {}.\n",
             options.render.frames, options.render.width, options.render.height,
             options.render.quality);
  fmt::print("{:>8} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "bodies", "render ms", "wall ms",
             "encode ms", "bytes", "triangles");
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& r : *results) {
    fmt::print("{:>8} {:>10.2f} {:>10.2f} {:>10.2f} {:>10} {:>10}\n", r.bodies, r.render_cpu_ms,
               r.render_wall_ms, r.encode_cpu_ms, r.bytes_per_frame, r.as_triangles);
    rows.push_back({{"bodies", r.bodies},
                    {"width", r.width},
                    {"height", r.height},
                    {"quality", r.quality},
                    {"render_cpu_ms", r.render_cpu_ms},
                    {"render_wall_ms", r.render_wall_ms},
                    {"encode_cpu_ms", r.encode_cpu_ms},
                    {"bytes_per_frame", r.bytes_per_frame}});
  }
  return write_json(options.json, {{"bench", "view"}, {"results", rows}});
}

/// The value below which `share` of the sorted values lie.
double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

int bench_stream(const StreamOptions& options) {
  const auto gateway = parse_endpoint(options.gateway);
  if (!gateway) {
    return complain(exit_usage, fmt::format("--gateway: {}", gateway.error().message));
  }
  ViewClientOptions client_options;
  client_options.gateway = *gateway;
  client_options.name = "Bench";
  client_options.width = options.width;
  client_options.height = options.height;
  ViewClient client(client_options);
  if (auto ok = client.connect(); !ok) {
    return complain(exit_failed, fmt::format("no gateway at {} ({}); start one with `aureole play`",
                                             options.gateway, ok.error().message));
  }
  // The first pictures pay for compiling shaders.
  if (!client.wait_for_pictures(60)) {
    return complain(exit_failed,
                    fmt::format("the gateway at {} sends no pictures", options.gateway));
  }
  const std::size_t first = client.pictures();
  const std::uint64_t bytes_before = client.picture_bytes();
  const auto end =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(options.seconds);
  for (std::uint32_t seq = 1; std::chrono::steady_clock::now() < end; ++seq) {
    // Looking around, so that every picture is another one.
    client.send_input(seq, 0, 0.02 * seq, 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(33));
  }
  const std::vector<std::int64_t> arrivals = client.arrivals_us();
  const std::size_t count = client.pictures() - first;
  const std::uint64_t bytes = client.picture_bytes() - bytes_before;
  client.send(R"({"type":"leave"})");
  static_cast<void>(client.wait_for_end(2));
  std::vector<double> gaps_ms;
  for (std::size_t i = arrivals.size() - count; i + 1 < arrivals.size(); ++i)
    gaps_ms.push_back(static_cast<double>(arrivals[i + 1] - arrivals[i]) / 1e3);
  if (gaps_ms.empty()) {
    return complain(exit_failed, fmt::format("no pictures came in {} s", options.seconds));
  }
  std::sort(gaps_ms.begin(), gaps_ms.end());
  const double fps = static_cast<double>(count) / options.seconds;
  const std::uint64_t bytes_each = bytes / std::max<std::size_t>(count, 1);
  fmt::print(
      "{:.1f} pictures/s of {}×{}, gaps p50 {:.1f} ms, p99 {:.1f} ms, longest {:.1f} ms, "
      "{} bytes each\n",
      fps, options.width, options.height, quantile(gaps_ms, 0.5), quantile(gaps_ms, 0.99),
      gaps_ms.back(), bytes_each);
  return write_json(options.json, {{"bench", "stream"},
                                   {"pictures_per_s", fps},
                                   {"gap_ms_p50", quantile(gaps_ms, 0.5)},
                                   {"gap_ms_p99", quantile(gaps_ms, 0.99)},
                                   {"gap_ms_max", gaps_ms.back()},
                                   {"bytes_per_picture", bytes_each}});
}

void add_view(CLI::App& bench, int& exit_code) {
  CLI::App* command =
      bench.add_subcommand("view", "Renders and encodes a playground from a moving camera.");
  const auto options = std::make_shared<ViewOptions>();
  command->add_option("--bodies", options->render.bodies, "Numbers of bodies, one row each")
      ->check(CLI::Range(1, 100'000));
  command->add_option("--width", options->render.width, "Pixels")
      ->capture_default_str()
      ->check(CLI::Range(16, 3840));
  command->add_option("--height", options->render.height, "Pixels")
      ->capture_default_str()
      ->check(CLI::Range(16, 2160));
  command->add_option("--frames", options->render.frames, "Frames measured in each row")
      ->capture_default_str()
      ->check(CLI::Range(1, 100'000));
  command->add_option("--quality", options->render.quality, "JPEG quality")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  command->add_option("--json", options->json, "Also write the numbers to this file");
  command->callback([options, &exit_code] { exit_code = bench_view(*options); });
}

void add_stream(CLI::App& bench, int& exit_code) {
  CLI::App* command = bench.add_subcommand(
      "stream", "Joins a running gateway as a player without a screen and counts its pictures.");
  const auto options = std::make_shared<StreamOptions>();
  command->add_option("--gateway", options->gateway, "Where the gateway listens, host:port")
      ->capture_default_str();
  command->add_option("--width", options->width, "Pixels")
      ->capture_default_str()
      ->check(CLI::Range(160, 1920));
  command->add_option("--height", options->height, "Pixels")
      ->capture_default_str()
      ->check(CLI::Range(90, 1080));
  command->add_option("--seconds", options->seconds, "How long to count")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 3600.0));
  command->add_option("--json", options->json, "Also write the numbers to this file");
  command->callback([options, &exit_code] { exit_code = bench_stream(*options); });
}

/// A name in each line that begins with one; what a scene says in more lines goes on below itself.
void list_scenes(const CLI::App& bench) {
  constexpr std::size_t name_width = 10;
  for (const CLI::App* scene : bench.get_subcommands([](const CLI::App*) { return true; })) {
    std::string what = scene->get_description();
    for (auto end = what.find('\n'); end != std::string::npos; end = what.find('\n', end + 1))
      what.insert(end + 1, name_width + 1, ' ');
    fmt::print("{:<{}} {}\n", scene->get_name(), name_width, what);
  }
}

}  // namespace

void add_bench(CLI::App& app, int& exit_code) {
  CLI::App* bench = app.add_subcommand("bench", "Measures what things cost on this machine.");
  bench->require_subcommand(1);
  add_bench_scenes(*bench, exit_code);
  add_view(*bench, exit_code);
  add_stream(*bench, exit_code);
  bench->add_flag_callback(
      "--list",
      [bench] {
        list_scenes(*bench);
        throw CLI::Success();
      },
      "Says what each scene measures");
}

}  // namespace aureole
