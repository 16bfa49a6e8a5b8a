// The event loop of virtual time, and the end of a run.
#include "server/experiment/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

#include "server/base/hash.h"
#include "server/experiment/oracles/oracle_rest.h"
#include "server/experiment/run_moment.h"
#include "server/worlds/injector.h"
#include "server/worlds/region_tiling.h"

namespace aureole {
namespace {

/// Of a frame, its lateness included (T_F, section 3.3).
constexpr Micros frame_limit_us = 15'000;
/// Foreign-hosted shares count from here on, when there is something to share.
constexpr std::size_t share_bodies_min = 50;
/// In the last second of the run nothing may change owner any more.
constexpr std::int64_t calm_ticks = 62;

/// Whoever has come home along with others stays a second, and may then go on to its own home.
constexpr std::int64_t homeward_ticks = long_stay_ticks + 16;

double cpu_now_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) / 1e9;
}

}  // namespace

Simulation::Simulation(Scenario scenario, const SimulationOptions& options)
    : scenario_(std::move(scenario)),
      options_(options),
      end_{static_cast<std::int64_t>(options.scenario.seconds * 1e6) / tick_us},
      network_(static_cast<int>(scenario_.world.regions.size()) + 1, options.network,
               options.scenario.seed),
      gateway_(scenario_.world, scenario_.world.regions.size()),
      players_(scenario_.world, scenario_.players, options.scenario.seed),
      map_(partition_of(scenario_.world)),
      tolerances_(scenario_.world.regions.size(), scenario_.world.tolerances, scenario_.world.mode),
      view_(scenario_.world.regions.size()),
      ownership_(scenario_.world, scenario_.world.regions.size()),
      interactions_(scenario_.world, tolerances_, ownership_),
      shadow_(scenario_.world) {
  const auto regions = static_cast<int>(scenario_.world.regions.size());
  faults_until_us_ = static_cast<Micros>(faults_share * options.scenario.seconds * 1e6);
  faults_ = plan_faults({options.faults, regions, faults_until_us_, options.scenario.seed});
  events_.assign(scenario_.world.regions.size(), 0);
  line_versions_.assign(scenario_.world.regions.size(), map_.version());
  servers_.reserve(scenario_.world.regions.size());
  for (std::uint16_t r = 0; r < regions; ++r)
    servers_.emplace_back(scenario_.world, RegionId{r}, options.scenario.seed, options.pace);
  for (SimulatedServer& server : servers_) server.start(network_, 0);
  gateway_.start(network_, 0);
  result_.seed = options.scenario.seed;
  result_.scenario = scenario_.kind;
}

Simulation::~Simulation() = default;

SeedResult Simulation::run() {
  const double cpu_before = cpu_now_s();
  while (now_ < end_) {
    tick();
    if (end_ - now_ <= calm_ticks) all_rest();  // Notes who stirs.
  }
  const Tick latest = end_ + static_cast<std::int64_t>(calm_extension_s * 1e6) / tick_us;
  while (now_ < latest && !all_rest()) tick();
  // A second in which nothing may change owner any more.
  for (std::int64_t n = 0; n < calm_ticks + 2; ++n) tick();
  SeedResult result = finish();
  result.cpu_s = cpu_now_s() - cpu_before;
  return result;
}

void Simulation::tick() {
  now_ = now_ + 1;
  // Everything that begins in this tick's 16 ms, before the next tick's steps.
  run_until((now_.value + 1) * tick_us - 1);
  look();
}

void Simulation::run_until(Micros until) {
  const auto observer = [this](SimulatedServer& server, const SimulatedServer::Step& step) {
    after_step(server, step);
  };
  while (true) {
    SimulatedServer* next = nullptr;
    for (SimulatedServer& server : servers_)
      if (server.runs() && (next == nullptr || server.wakes_at() < next->wakes_at()))
        next = &server;
    const Micros server_at = next != nullptr ? next->wakes_at() : never;
    const Micros fault_at = next_fault_ < faults_.size() ? faults_[next_fault_].at_us : never;
    Micros restart_at = never;
    for (const Restart& r : restarts_) restart_at = std::min(restart_at, r.at_us);
    const Micros at =
        std::min({server_at, fault_at, restart_at, gateway_.wakes_at(), players_.wakes_at()});
    if (at > until) return;
    virtual_us_ = at;
    network_.advance(at);
    if (fault_at == at || restart_at == at)
      begin_faults(at);
    else if (gateway_.wakes_at() == at)
      gateway_.wake(network_, at);
    else if (players_.wakes_at() == at)
      players_.wake(network_, gateway_, at, at < faults_until_us_);
    else {
      note_run_moment(
          {next->last_tick().value + 1, next->self().value, next->core().physics().ids().size()});
      next->wake(network_, at, observer);
    }
  }
}

