// SIGINT and SIGTERM as a callback; see signals.h.
#include "server/ops/process/signals.h"

#include <boost/asio/signal_set.hpp>
#include <csignal>
#include <utility>

namespace aureole {

struct StopSignals::Impl {
  boost::asio::signal_set signals;
};

StopSignals::StopSignals(boost::asio::io_context& io, std::function<void(int)> stop)
    : impl_(new Impl{boost::asio::signal_set(io, SIGINT, SIGTERM)}) {
  impl_->signals.async_wait(
      [stop = std::move(stop)](const boost::system::error_code& error, int signal) {
        if (!error) stop(signal);
      });
}

StopSignals::~StopSignals() = default;

void ignore_broken_pipes() {
  std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace aureole
