// The one executable: reads the command line and hands over to a subcommand.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <string>

#include "server/commands/commands.h"

namespace {

/// As far as the command line could be read: the app, or the subcommand that it names.
const CLI::App& innermost(const CLI::App& app) {
  const auto named = app.get_subcommands();
  return named.empty() ? app : innermost(*named.front());
}

/// CLI11 says of a subcommand that does not exist that one is required.
std::string what_is_wrong(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& read = innermost(app);
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
      "Start with `aureole play`; every subcommand explains itself with --help.");
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
    fmt::print(
        stderr, "aureole: {} (see `aureole {}--help`)\n", what_is_wrong(app, wrong),
        app.get_subcommands().empty() ? "" : app.get_subcommands().front()->get_name() + " ");
    return aureole::exit_usage;
  }
  return exit_code;
}