void Simulation::begin_faults(Micros now) {
  for (std::size_t i = 0; i < restarts_.size(); ++i) {
    if (restarts_[i].at_us > now) continue;
    const End who = restarts_[i].who;
    restarts_.erase(restarts_.begin() + static_cast<std::ptrdiff_t>(i--));
    if (who == static_cast<End>(servers_.size())) {
      gateway_.start(network_, now);
      continue;
    }
    SimulatedServer& server = servers_[static_cast<std::size_t>(who)];
    server.start(network_, now);
    events_[static_cast<std::size_t>(who)] = 0;
  }
  for (; next_fault_ < faults_.size() && faults_[next_fault_].at_us <= now; ++next_fault_)
    inject(faults_[next_fault_], now);
}

void Simulation::inject(const Fault& fault, Micros now) {
  switch (fault.kind) {
    case Fault::Kind::stall:
      network_.stall(fault.b, fault.a, now + fault.duration_us);
      [[fallthrough]];
    case Fault::Kind::stall_one_way:
      network_.stall(fault.a, fault.b, now + fault.duration_us);
      return;
    case Fault::Kind::reset:
      ++result_.resets;
      return network_.reset(fault.a, fault.b, now, fault.duration_us);
    case Fault::Kind::slow:
      return servers_[static_cast<std::size_t>(fault.a)].slow_down(fault.frame_ms,
                                                                   now + fault.duration_us);
    case Fault::Kind::crash:
      return kill(fault.a, fault.loses_disk, fault.duration_us);
  }
}

void Simulation::kill(End who, bool lose_disk, std::optional<Micros> back_after_us) {
  if (!network_.runs(who)) return;
  ++result_.crashes;
  if (back_after_us) restarts_.push_back({virtual_us_ + *back_after_us, who});
  if (who == static_cast<End>(servers_.size())) return gateway_.crash(network_, virtual_us_);
  SimulatedServer& server = servers_[static_cast<std::size_t>(who)];
  const Tick gone = server.last_tick() + 1;
  server.crash(network_, virtual_us_, lose_disk);
  ownership_.crashed(server.self(), gone);
  view_.gone(server.self(), gone);
}

bool Simulation::players_act(Micros now) const {
  // A blast takes effect some ticks after it was wanted; half a second covers the way to it too.
  return players_.last_deed_us() >= 0 && now - players_.last_deed_us() < 500'000;
}

void Simulation::after_step(SimulatedServer& server, const SimulatedServer::Step& step) {
  if (!options_.judged) return;
  const RegionId self = server.self();
  const RegionCore& core = server.core();
  const std::vector<Departure> departures = ownership_.stepped(server, step.tick);
  view_.stepped(self, step.tick, core, departures);
  shadow_.left(core, step.tick, departures, players_act(step.began_us));
  shadow_.stepped(self, step.tick, core, players_act(step.began_us));
  const Micros late_us = step.ended_us - step.tick.value * tick_us;
  if (late_us > frame_limit_us || server.is_recovering())
    tolerances_.server_outside(self, step.tick + late_us / tick_us);
  tolerances_.take(self, core.tolerance_events());

  for (const StandInWatch::Struck& struck : core.stand_in_watch().struck_now())
    if (struck.tick == step.tick) interactions_.stand_in_struck(self, struck);
  const RegionStatistics statistics = core.statistics();
  std::uint64_t& events = events_[self.value];
  if (statistics.tolerance_events > events)
    result_.tolerance_events += statistics.tolerance_events - events;
  events = statistics.tolerance_events;
  result_.stand_ins_max = std::max(result_.stand_ins_max, statistics.stand_ins);
  const std::uint64_t state = core.state_hash();
  result_.hash = Hasher().add(result_.hash).add(std::uint64_t{self.value}).add(state).value();
  if (options_.keep_trail)
    result_.trail.push_back({step.tick.value, self.value, core.physics().ids().size(), state});
}

void Simulation::note_tolerances(Micros now) {
  // A link keeps what both of its ends rely on.
  const auto limit_ms = [&](const SimulatedServer& s) {
    return (s.runs() ? s.core().tolerances_in_force() : scenario_.world.tolerances).latency_ms;
  };
  AuraTolerances longest = scenario_.world.tolerances;
  for (const SimulatedServer& a : servers_) {
    if (!a.runs()) tolerances_.server_outside(a.self(), now_);
    longest.latency_ms = std::max(longest.latency_ms, limit_ms(a));
    for (const SimulatedServer& b : servers_) {
      const auto limit_us = static_cast<Micros>(std::min(limit_ms(a), limit_ms(b)) * 1000);
      if (a.self() < b.self() &&
          network_.is_disturbed(a.self().value, b.self().value, now, limit_us))
        tolerances_.link_outside(a.self(), b.self(), now_);
    }
  }
  tolerances_.follow(longest);
}

