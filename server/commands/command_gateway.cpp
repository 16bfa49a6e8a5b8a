// `aureole gateway`: one gateway in the foreground.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <optional>

#include "server/commands/commands.h"
#include "server/commands/mode_option.h"
#include "server/commands/peer_options.h"
#include "server/commands/secret_option.h"
#include "server/gateway/gateway.h"
#include "server/ops/logging.h"
#include "server/ops/process/incarnation.h"
#include "server/ops/process/installation.h"
#include "server/ops/process/signals.h"
#include "server/play/command_lines.h"
#include "server/worlds/world_file.h"

namespace aureole {
namespace {

struct GatewayCommandOptions {
  std::string world = "playground";
  std::optional<int> regions;
  std::string mode;  ///< Empty: as the world file says.
  std::string listen = "127.0.0.1:8080";
  std::vector<std::string> addresses;
  SecretOption secret;
  std::string web_root;
  int number = 0;
  int render_threads = 0;
  std::string log_level;
};

int run_gateway(const GatewayCommandOptions& options) {
  if (auto ok = start_logging("gateway", chosen_log_level(options.log_level)); !ok)
    return complain(exit_usage, ok.error().message);
  const auto world =
      load_world(options.world, {options.regions, migration_mode_from(options.mode)});
  if (!world) return complain(exit_usage, world.error().message);
  const auto listen = parse_endpoint(options.listen);
  if (!listen) return complain(exit_usage, "--listen: " + listen.error().message);
  auto regions =
      parse_regions(options.addresses, "--region", static_cast<int>(world->regions.size()), -1);
  if (!regions) return complain(exit_usage, regions.error().message);
  auto secret = options.secret.read();
  if (!secret) return complain(exit_usage, secret.error().message);

  GatewayOptions gateway_options;
  gateway_options.number = static_cast<std::uint16_t>(options.number);
  gateway_options.incarnation = incarnation_of_this_start();
  gateway_options.listen = *listen;
  gateway_options.regions = std::move(*regions);
  gateway_options.secret = std::move(*secret);
  gateway_options.web_root =
      options.web_root.empty() ? web_root_beside(executable_path()) : options.web_root;
  gateway_options.render_threads = options.render_threads;

  boost::asio::io_context io(1);
  ignore_broken_pipes();
  std::optional<Gateway> gateway;
  std::optional<StopSignals> signals;
  int exit_code = exit_ok;
  const auto stop = [&] {
    gateway->stop();
    signals.reset();
  };
  gateway_options.rejected = [&](const std::string& why) {
    if (exit_code == exit_ok) exit_code = complain(exit_failed, why);
    stop();
  };
  gateway.emplace(io, *world, std::move(gateway_options));
  signals.emplace(io, [&](int) { stop(); });
  const auto port = gateway->start();
  if (!port) return complain(exit_failed, port.error().message);
  fmt::print("ready gateway {}\n", page_url(listen->host, *port));
  std::fflush(stdout);
  io.run();
  return exit_code;
}

}  // namespace

void add_gateway(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "gateway",
      "Runs one gateway: it gathers what the regions tell, renders each player's view\n"
      "and serves the player page.");
  const auto options = std::make_shared<GatewayCommandOptions>();
  command->add_option("--world", options->world, "World file, or the name of a shipped world")
      ->capture_default_str();
  command->add_option("--regions", options->regions,
                      "Split the world's extent anew into this many regions");
  add_mode_option(*command, options->mode);
  command->add_option("--listen", options->listen, "Address for browsers, host:port")
      ->capture_default_str();
  command->add_option("--region", options->addresses,
                      "A region and its address, as r0=127.0.0.1:7000; once for each");
  options->secret.add_to(*command);
  command->add_option("--web-root", options->web_root,
                      "Folder of the built player page (default: the one built with this program)");
  command
      ->add_option("--number", options->number,
                   "Tells gateways of one world apart; each has its own")
      ->capture_default_str()
      ->check(CLI::Range(0, 999));
  command
      ->add_option("--render-threads", options->render_threads,
                   "Threads that draw (default: one less than the cores, 1 to 4)")
      ->check(CLI::Range(0, 64));
  command->add_option(
      "--log-level", options->log_level,
      "trace, debug, info, warning, error or off (default: AUREOLE_LOG_LEVEL or info)");
  command->callback([options, &exit_code] { exit_code = run_gateway(*options); });
}

}  // namespace aureole
