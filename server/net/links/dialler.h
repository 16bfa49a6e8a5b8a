// Dials one peer, again and again, ever more seldom.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <random>
#include <string>

#include "server/base/ids.h"
#include "server/net/endpoint.h"

namespace aureole {

/// Tries lie 50 ms to 2 s apart, less up to half of that by chance, so that servers that start
/// together do not stay in step. Runs on the io_context's one thread. Owned by a
/// shared_ptr: a try that is under way keeps it.
class Dialler : public std::enable_shared_from_this<Dialler> {
 public:
  struct Events {
    /// Whether there is no link yet: asked before each try.
    std::function<bool()> wanted;
    std::function<void(const std::shared_ptr<Dialler>&, boost::asio::ip::tcp::socket)> connected;
  };
  Dialler(boost::asio::io_context& io, PeerAddress address, Events events);

  PeerId peer() const { return address_.peer; }
  void dial();
  /// After a pause, which is twice as long the next time.
  void dial_later(const std::string& why);
  /// It is the one that was looked for: the next try, should the link end, comes soon.
  void note_met();
  /// It will not have us: the next try comes as late as any.
  void note_refused();
  /// Closes a try that is under way. No callback comes afterwards.
  void stop();

 private:
  void connect(const boost::asio::ip::tcp::resolver::results_type& found);

  static constexpr std::chrono::milliseconds pause_min{50};
  static constexpr std::chrono::milliseconds pause_max{2000};

  PeerAddress address_;
  Events events_;
  boost::asio::ip::tcp::resolver resolver_;
  boost::asio::ip::tcp::socket connecting_;  ///< A try may last for minutes.
  boost::asio::steady_timer timer_;
  std::chrono::milliseconds pause_ = pause_min;
  std::string last_failure_;  ///< Said once, not at each try.
  std::minstd_rand jitter_{std::random_device{}()};
  bool stopped_ = false;
};

}  // namespace aureole
