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
  if (const auto url = parse_http_url(options.url); !url) {
    return complain(exit_usage, "--url: " + url.error().message);
  }
  std::string base = options.url;
  while (base.ends_with('/')) base.pop_back();
  const auto answer = http_get(base + "/api/status", 3000);
  if (!answer) {
    return complain(exit_failed, answer.error().message);
  }
  if (answer->status != 200) {
    return complain(exit_failed, fmt::format("{}/api/status answers {}", base, answer->status));
  }
  const auto status = parse_world_status(answer->body);
  if (!status) {
    return complain(exit_failed, fmt::format("{}: {}", base, status.error().message));
  }
  if (options.region.empty()) {
    fmt::print("{}", status_table(*status));
    return all_up(*status) ? exit_ok : exit_failed;
  }
  if (const RegionStatus* region = find_region(*status, options.region)) {
    fmt::print("{} is {}\n", region->name, region->up ? "up" : "down");
    return region->up ? exit_ok : exit_failed;
  }
  return complain(exit_usage, fmt::format("there is no region '{}' at {}", options.region, base));
}

}  // namespace

void add_status(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("status",
                                         "Shows how a running world is doing. Exit code 0: every "
                                         "region is up; 1: one is down, or the\n"
                                         "gateway does not answer; 2: the command line is wrong.");
  const auto options = std::make_shared<StatusOptions>();
  command->add_option("--url", options->url, "The gateway")->capture_default_str();
  command->add_option(
      "--region", options->region,
      "Only say whether this region is up, by its name in the world or as r0, r1, …\n"
      "(for health checks)");
  command->callback([options, &exit_code] { exit_code = show_status(*options); });
}

}  // namespace aureole
