// The reports of runs that never were.
#include "tests/unit/measure/figures/small_runs.h"

#include "tests/support/catch.h"

namespace aureole {
namespace {

using nlohmann::json;

json bucket(double t_s, double frame_ms, int servers) {
  json made = {{"t_end_s", t_s},
               {"max_frame_ms", 2 * frame_ms},
               {"worst_server_ms", frame_ms},
               {"split",
                {{"physics", 0.96 * frame_ms},
                 {"aura", 0.01 * frame_ms},
                 {"decide", 0.02 * frame_ms},
                 {"wire", 0.01 * frame_ms}}},
               {"links", json::array({{{"from", 0}, {"to", 1}, {"bytes", 1000 * servers}}})},
               {"migrations", 10},
               {"missed_interactions", 1},
               {"missed_interactions_in_tolerance", 0}};
  for (int server = 0; server < servers; ++server) {
    made["server_ms"].push_back(frame_ms);
    made["bodies"].push_back(static_cast<int>(t_s) * 10 + server);
  }
  return made;
}

}  // namespace

FinishedRun small_run(Study study, const std::string& mode, int servers) {
  FinishedRun run;
  run.plan.study = study;
  run.plan.layout = study == Study::fig5 ? "column" : study == Study::weak ? "grid" : "corner";
  run.plan.servers = servers;
  run.plan.mode = mode;
  run.plan.seconds = 20;
  run.plan.repeats = mode == "paper" ? 1 : 5;
  // As planned: what needs a boundary is null where there is none.
  run.plan.references = run.plan.judged = servers > 1;
  run.plan.single = servers > 1 && mode == "adaptive";
  run.arguments = run.plan.arguments();
  run.build = "0.0.0 test";
  for (int b = 1; b <= 4; ++b) {
    const double frame_ms = 5.0 * b / (study == Study::weak ? 1 : servers);
    run.report["buckets"].push_back(bucket(5 * b, frame_ms, servers));
    if (!run.plan.references) continue;
    run.report["references"]["cut"]["buckets"].push_back(bucket(5 * b, 0.95 * frame_ms, servers));
    run.report["references"]["ideal"]["buckets"].push_back(bucket(5 * b, 0.85 * frame_ms, servers));
  }
  run.report["last_10_s"] = {{"worst_server_ms", 17.5 / servers},
                             {"speedup", servers},
                             {"efficiency", 0.95},
                             {"efficiency_ideal", 0.85},
                             {"share_besides_physics", 0.04}};
  run.report["total"] = {{"wire",
                          {{"aura_bytes_per_moving_tick", 32},
                           {"replica_bytes_per_moving_tick", 20},
                           {"replica_key_share", 0.25}}},
                         {"handoff_jump_mm", {{"p99", 0.5}}},
                         {"ticks_in_tolerance_share", 0.75}};
  run.report["bodies_lost"] = 0;
  run.report["bodies_duplicated"] = 0;
  if (servers > 1) return run;
  for (const char* ratio : {"speedup", "efficiency", "efficiency_ideal"})
    run.report["last_10_s"][ratio] = nullptr;
  for (const char* count : {"bodies_lost", "bodies_duplicated"}) run.report[count] = nullptr;
  for (json& made : run.report["buckets"])
    made["missed_interactions"] = made["missed_interactions_in_tolerance"] = nullptr;
  return run;
}

std::vector<FinishedRun> small_runs() {
  std::vector<FinishedRun> runs;
  for (const char* mode : {"adaptive", "paper"}) {
    for (const int servers : {1, 2, 4, 10}) runs.push_back(small_run(Study::fig5, mode, servers));
    for (const int servers : {1, 4, 9}) runs.push_back(small_run(Study::fig7, mode, servers));
  }
  for (const int servers : {4, 16, 64}) runs.push_back(small_run(Study::weak, "adaptive", servers));
  return runs;
}

FinishedRun& run_among(std::vector<FinishedRun>& runs, Study study, const std::string& mode,
                       int servers) {
  for (FinishedRun& run : runs)
    if (run.plan.study == study && run.plan.mode == mode && run.plan.servers == servers) return run;
  FAIL("there is no such run");
  return runs.front();
}

}  // namespace aureole
