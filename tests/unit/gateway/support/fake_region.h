// A region that simulates nothing: it speaks to gateways over TCP as one does, and says what a test
// wants.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "protocol/wire.h"
#include "server/base/ids.h"
#include "server/net/links/peer_links.h"
#include "server/net/world_clock.h"
#include "server/worlds/world.h"

namespace aureole::test {

/// Publishes an update each 16 ms; makes an avatar for whoever joins and applies commands in order,
/// as a region does. All state is of its own thread; counters are read under a lock.
class FakeRegion {
 public:
  struct Options {
    RegionId id;
    int bodies = 0;  ///< Balls in rows, of which the first `moving` swing.
    int moving = 0;
    bool applies = true;                            ///< Whether commands are applied at all.
    std::vector<wire::ToleranceMark> outside = {};  ///< Told with its status.
    std::uint64_t missed_blows = 0;
    std::uint16_t line_level = 0xFFFF;  ///< The same; see HomeLines.
  };
  FakeRegion(const WorldDefinition& world, Options options);
  ~FakeRegion();

  PeerAddress address() const;
  /// Every command that was applied, in order.
  std::vector<wire::Command> applied() const;
  bool has_avatar(PlayerId player) const;
  /// From now on it says that this player's avatar is of that session.
  void make_up_session(PlayerId player, std::uint32_t session);

 private:
  struct Avatar {
    std::uint32_t session = 0;
    std::uint32_t applied = 0;
    bool connected = true;
    std::uint64_t carried = 0;
    std::map<std::uint32_t, wire::Command> waiting;
  };
  void tick();
  void publish(bool whole);
  void publish_status();
  void take(const wire::Command& command);
  void apply(Avatar& avatar, const wire::Command& command);

  const WorldDefinition& world_;
  Options options_;
  boost::asio::io_context io_;
  WorldClock clock_;
  boost::asio::steady_timer timer_;
  std::unique_ptr<PeerLinks> links_;
  std::uint16_t port_ = 0;
  std::int64_t tick_ = 0;
  std::int64_t next_us_ = 0;
  std::vector<PeerId> gateways_;
  std::map<std::uint32_t, Avatar> avatars_;
  std::vector<std::uint32_t> removed_;
  mutable std::mutex mutex_;
  std::vector<wire::Command> applied_;
  std::thread thread_;
};

}  // namespace aureole::test
