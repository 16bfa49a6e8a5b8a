// `aureole region`: one region server in the foreground.
#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>

#include "server/commands/commands.h"
#include "server/commands/mode_option.h"
#include "server/commands/peer_options.h"
#include "server/commands/secret_option.h"
#include "server/net/region_server.h"
#include "server/ops/logging.h"
#include "server/ops/process/incarnation.h"
#include "server/ops/process/signals.h"
#include "server/ops/snapshot_file.h"
#include "server/worlds/world_file.h"

namespace aureole {
namespace {

struct RegionOptions {
  std::string world = "playground";
  std::optional<int> regions;
  std::string mode;  ///< Empty: as the world file says.
  int region = 0;
  std::string listen;
  std::vector<std::string> peers;
  std::uint64_t incarnation = 0;
  std::string state;
  SecretOption secret;
  std::string log_level;
};

int run_region(const RegionOptions& options) {
  const std::string role = fmt::format("r{}", options.region);
  if (auto ok = start_logging(role, chosen_log_level(options.log_level)); !ok)
    return complain(exit_usage, ok.error().message);
  const auto world =
      load_world(options.world, {options.regions, migration_mode_from(options.mode)});
  if (!world) return complain(exit_usage, world.error().message);
  const int count = static_cast<int>(world->regions.size());
  if (options.region < 0 || options.region >= count)
    return complain(exit_usage, fmt::format("--region {}: the world \"{}\" has regions 0 to {}",
                                            options.region, world->name, count - 1));

  RegionServerOptions server_options;
  server_options.self = RegionId{static_cast<std::uint16_t>(options.region)};
  server_options.incarnation =
      options.incarnation != 0 ? Incarnation{options.incarnation} : incarnation_of_this_start();
  if (!options.state.empty()) {
    auto state = SnapshotFile::open(options.state, {world->hash, server_options.self});
    if (!state) return complain(exit_usage, "--state: " + state.error().message);
    server_options.state = std::move(*state);
    // A clock that was set back must not make this start look older than the one that died.
    if (const auto found = server_options.state->newest())
      server_options.incarnation =
          std::max(server_options.incarnation, Incarnation{found->incarnation.value + 1});
  }
  const std::string at =
      options.listen.empty() ? fmt::format("127.0.0.1:{}", 7000 + options.region) : options.listen;
  auto listen = parse_endpoint(at);
  if (!listen) return complain(exit_usage, "--listen: " + listen.error().message);
  server_options.listen = *listen;
  auto secret = options.secret.read();
  if (!secret) return complain(exit_usage, secret.error().message);
  server_options.secret = std::move(*secret);
  auto peers = parse_regions(options.peers, "--peer", count, options.region);
  if (!peers) return complain(exit_usage, peers.error().message);
  server_options.regions = std::move(*peers);

  boost::asio::io_context io(1);
  ignore_broken_pipes();
  int exit_code = exit_ok;
  std::optional<StopSignals> signals;
  RegionServer server(io, *world, std::move(server_options), [&](const std::string& why) {
    exit_code = complain(exit_failed, why);
    signals.reset();
  });
  signals.emplace(io, [&](int) {
    server.stop();
    signals.reset();
  });
  const auto port = server.start();
  if (!port) return complain(exit_failed, port.error().message);
  fmt::print("ready region {} {}:{}\n", role, listen->host, *port);
  std::fflush(stdout);
  io.run();
  return exit_code;
}

}  // namespace

void add_region(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "region",
      "Runs one region server. All servers of a world get the same --world and --regions;\n"
      "the world begins when every region is linked with every other one.");
  const auto options = std::make_shared<RegionOptions>();
  command->add_option("--world", options->world, "World file, or the name of a shipped world")
      ->capture_default_str();
  command->add_option("--regions", options->regions,
                      "Split the world's extent anew into this many regions");
  add_mode_option(*command, options->mode);
  command->add_option("--region", options->region, "Which of the world's regions this is, from 0")
      ->required();
  command->add_option(
      "--listen", options->listen,
      "Address for other servers, host:port (default 127.0.0.1:7000 plus --region)");
  command->add_option("--peer", options->peers,
                      "Another region and its address, as r1=127.0.0.1:7001; once for each");
  options->secret.add_to(*command);
  command->add_option("--incarnation", options->incarnation,
                      "Number of this start, greater than at the last one (default: the time)");
  command->add_option("--state", options->state,
                      "Folder in which its state survives it: started again, it goes on with its\n"
                      "bodies. Without one, what happened in the last moments before it died is "
                      "known\nonly as far as gateways have heard of it");
  command->add_option(
      "--log-level", options->log_level,
      "trace, debug, info, warning, error or off (default: AUREOLE_LOG_LEVEL or info)");
  command->callback([options, &exit_code] { exit_code = run_region(*options); });
}

}  // namespace aureole
