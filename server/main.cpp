// The one executable: reads the command line and hands over to a subcommand.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "server/commands/commands.h"

namespace {

/// As far as the command line could be read: the app, and the subcommands that it names.
std::vector<const CLI::App*> named_by(const CLI::App& app) {
  std::vector<const CLI::App*> path{&app};
  for (auto next = app.get_subcommands(); !next.empty(); next = next.front()->get_subcommands())
    path.push_back(next.front());
  return path;
}

/// CLI11 says of a subcommand that does not exist that one is required.
std::string what_is_wrong(const CLI::App& read, const CLI::ParseError& error) {
  const auto known = read.get_subcommands([](const CLI::App*) { return true; });
  const auto rest = read.remaining();
  if (known.empty() || rest.empty() || error.get_name() != "RequiredError") return error.what();
  std::string names;
  for (const CLI::App* one : known) names += (names.empty() ? "" : ", ") + one->get_name();
  return fmt::format("there is no '{}'; expected one of {}", rest.front(), names);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Aureole keeps one physical world running on many servers and shows it in a browser.\n"
      "Start with `aureole play`; every subcommand explains itself with --help.",
      "aureole");
  app.set_version_flag("--version", fmt::format("aureole {}", AUREOLE_VERSION));
  app.require_subcommand(1);
  app.fallthrough(false);

  int exit_code = aureole::exit_ok;
  aureole::add_play(app, exit_code);
  aureole::add_region(app, exit_code);
  aureole::add_gateway(app, exit_code);
  aureole::add_status(app, exit_code);
  aureole::add_bench(app, exit_code);
  aureole::add_simulate(app, exit_code);
  aureole::add_experiment(app, exit_code);

  if (argc == 1) {
    fmt::print("{}", app.help());
    return aureole::exit_usage;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {  // --help and --version end the parsing this way
    return app.exit(asked);
  } catch (const CLI::ParseError& wrong) {
    const auto path = named_by(app);
    std::string help = "aureole ";
    for (std::size_t n = 1; n < path.size(); ++n) help += path[n]->get_name() + " ";
    fmt::print(stderr, "aureole: {} (see `{}--help`)\n", what_is_wrong(*path.back(), wrong), help);
    return aureole::exit_usage;
  }
  return exit_code;
}
