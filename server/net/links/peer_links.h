// Links to all servers that this one talks to: listening, dialling, hello, reconnecting, bounded
// queues.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/frame.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/net/endpoint.h"
#include "server/net/links/dialler.h"
#include "server/net/links/secret.h"
#include "server/net/world_clock.h"

namespace aureole {

/// What the other side said of itself.
struct PeerHello {
  Incarnation incarnation;
  Incarnation known_incarnation;  ///< Of us, from an earlier link; 0 if it has never met us.
  bool running = false;
};

/// Why a server does not want this one.
struct Refusal {
  std::string reason;
  /// It knows a newer start of this one: whoever is told so has been replaced. Never told by
  /// somebody who has not proven that it knows the world's secret, if there is one.
  bool replaced = false;
  bool is_ours = false;  ///< We refused the other one, which we dialled.
};

struct PeerLinksOptions {
  PeerId self;
  Incarnation incarnation;
  std::uint64_t world_hash = 0;
  std::size_t region_count = PeerId::first_gateway;  ///< Of the world; no peer has a higher number.
  std::vector<PeerAddress> dial;                     ///< Dialled again for ever.
  /// Whoever cannot prove that it knows it is refused. None: whoever comes is believed.
  std::optional<Secret> secret;
  /// Frames queued towards one peer; past it the link is reset, and whatever must not be lost is
  /// sent again by the journal.
  std::size_t max_queued_bytes = 64u << 20;
  /// A peer that says nothing for so long is taken for gone: every side asks for the time four
  /// times a second, and a machine that has lost its power closes no connection.
  std::int64_t silence_us = 6'000'000;
};

/// Runs wholly on the io_context's one thread; callbacks come from there too.
class PeerLinks {
 public:
  struct Events {
    std::function<void(PeerId, const PeerHello&)> up;
    std::function<void(PeerId, const std::string& reason)> down;
    /// An Error ends this one link with that sentence, told to the other side as well.
    std::function<Status(PeerId, const FrameView&)> frame;
    /// Whether this server has begun to step (told in the hello).
    std::function<bool()> running;
    /// A peer refused us, or does not know our secret: nothing to retry. Optional.
    std::function<void(PeerId, const Refusal&)> refused;
    /// There is news for round_trip_us() of a link that has been measured a few times. Optional.
    std::function<void(PeerId)> measured = {};
  };

  /// `clock` is fed with samples of the reference (the linked region with the lowest id) and asked
  /// when others ask; it must outlive this.
  PeerLinks(boost::asio::io_context& io, PeerLinksOptions options, WorldClock& clock,
            Events events);
  ~PeerLinks();

  /// Starts to accept on `at`; port 0 picks one. Returns the port.
  Result<std::uint16_t> listen(const Endpoint& at);
  /// Starts to dial.
  void start();
  /// Closes everything; no callback comes afterwards.
  void stop();

  /// Queues a frame; dropped if the peer is not linked.
  void send(PeerId to, SharedBytes frame);
  bool is_linked(PeerId peer) const;
  /// Shortest recent round trip (µs), if the link has been measured.
  std::int64_t round_trip_us(PeerId peer) const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace aureole
