// The gateway's ear on the regions: links, replicas, their status, and the moment that can be
// drawn.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/wire.h"
#include "server/gateway/pictures/draw_clock.h"
#include "server/net/links/peer_links.h"
#include "server/net/world_clock.h"
#include "server/region/lines/home_lines.h"
#include "server/region/status/status_message.h"
#include "server/replica/replica_store.h"
#include "server/worlds/world.h"

namespace aureole {

struct RegionSubscriberOptions {
  std::uint16_t gateway = 0;
  Incarnation incarnation;
  std::vector<PeerAddress> regions;
  std::optional<Secret> secret;  ///< Of the world's servers, if they have one.
};

/// Runs on the io_context's one thread.
class RegionSubscriber {
 public:
  struct Events {
    /// A region's update has been taken in.
    std::function<void(RegionId)> updated;
    /// A region was linked, became complete, or was lost.
    std::function<void()> changed;
    /// A region refuses this gateway, and trying again will not help: another one was started
    /// under its number, or the world is another one (known as long as no region has been linked).
    std::function<void(const std::string& why)> rejected;
  };

  /// `world` must outlive it; `options.regions` must name regions of the world.
  RegionSubscriber(boost::asio::io_context& io, const WorldDefinition& world,
                   RegionSubscriberOptions options, Events events);

  void start() { links_.start(); }
  void stop() { links_.stop(); }

  const ReplicaStore& store() const { return store_; }
  bool is_linked(RegionId region) const { return links_.is_linked(PeerId::region(region)); }
  /// Linked, and its whole state is here.
  bool is_complete(RegionId region) const;
  bool all_complete() const;
  /// Names of regions that are not complete.
  std::vector<std::string> missing() const;
  std::size_t linked_count() const;

  void send(RegionId to, std::span<const wire::Command> commands);
  /// World time to draw at local time `local_us`; nothing until a region has been heard.
  std::optional<std::int64_t> draw_us(std::int64_t local_us) {
    return draw_clock_.world_us(local_us);
  }
  /// Where regions end at this world time, as far as has been heard; see HomeLines. Valid until it
  /// is asked again. Time goes forwards.
  const PartitionMap& map_at(std::int64_t world_us);
  /// What each last said of itself: by region number, one for each region of the world.
  const std::vector<RegionReport>& reports() const { return reports_; }
  const std::string& name_of(RegionId region) const { return world_.regions[region.value].name; }

 private:
  Status on_frame(PeerId from, const FrameView& frame);
  Status on_status(RegionId from, const FrameView& frame);
  Status on_recovery_query(RegionId from, const FrameView& frame);
  void on_up(PeerId peer);
  void on_down(PeerId peer, const std::string& reason);
  void on_refused(PeerId peer, const Refusal& refusal);

  const WorldDefinition& world_;
  std::vector<RegionId> regions_;
  Events events_;
  ReplicaStore store_;
  DrawClock draw_clock_;
  WorldClock world_clock_;
  HomeLines lines_;
  std::vector<RegionReport> reports_;
  bool was_linked_ = false;  ///< With any region.
  PeerLinks links_;
};

}  // namespace aureole
