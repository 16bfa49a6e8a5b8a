// Being asked to stop, and not outliving one's parent.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>

namespace aureole {

/// Calls back once, from the io_context's thread, on the first SIGINT or SIGTERM. Destroying it
/// stops the watch, so that io_context::run can end.
class StopSignals {
 public:
  StopSignals(boost::asio::io_context& io, std::function<void(int signal)> stop);
  ~StopSignals();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A peer that hangs up shows as an error of the write, not as the end of this process.
void ignore_broken_pipes();

}  // namespace aureole
