// Writes down who listens where and who links to whom; see command_lines.h.
#include "server/play/command_lines.h"

#include <fmt/format.h>

namespace aureole {
namespace {

std::string at_loopback(std::uint16_t port) {
  return fmt::format("127.0.0.1:{}", port);
}

std::vector<std::string> common_arguments(const char* subcommand, const WorldPlan& plan) {
  std::vector<std::string> out{subcommand, "--world", plan.world, "--log-level", plan.log_level};
  if (plan.regions) {
    out.emplace_back("--regions");
    out.push_back(std::to_string(*plan.regions));
  }
  if (!plan.mode.empty()) {
    out.emplace_back("--mode");
    out.push_back(plan.mode);
  }
  if (!plan.secret.empty()) {
    out.emplace_back("--secret");
    out.push_back(plan.secret);
  }
  return out;
}

std::string bracketed(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

}  // namespace

std::vector<ProcessPlan> processes_of(const WorldPlan& plan) {
  std::vector<ProcessPlan> out;
  ProcessPlan gateway{"gateway", common_arguments("gateway", plan)};
  gateway.arguments.insert(gateway.arguments.end(),
                           {"--listen", fmt::format("{}:{}", bracketed(plan.host), plan.port),
                            "--web-root", plan.web_root});
  for (std::size_t i = 0; i < plan.region_ports.size(); ++i) {
    ProcessPlan region{fmt::format("r{}", i), common_arguments("region", plan)};
    region.arguments.insert(region.arguments.end(), {"--region", std::to_string(i), "--listen",
                                                     at_loopback(plan.region_ports[i])});
    if (!plan.state.empty())
      region.arguments.insert(region.arguments.end(), {"--state", plan.state});
    const std::string link = region.name + "=" + at_loopback(plan.region_ports[i]);
    for (std::size_t k = 0; k < plan.region_ports.size(); ++k) {
      if (k == i) continue;
      region.arguments.insert(
          region.arguments.end(),
          {"--peer", fmt::format("r{}={}", k, at_loopback(plan.region_ports[k]))});
    }
    gateway.arguments.insert(gateway.arguments.end(), {"--region", link});
    out.push_back(std::move(region));
  }
  out.push_back(std::move(gateway));
  return out;
}

std::string page_url(const std::string& host, std::uint16_t port) {
  const bool this_machine =
      host == "127.0.0.1" || host == "::1" || host == "0.0.0.0" || host == "::";
  return fmt::format("http://{}:{}", this_machine ? "localhost" : bracketed(host), port);
}

}  // namespace aureole
