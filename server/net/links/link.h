// One TCP connection that carries frames: reading, and a bounded queue for writing.
#pragma once

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "protocol/frame.h"

namespace aureole {

/// Lives as long as its socket works; its owner hears of the end exactly once, through `closed`.
class Link : public std::enable_shared_from_this<Link> {
 public:
  struct Events {
    /// An Error closes the link with that sentence.
    std::function<Status(const FrameView&)> frame;
    std::function<void(const std::string& reason)> closed;
  };

  Link(boost::asio::ip::tcp::socket socket, std::size_t max_queued_bytes);

  void start(Events events);
  /// Longer frames are allowed once the other side has said who it is.
  void allow_payload(std::size_t bytes) { reader_.set_max_payload(bytes); }
  /// Queues a frame; past the bound the link is closed.
  void send(SharedBytes frame);
  /// Sends what is queued plus a last frame, then closes.
  void close_after(SharedBytes last, const std::string& reason);
  void close(const std::string& reason);
  bool is_open() const { return !closed_; }
  /// "127.0.0.1:4711", for logs.
  const std::string& remote() const { return remote_; }

 private:
  void read();
  void write();

  boost::asio::ip::tcp::socket socket_;
  boost::asio::steady_timer linger_;
  std::string remote_;
  Events events_;
  FrameReader reader_;
  std::array<std::byte, 64 << 10> chunk_;
  std::deque<SharedBytes> queue_;      ///< Not yet given to the socket.
  std::deque<SharedBytes> in_flight_;  ///< Being written, several in one call.
  std::size_t queued_bytes_ = 0;
  std::size_t max_queued_bytes_;
  bool closing_ = false;
  bool closed_ = false;
  std::string closing_reason_;
};

}  // namespace aureole