void Simulation::look() {
  ++result_.ticks;
  if (!options_.judged) return;
  note_tolerances((now_.value + 1) * tick_us - 1);
  note_lines();
  ownership_.look(now_, servers_, all_run());
  const Tick seen_tick = now_ - WorldView::delay_ticks;
  if (seen_tick.value < 1) return;
  seen_ = view_.at(seen_tick);
  interactions_.look(seen_tick, seen_);
  if (seen_.size() < share_bodies_min) return;
  const auto foreign = std::count_if(seen_.begin(), seen_.end(), [&](const SeenBody& b) {
    const SimulatedServer& owner = servers_[b.owner.value];
    const PartitionMap& homes = owner.runs() ? owner.core().home_lines().map() : map_;
    return homes.region_at(b.state.position.x, b.state.position.z) != b.owner;
  });
  result_.foreign_hosted_share_max =
      std::max(result_.foreign_hosted_share_max,
               static_cast<double>(foreign) / static_cast<double>(seen_.size()));
}

void Simulation::note_lines() {
  for (std::size_t k = 0; k < servers_.size(); ++k) {
    if (!servers_[k].runs()) continue;
    const std::uint64_t version = servers_[k].core().home_lines().map().version();
    if (std::exchange(line_versions_[k], version) != version) lines_moved_ = now_;
  }
}

/// Whether bodies came into the world in the last second; a run that has come to rest had none.
bool Simulation::pours() const {
  return std::any_of(scenario_.world.injectors.begin(), scenario_.world.injectors.end(),
                     [&](const Injector& injector) {
                       return injected_count(injector, now_) !=
                              injected_count(injector, now_ - calm_ticks);
                     });
}

bool Simulation::all_run() const {
  return std::all_of(servers_.begin(), servers_.end(),
                     [](const auto& s) { return s.runs() && !s.is_recovering(); });
}

/// What has just fallen asleep may still go home within the second. Lines that have moved come back
/// soon after a world has calmed down, and then things go home.
bool Simulation::all_rest() {
  const bool asleep =
      all_run() && std::all_of(servers_.begin(), servers_.end(), [&](const SimulatedServer& s) {
        return s.core().physics().awake_count() == 0 && s.core().home_lines().settled();
      });
  if (!asleep) stirred_ = now_;
  return now_ - stirred_ >= calm_ticks && ownership_.changes_since(now_ - homeward_ticks).empty();
}

void Simulation::judge_rest() {
  RestOracle rest(scenario_.world);
  const bool all_sleep = std::all_of(servers_.begin(), servers_.end(), [](const auto& s) {
    return !s.runs() || s.core().physics().awake_count() == 0;
  });
  // Lines move while somebody is awake; if they do while all sleep that is what is wrong.
  if (all_sleep || now_ - lines_moved_ > homeward_ticks + calm_ticks)
    rest.judge(now_, servers_, ownership_.changes_since(now_ - calm_ticks));
  else
    rest.leave_out_all(servers_);
  rest.report(result_);
}

void Simulation::judge_jumps() {
  const auto tolerated_us = static_cast<Micros>(scenario_.world.tolerances.latency_ms * 1000);
  if (options_.faults != FaultKinds::none || options_.network.latency_us > tolerated_us) return;
  const HandoffShadow::Jump* jump = shadow_.p99();
  if (jump == nullptr || jump->mm <= jump_mm_p99_max) return;
  result_.violations.push_back(
      {"jump", jump->tick.value,
       fmt::format("of {} bodies that were handed over 1 % moved by {:.2f} mm or more, such as {} "
                   "from r{} to r{}; allowed {} mm",
                   shadow_.jumps().size(), jump->mm, describe(jump->body), jump->from.value,
                   jump->to.value, jump_mm_p99_max)});
}

SeedResult Simulation::finish() {
  Tick last = now_;
  for (const SimulatedServer& server : servers_) last = std::min(last, server.last_tick());
  ownership_.at_end(last, servers_, pours());
  ownership_.report(result_);
  interactions_.report(result_);
  shadow_.report(result_);
  // A world into which bodies still come never rests.
  if (!pours()) judge_rest();
  judge_jumps();
  const auto refuse = [&](const std::string& who, const std::vector<std::string>& refusals) {
    for (const std::string& refusal : refusals) {
      if (result_.refused_messages++ < 3)
        result_.violations.push_back(
            {"refused", now_.value, who + " refused a message " + refusal});
    }
  };
  for (const SimulatedServer& server : servers_)
    refuse(fmt::format("r{}", server.self().value), server.refusals());
  refuse("the gateway", gateway_.refusals());
  return result_;
}

Result<SeedResult> simulate(const SimulationOptions& options) {
  auto scenario = make_scenario(options.scenario);
  if (!scenario) return scenario.error();
  return Simulation(std::move(*scenario), options).run();
}

}  // namespace aureole
