// Resolving, connecting, and the pauses between tries.
#include "server/net/links/dialler.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <utility>

#include "server/net/links/handshake.h"

namespace aureole {
namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;

/// Servers that start together miss each other a few times; only a longer absence is news.
constexpr std::chrono::milliseconds quiet_pause{400};

}  // namespace

Dialler::Dialler(boost::asio::io_context& io, PeerAddress address, Events events)
    : address_(std::move(address)),
      events_(std::move(events)),
      resolver_(io),
      connecting_(io),
      timer_(io) {}

void Dialler::dial() {
  if (stopped_ || !events_.wanted()) return;
  resolver_.async_resolve(address_.at.host, std::to_string(address_.at.port),
                          [self = shared_from_this()](const error_code& ec, const auto& found) {
                            if (self->stopped_) return;
                            if (ec) return self->dial_later(ec.message());
                            self->connect(found);
                          });
}

void Dialler::connect(const tcp::resolver::results_type& found) {
  boost::asio::async_connect(
      connecting_, found, [self = shared_from_this()](const error_code& ec, const tcp::endpoint&) {
        if (self->stopped_) return;
        tcp::socket socket =
            std::exchange(self->connecting_, tcp::socket(self->timer_.get_executor()));
        if (ec) return self->dial_later(ec.message());
        self->events_.connected(self, std::move(socket));
      });
}

void Dialler::dial_later(const std::string& why) {
  if (stopped_) return;
  if (why != last_failure_ && pause_ >= quiet_pause) {
    spdlog::info("{} at {}:{} does not answer yet ({}); trying on", describe(address_.peer),
                 address_.at.host, address_.at.port, why);
    last_failure_ = why;
  }
  const auto half = pause_.count() / 2;
  timer_.expires_after(std::chrono::milliseconds(
      half + std::uniform_int_distribution<std::int64_t>(0, half)(jitter_)));
  pause_ = std::min(pause_ * 2, pause_max);
  timer_.async_wait([self = shared_from_this()](const error_code& ec) {
    if (!ec) self->dial();
  });
}

void Dialler::note_met() {
  pause_ = pause_min;
  last_failure_.clear();
}

void Dialler::note_refused() {
  pause_ = pause_max;
}

void Dialler::stop() {
  stopped_ = true;
  resolver_.cancel();
  timer_.cancel();
  error_code ec;
  connecting_.close(ec);
}

}  // namespace aureole
