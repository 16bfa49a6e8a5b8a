// Scene `wire`: messages of servers that talk, written down while they run and read again.
#include <fmt/format.h>

#include <vector>

#include "server/base/check.h"
#include "server/bench/replica_bytes.h"
#include "server/bench/running_servers.h"
#include "server/bench/samples.h"
#include "server/region/auras/aura_exchange.h"
#include "server/region/handoff/handoff.h"
#include "server/replica/replica_store.h"

namespace aureole {
namespace {

/// What one server sent in one tick, in order.
struct SentInTick {
  std::vector<SharedBytes> replicas, auras, groups;
};
/// By tick, from the start.
using Log = std::vector<SentInTick>;

FrameType type_of(const Bytes& frame) {
  FrameHeader header;
  std::memcpy(&header, frame.data(), sizeof header);
  return static_cast<FrameType>(header.type);
}

struct Recording {
  std::vector<Log> by_server;
  std::size_t prototypes = 0, statics = 0;
  std::size_t measured_from = 0;  ///< Ticks before this one are read without a clock.
};

Recording record(const BenchOptions& options) {
  RunningServers servers(options);
  Recording made;
  made.by_server.resize(static_cast<std::size_t>(servers.count()));
  made.prototypes = servers.core(0).hosting().definitions().size();
  made.statics = servers.core(0).hosting().statics().size();
  made.measured_from = static_cast<std::size_t>(options.seconds * 1e6) / tick_us;
  for (std::size_t n = 0; n < made.measured_from + static_cast<std::size_t>(options.ticks); ++n) {
    servers.tick();
    for (int r = 0; r < servers.count(); ++r) {
      SentInTick& sent = made.by_server[static_cast<std::size_t>(r)].emplace_back();
      for (const Outgoing& out : servers.sent(r)) {
        const FrameType type = type_of(*out.frame);
        if (type == FrameType::replica_update) sent.replicas.push_back(out.frame);
        if (type == FrameType::auras) sent.auras.push_back(out.frame);
        if (type == FrameType::handoff) sent.groups.push_back(out.frame);
      }
    }
  }
  return made;
}

std::size_t bytes_of(const std::vector<SharedBytes>& frames) {
  std::size_t sum = 0;
  for (const SharedBytes& frame : frames) sum += frame->size();
  return sum;
}

FrameView read(const SharedBytes& bytes) {
  const auto frame = decode_frame(*bytes);
  AUREOLE_CHECK(frame, "what a server sent is a frame");
  return *frame;
}

void read_replicas(const Recording& recording, Samples& samples, ReplicaBytes& bytes) {
  ReplicaStore store(recording.prototypes);
  for (std::size_t r = 0; r < recording.by_server.size(); ++r)
    store.region_up(RegionId{static_cast<std::uint16_t>(r)});
  for (std::size_t tick = 0; tick < recording.by_server.front().size(); ++tick) {
    for (std::size_t r = 0; r < recording.by_server.size(); ++r) {
      const RegionId from{static_cast<std::uint16_t>(r)};
      const auto& frames = recording.by_server[r][tick].replicas;
      const double us = cpu_us_of([&] {
        for (const SharedBytes& frame : frames)
          AUREOLE_CHECK(store.apply(from, read(frame).payload), "a store takes what servers tell");
      });
      if (tick < recording.measured_from) continue;
      const OwnerCounts counts = store.owner_counts(from);
      samples.add(us, {counts.bodies, counts.awake, bytes_of(frames)});
      for (const SharedBytes& frame : frames) bytes.add(*frame);
    }
  }
}

/// Auras that were told, each time they were told.
std::size_t auras_in(const std::vector<SharedBytes>& frames) {
  std::size_t sum = 0;
  for (const SharedBytes& bytes : frames) {
    const FrameView frame = read(bytes);
    const auto* message = verified<wire::Auras>(frame.payload);
    if (message == nullptr) continue;
    if (message->auras() != nullptr) sum += message->auras()->size();
    if (message->moved() != nullptr) sum += message->moved()->size();
  }
  return sum;
}

void read_auras(const Recording& recording, Samples& samples) {
  std::size_t told = 0, bytes = 0;
  for (std::size_t r = 0; r < recording.by_server.size(); ++r) {
    const RegionId from{static_cast<std::uint16_t>(r)};
    AuraExchange exchange;
    exchange.link_up(from);
    for (std::size_t tick = 0; tick < recording.by_server[r].size(); ++tick) {
      const auto& frames = recording.by_server[r][tick].auras;
      const double us = cpu_us_of([&] {
        for (const SharedBytes& frame : frames)
          AUREOLE_CHECK(exchange.receive(from, read(frame).payload, recording.prototypes,
                                         recording.by_server.size()),
                        "an exchange takes what servers tell");
        exchange.take_in();
        exchange.take_resting_news();
      });
      if (tick < recording.measured_from) continue;
      samples.add(us, {exchange.remote().size(), auras_in(frames), bytes_of(frames)});
      told += auras_in(frames);
      bytes += bytes_of(frames) - frames.size() * sizeof(FrameHeader);
    }
  }
  if (told > 0)
    samples.note(fmt::format("{:.2f} bytes for each aura that was told",
                             static_cast<double>(bytes) / static_cast<double>(told)));
}

void read_groups(const Recording& recording, Samples& samples) {
  for (const Log& log : recording.by_server) {
    for (const SentInTick& sent : log) {
      for (const SharedBytes& bytes : sent.groups) {
        Result<HandoffGroup> group = Error{};
        const double us = cpu_us_of([&] {
          group = decode_handoff(read(bytes).payload, recording.prototypes, recording.statics);
        });
        AUREOLE_CHECK(group, "what a server sent can be read");
        samples.add(us, {group->bodies.size(), group->bodies.size(), bytes->size()});
      }
    }
  }
}

}  // namespace

std::vector<BenchRow> bench_wire(const BenchOptions& options) {
  const Recording recording = record(options);
  Samples replicas("workload", "replicas of a server, a tick");
  Samples auras("workload", "auras of a server, a tick");
  Samples groups("workload", "a group");
  ReplicaBytes bytes;
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    read_replicas(recording, replicas, bytes);
    read_auras(recording, auras);
    read_groups(recording, groups);
  }
  replicas.note(bytes.note());
  std::vector<BenchRow> rows{replicas.row(), auras.row()};
  if (!groups.empty()) rows.push_back(groups.row());
  return rows;
}

}  // namespace aureole
