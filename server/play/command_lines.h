// The command lines of the processes that make up one world: what an operator would type by hand.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace aureole {

struct ProcessPlan {
  std::string name;                    ///< r0, r1, … or gateway.
  std::vector<std::string> arguments;  ///< Without the executable.
};

struct WorldPlan {
  std::string world;           ///< As the user named it.
  std::optional<int> regions;  ///< --regions, if the user gave it.
  std::string mode;            ///< --mode; empty if the user did not give it.
  std::string host;            ///< Numeric address on which the page is served.
  std::uint16_t port = 0;      ///< Of the page; not 0.
  std::string web_root;
  std::string log_level;
  std::string state;   ///< Folder in which the regions' states survive them; empty: none.
  std::string secret;  ///< File with the secret that these processes share; empty: none.
  std::vector<std::uint16_t> region_ports;  ///< One for each region, on 127.0.0.1.
};

/// The regions in their order, then the gateway.
std::vector<ProcessPlan> processes_of(const WorldPlan& plan);

/// What a person types into a browser: localhost for every address that this machine answers.
std::string page_url(const std::string& host, std::uint16_t port);

}  // namespace aureole
