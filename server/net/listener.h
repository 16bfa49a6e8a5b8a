// Accepting connections at one place, for as long as it takes.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <functional>
#include <memory>

#include "server/base/result.h"
#include "server/net/endpoint.h"
#include "server/net/rare_warning.h"

namespace aureole {

/// Runs on the io_context's one thread. Owned by a shared_ptr: what is under way keeps it until
/// stop().
class Listener : public std::enable_shared_from_this<Listener> {
 public:
  using Accepted = std::function<void(boost::asio::ip::tcp::socket)>;
  Listener(boost::asio::io_context& io, Accepted accepted);

  /// Accepts from now on; port 0 picks one. Returns the port. Errors: no such address or name here,
  /// or somebody else listens there.
  Result<std::uint16_t> listen(const Endpoint& at);
  /// No callback comes afterwards.
  void stop();

 private:
  void accept();

  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer pause_;
  Accepted accepted_;
  RareWarning failing_;
  bool stopped_ = false;
};

}  // namespace aureole
