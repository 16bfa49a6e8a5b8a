// One accept after the other; a pause where there are no descriptors left.
#include "server/net/listener.h"

#include <fmt/format.h>

#include <chrono>
#include <string>
#include <utility>

namespace aureole {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

Listener::Listener(asio::io_context& io, Accepted accepted)
    : acceptor_(io), pause_(io), accepted_(std::move(accepted)) {}

Result<std::uint16_t> Listener::listen(const Endpoint& at) {
  error_code failed;
  tcp::resolver resolver(acceptor_.get_executor());
  const auto found =
      resolver.resolve(at.host, std::to_string(at.port), tcp::resolver::passive, failed);
  if (failed || found.empty())
    return Error::format("cannot listen on \"{}\": {}", at.host, failed.message());
  const tcp::endpoint endpoint = *found.begin();
  acceptor_.open(endpoint.protocol(), failed);
  if (!failed) acceptor_.set_option(asio::socket_base::reuse_address(true), failed);
  if (!failed) acceptor_.bind(endpoint, failed);
  if (!failed) acceptor_.listen(asio::socket_base::max_listen_connections, failed);
  if (failed == asio::error::address_in_use)
    return Error::format("port {} of {} is taken by another program", at.port, at.host);
  if (failed) return Error::format("cannot listen on {}:{}: {}", at.host, at.port, failed.message());
  accept();
  return acceptor_.local_endpoint().port();
}

void Listener::accept() {
  acceptor_.async_accept([self = shared_from_this()](const error_code& failed, tcp::socket socket) {
    if (self->stopped_) return;
    if (failed) {
      // Out of descriptors, most likely: trying again at once would only burn the processor.
      self->failing_.say(fmt::format("cannot accept a connection: {}", failed.message()));
      self->pause_.expires_after(std::chrono::milliseconds(200));
      self->pause_.async_wait([self](const error_code& cancelled) {
        if (!cancelled && !self->stopped_) self->accept();
      });
      return;
    }
    self->accepted_(std::move(socket));
    if (!self->stopped_) self->accept();
  });
}

void Listener::stop() {
  stopped_ = true;
  error_code ignored;
  acceptor_.close(ignored);
  pause_.cancel();
}

}  // namespace aureole
