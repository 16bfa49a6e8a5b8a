// A world of real processes over loopback TCP, and a test that watches it as a gateway would.
#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/net/links/peer_links.h"
#include "server/play/child_process.h"
#include "server/region/players/avatar.h"
#include "server/replica/replica_store.h"
#include "server/worlds/world.h"

namespace aureole::testing {

/// Region servers (and a gateway, if asked for) as child processes; they end with this object.
class WorldProcesses {
 public:
  /// `world` is a world file, split anew into `regions`, or with its own rectangles, of which there
  /// are so many. Throws with the children's complaints if they do not get ready.
  WorldProcesses(std::filesystem::path world, int regions, bool with_gateway,
                 bool own_rectangles = false);
  ~WorldProcesses();

  int region_count() const { return static_cast<int>(ports_.size()); }
  std::vector<PeerAddress> addresses() const;
  std::uint16_t gateway_port() const { return gateway_port_; }
  std::string gateway_url(const std::string& path) const;
  /// Waits until /healthz says ok.
  void await_gateway(std::chrono::seconds limit = std::chrono::seconds(30));

 private:
  void start(const std::vector<std::string>& arguments);

  std::filesystem::path world_;
  std::vector<std::uint16_t> ports_;
  std::uint16_t gateway_port_ = 0;
  std::vector<ChildProcess> children_;
};

/// Subscribes to every region, as gateway 7, and keeps what they tell in a store.
class Watcher {
 public:
  Watcher(const WorldDefinition& world, const std::vector<PeerAddress>& regions);
  ~Watcher();

  ReplicaStore& store() { return store_; }
  /// Runs the links until `done` says so. False if that took longer than `limit`.
  bool watch(const std::function<bool()>& done, std::chrono::seconds limit);
  void watch_for(std::chrono::milliseconds time);
  bool all_complete() const;
  void command(RegionId to, const PlayerCommand& command);
  /// Bodies that the regions say they simulate, all together: the world's, but for those in flight.
  std::size_t hosted() const;
  /// Counts how often a body changed its owner, over all bodies, as told by versions.
  std::uint64_t owner_changes() const { return owner_changes_; }
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  boost::asio::io_context io_{1};
  WorldClock clock_;
  ReplicaStore store_;
  std::size_t regions_;
  std::vector<std::string> faults_;
  std::map<RegionId, std::size_t> hosted_;
  std::map<BodyId, Version> versions_;
  std::uint64_t owner_changes_ = 0;
  std::unique_ptr<PeerLinks> links_;
};

/// Writes text into a file of a fresh folder below the system's temporary one.
std::filesystem::path temporary_file(const std::string& name, const std::string& text);

}  // namespace aureole::testing
