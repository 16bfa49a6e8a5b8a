// Reading and writing frames over one TCP connection.
#include "server/net/links/link.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <vector>

namespace aureole {
namespace {

/// Frames joined into one system call.
constexpr std::size_t gather_max = 64;
/// A link that was told to close has this long to get its last frame out.
constexpr auto linger = std::chrono::milliseconds(500);

}  // namespace

Link::Link(boost::asio::ip::tcp::socket socket, std::size_t max_queued_bytes)
    : socket_(std::move(socket)),
      linger_(socket_.get_executor()),
      max_queued_bytes_(max_queued_bytes) {
  boost::system::error_code ec;
  // Every frame is wanted now, not when a segment is full.
  socket_.set_option(boost::asio::ip::tcp::no_delay(true), ec);
  const auto at = socket_.remote_endpoint(ec);
  remote_ = ec ? "an unknown address" : at.address().to_string() + ":" + std::to_string(at.port());
}

void Link::start(Events events) {
  events_ = std::move(events);
  read();
}

void Link::read() {
  socket_.async_read_some(
      boost::asio::buffer(chunk_),
      [self = shared_from_this()](const boost::system::error_code& ec, std::size_t bytes) {
        if (self->closed_) return;
        if (ec) return self->close("the other side is gone (" + ec.message() + ")");
        if (self->closing_) return self->read();
        if (auto fed = self->reader_.feed(std::span(self->chunk_).first(bytes)); !fed)
          return self->close(fed.error().message);
        while (auto frame = self->reader_.next()) {
          const Status taken = self->events_.frame(*frame);
          if (self->closed_) return;
          if (self->closing_) break;
          if (!taken) return self->close(taken.error().message);
        }
        self->read();
      });
}

void Link::send(SharedBytes frame) {
  if (closed_ || closing_) return;
  queued_bytes_ += frame->size();
  queue_.push_back(std::move(frame));
  if (queued_bytes_ > max_queued_bytes_)
    return close("the other side does not take its messages: " + std::to_string(queued_bytes_) +
                 " bytes are waiting");
  write();
}

void Link::write() {
  if (!in_flight_.empty() || queue_.empty() || closed_) return;
  std::vector<boost::asio::const_buffer> buffers;
  while (!queue_.empty() && in_flight_.size() < gather_max) {
    in_flight_.push_back(std::move(queue_.front()));
    queue_.pop_front();
    buffers.emplace_back(in_flight_.back()->data(), in_flight_.back()->size());
  }
  boost::asio::async_write(
      socket_, buffers,
      [self = shared_from_this()](const boost::system::error_code& ec, std::size_t bytes) {
        if (self->closed_) return;
        if (ec) return self->close("the other side is gone (" + ec.message() + ")");
        self->queued_bytes_ -= bytes;
        self->in_flight_.clear();
        if (self->queue_.empty() && self->closing_) return self->close(self->closing_reason_);
        self->write();
      });
}

void Link::close_after(SharedBytes last, const std::string& reason) {
  if (closed_ || closing_) return;
  queued_bytes_ += last->size();
  queue_.push_back(std::move(last));
  closing_ = true;
  closing_reason_ = reason;
  linger_.expires_after(linger);
  linger_.async_wait([self = shared_from_this()](const boost::system::error_code& ec) {
    if (!ec) self->close(self->closing_reason_);
  });
  write();
}

void Link::close(const std::string& reason) {
  if (closed_) return;
  closed_ = true;
  boost::system::error_code ec;
  linger_.cancel();
  socket_.shutdown(boost::asio::ip::tcp::socket::shutdown_both, ec);
  socket_.close(ec);
  // We may be inside one of these functions right now: they die later, in a call of their own.
  auto events = std::make_shared<Events>(std::move(events_));
  events_ = {};
  boost::asio::post(linger_.get_executor(), [self = shared_from_this(), events] {});
  if (events->closed) events->closed(reason);
}

}  // namespace aureole
