// The gateway: regions on one side, browsers on the other, pictures of the world in between.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/net/endpoint.h"
#include "server/net/links/secret.h"
#include "server/worlds/world.h"

namespace aureole {

struct GatewayOptions {
  std::uint16_t number = 0;  ///< Among the world's gateways.
  Incarnation incarnation;
  Endpoint listen{"127.0.0.1", 8080};
  std::vector<PeerAddress> regions;  ///< All regions of the world.
  std::optional<Secret> secret;      ///< Of the world's servers, if they have one.
  std::filesystem::path web_root;    ///< The built page; without it there is none.
  int render_threads = 0;            ///< 0: as many as this machine should have.
  int max_players = 32;
  /// A region refuses this gateway for good: the sentence says why. Whoever owns it should stop it.
  std::function<void(const std::string& why)> rejected = [](const std::string&) {};
};

/// Serves, on one port:
/// - the player page, and its WebSocket at `/ws` (protocol/WIRE_FORMAT.md),
/// - `/healthz`: 200 once every region is linked and its whole state is here, else 503 and which
/// are not,
/// - `/api/status`: JSON with `world_time_s`, `bodies`, `players`, `regions`, `player_list`,
/// `pictures`,
/// - to this machine only `/api/replicas` (JSON of all bodies) and `/api/frame.jpg` (one picture
/// from a
///   camera of one's choice; see parse_frame_query in api.h).
///
/// Runs on the io_context's one thread (exactly one may run it), and draws on threads of its own.
class Gateway {
 public:
  /// `io` and `world` must outlive it. Make it before the process starts other threads.
  Gateway(boost::asio::io_context& io, const WorldDefinition& world, GatewayOptions options);
  ~Gateway();

  /// Starts the render threads, listens (port 0 picks one) and dials the regions. Returns the port.
  /// Errors: no OpenGL context, port taken, an address that cannot be listened on; sentences.
  Result<std::uint16_t> start();
  /// Closes everything; afterwards the io_context runs out of this gateway's work within 2 s.
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aureole
