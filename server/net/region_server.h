// A region server: one RegionCore, its links, and the loop that steps it every 16 ms.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/net/links/peer_links.h"
#include "server/ops/snapshot_file.h"
#include "server/worlds/world.h"

namespace aureole {

struct RegionServerOptions {
  RegionId self;
  Incarnation incarnation;
  Endpoint listen;
  /// Every other region with its address. Of two regions the one with the higher number dials.
  std::vector<PeerAddress> regions;
  /// Where its state is written every 96 ms and found again after a death; null: nowhere.
  std::shared_ptr<SnapshotFile> state;
  std::optional<Secret> secret;  ///< Of the world's servers, if they have one.
};

/// The world begins when all regions are linked; region 0 then sets the clock that the others
/// follow. A start that finds its state on the disk, or whose peers have been running without it,
/// succeeds one that died: it recovers. Runs wholly on the io_context's one thread.
class RegionServer {
 public:
  /// `failed` is told once, in a sentence, when this server must not go on (its world runs without
  /// it already); the caller ends the process.
  RegionServer(boost::asio::io_context& io, const WorldDefinition& world,
               RegionServerOptions options, std::function<void(const std::string&)> failed);
  ~RegionServer();

  /// Returns the port on which it listens.
  Result<std::uint16_t> start();
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aureole
