// `aureole status`: what a gateway knows about its world, as a table.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "server/commands/commands.h"
#include "server/ops/http_get.h"
#include "server/ops/status_table.h"

namespace aureole {
namespace {

struct StatusOptions {
  std::string url = "http://localhost:8080";
  std::string region;
};

int show_status(const StatusOptions& options) {
  std::string base = options.url;
  while (base.ends_with('/')) base.pop_back();
  const auto answer = http_get(base + "/api/status", 3000);
  if (!answer) {
    fmt::print(stderr, "aureole: {}\n", answer.error().message);
    return exit_failed;
  }
  if (answer->status != 200) {
    fmt::print(stderr, "aureole: {}/api/status answers {}\n", base, answer->status);
    return exit_failed;
  }
  const auto status = parse_world_status(answer->body);
  if (!status) {
    fmt::print(stderr, "aureole: {}: {}\n", base, status.error().message);
    return exit_failed;
  }
  if (options.region.empty()) {
    fmt::print("{}", status_table(*status));
    return all_up(*status) ? exit_ok : exit_failed;
  }
  if (const RegionStatus* region = find_region(*status, options.region)) {
    fmt::print("{} is {}\n", region->name, region->up ? "up" : "down");
    return region->up ? exit_ok : exit_failed;
  }
  fmt::print(stderr, "aureole: there is no region '{}' at {}\n", options.region, base);
  return exit_usage;
}

}  // namespace

void add_status(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("status",
                                         "Shows how a running world is doing. Exit code 0: every "
                                         "region is up; 1: one is down, or the\n"
                                         "gateway does not answer.");
  const auto options = std::make_shared<StatusOptions>();
  command->add_option("--url", options->url, "The gateway")->capture_default_str();
  command->add_option(
      "--region", options->region,
      "Only say whether this region is up, by its name in the world or as r0, r1, …\n"
      "(for health checks)");
  command->callback([options, &exit_code] { exit_code = show_status(*options); });
}

}  // namespace aureole
