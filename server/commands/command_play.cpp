// `aureole play`: a whole world on this machine, behind one URL.
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <memory>

#include "server/commands/commands.h"
#include "server/commands/mode_option.h"
#include "server/net/links/secret.h"
#include "server/ops/logging.h"
#include "server/ops/ports.h"
#include "server/ops/process/installation.h"
#include "server/ops/temporary_folder.h"
#include "server/play/supervisor.h"
#include "server/worlds/world_file.h"

namespace aureole {
namespace {

struct PlayOptions {
  std::string world = "playground";
  int regions = 0;   ///< 0: as the world file says.
  std::string mode;  ///< Empty: likewise.
  int port = 8080;
  std::string host = "127.0.0.1";
  std::string web_root;
  std::string log_level;
  std::string server_binary;
  std::string state;
};

/// The port for the page: the one wanted if it is free, any free one for 0.
Result<std::uint16_t> page_port(const PlayOptions& options) {
  if (options.port == 0) {
    const auto ports = free_loopback_ports(1, static_cast<std::uint32_t>(getpid()) + 1);
    if (!ports) return ports.error();
    return ports->front();
  }
  const auto port = static_cast<std::uint16_t>(options.port);
  const Status free = check_port_is_free(options.host, port);
  if (free) return port;
  for (int other = options.port + 1; other < options.port + 20 && other < 65'536; ++other) {
    if (check_port_is_free(options.host, static_cast<std::uint16_t>(other))) {
      return Error::format("{}; try --port {}", free.error().message, other);
    }
  }
  return Error::format("{}; try another --port, or --port 0 for any", free.error().message);
}

bool any_taken(const std::vector<std::uint16_t>& ports) {
  for (const auto port : ports) {
    if (!check_port_is_free("127.0.0.1", port)) return true;
  }
  return false;
}

Status check_page(const std::filesystem::path& web_root, bool is_default) {
  const auto index = web_root / "index.html";
  std::error_code ignored;
  if (std::filesystem::exists(index, ignored)) return Ok{};
  if (is_default)
    return Error::format("the player page is not built: there is no {}; ./run builds it",
                         index.string());
  return Error::format("--web-root: there is no {}; expected the folder of a built player page",
                       index.string());
}

/// Only the processes of this world know it: nobody else on this machine passes for one of them.
Result<std::string> write_new_secret(const std::filesystem::path& file) {
  std::ofstream out(file);
  out << random_secret() << '\n';
  out.close();
  if (!out) return Error::format("cannot write {}", file.string());
  return file.string();
}

int play(const PlayOptions& options) {
  const std::string log_level = chosen_log_level(options.log_level, "warning");
  if (const Status known = start_logging("play", log_level); !known) {
    return complain(exit_usage, known.error().message);
  }
  WorldPlan plan;
  plan.world = options.world;
  plan.host = options.host;
  plan.log_level = log_level;
  plan.mode = options.mode;
  if (options.regions != 0) plan.regions = options.regions;
  const auto world = load_world(options.world, {plan.regions, migration_mode_from(plan.mode)});
  if (!world) return complain(exit_usage, world.error().message);

  const auto own_binary = executable_path();
  plan.web_root = options.web_root.empty() ? web_root_beside(own_binary) : options.web_root;
  if (const Status page = check_page(plan.web_root, options.web_root.empty()); !page)
    return complain(exit_usage, page.error().message);
  const auto port = page_port(options);
  if (!port) return complain(exit_usage, port.error().message);
  plan.port = *port;

  const auto temporary = TemporaryFolder::make();
  if (!temporary) return complain(exit_failed, temporary.error().message);
  const auto secret = write_new_secret((*temporary)->path() / "secret");
  if (!secret) return complain(exit_failed, secret.error().message);
  plan.secret = *secret;
  // Without a folder of the user's, regions that die are restored all the same, and the world ends
  // with its last process.
  plan.state = options.state.empty() ? (*temporary)->path().string() : options.state;

  SupervisorOptions supervisor;
  supervisor.executable = own_binary;
  if (!options.server_binary.empty()) supervisor.executable = options.server_binary;
  supervisor.page_url = page_url(plan.host, plan.port);
  supervisor.health_url = supervisor.page_url + "/healthz";
  const int regions = static_cast<int>(world->regions.size());
  fmt::print(stderr, "Starting the world '{}': {} region server{} and a gateway …\n", world->name,
             regions, regions == 1 ? "" : "s");

  // Between choosing the ports and listening on them another program can take one: then once more.
  constexpr std::uint32_t attempts = 3;
  for (std::uint32_t attempt = 0;; ++attempt) {
    const auto ports =
        free_loopback_ports(regions, static_cast<std::uint32_t>(getpid()) + attempt * 7919u);
    if (!ports) return complain(exit_failed, ports.error().message);
    plan.region_ports = *ports;
    const PlayOutcome outcome = run_world(supervisor, processes_of(plan));
    if (outcome.end == PlayEnd::asked) return exit_ok;
    const bool unlucky = outcome.end == PlayEnd::failed_at_start && any_taken(plan.region_ports);
    if (!unlucky || attempt + 1 == attempts) return complain(exit_failed, outcome.sentence);
    fmt::print(stderr,
               "play: another program took one of the chosen ports; starting with others\n");
  }
}

}  // namespace

void add_play(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "play",
      "A whole world on this machine: starts the region servers and a gateway, prints the URL to\n"
      "open, and stops all of them on Ctrl-C.\n"
      "For example: aureole play --world columns-4 --regions 2 --port 8081");
  const auto options = std::make_shared<PlayOptions>();
  command->add_option("--world", options->world, "World file, or the name of a shipped world")
      ->capture_default_str();
  command
      ->add_option("--regions", options->regions,
                   "Split the world anew into this many regions: 1, 2, 4 and 9 as a grid, other\n"
                   "numbers as columns. Without it the world file's own regions count")
      ->check(CLI::Range(1, 64));
  add_mode_option(*command, options->mode);
  command->add_option("--port", options->port, "Port of the page; 0 takes any free one")
      ->check(CLI::Range(0, 65'535))
      ->capture_default_str();
  command
      ->add_option("--host", options->host,
                   "Numeric address to serve the page on. 0.0.0.0 lets everybody in who can reach\n"
                   "this machine: there are no passwords")
      ->capture_default_str();
  command->add_option(
      "--state", options->state,
      "Folder in which the world survives: started with it again, it goes on where\n"
      "it was. Without it the world ends with this command");
  command->add_option("--log-level", options->log_level,
                      "trace, debug, info, warning, error or off (default: AUREOLE_LOG_LEVEL or\n"
                      "warning)");
  command->add_option("--web-root", options->web_root,
                      "Folder of the player page, if not the built one");
  command
      ->add_option("--server-binary", options->server_binary,
                   "Start this instead of aureole itself as region and gateway")
      ->group("");  // for tests
  command->callback([options, &exit_code] { exit_code = play(*options); });
}

}  // namespace aureole
