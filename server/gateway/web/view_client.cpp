// The headless client, by Boost.Beast.
#include "server/gateway/web/view_client.h"

#include <boost/asio/connect.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <mutex>
#include <thread>

#include "server/net/world_clock.h"

namespace aureole {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using boost::system::error_code;
using tcp = asio::ip::tcp;

constexpr std::size_t header_bytes = 32;

template <class T>
T read_at(const std::uint8_t* data, std::size_t at) {
  T value;
  std::memcpy(&value, data + at, sizeof value);
  return value;
}

std::chrono::duration<double> seconds(double s) {
  return std::chrono::duration<double>(s);
}

}  // namespace

/// Its handlers wait in the loop that it owns: they must not own it. They are over, or gone with
/// the loop, before it is.
struct ViewClient::Impl {
  explicit Impl(ViewClientOptions o) : options(std::move(o)), ws(io) {}

  ViewClientOptions options;
  asio::io_context io;
  asio::executor_work_guard<asio::io_context::executor_type> work = asio::make_work_guard(io);
  websocket::stream<beast::tcp_stream> ws;
  beast::flat_buffer buffer;
  std::thread thread;

  // Only on the client's own thread.
  struct Outgoing {
    std::string text;
    bool binary = false;
  };
  std::deque<Outgoing> outgoing;
  bool writing = false;
  bool stalled = false;

  mutable std::mutex mutex;
  mutable std::condition_variable changed;
  std::deque<std::string> texts;
  std::optional<ReceivedPicture> newest;
  std::vector<std::int64_t> arrivals;
  std::uint64_t bytes = 0;
  bool ended = false;

  void queue(std::string text, bool binary) {
    asio::post(io, [this, text = std::move(text), binary]() mutable {
      outgoing.push_back({std::move(text), binary});
      write();
    });
  }
  void write() {
    if (writing || outgoing.empty() || stalled) return;
    writing = true;
    ws.binary(outgoing.front().binary);
    ws.async_write(asio::buffer(outgoing.front().text), [this](error_code e, std::size_t) {
      writing = false;
      outgoing.pop_front();
      if (!e) write();
    });
  }
  void read() {
    ws.async_read(buffer, [this](error_code e, std::size_t) {
      if (e) return end();
      take();
      if (!stalled) read();
    });
  }
  void take() {
    const auto data = buffer.cdata();
    const auto* bytes_here = static_cast<const std::uint8_t*>(data.data());
    {
      const std::lock_guard lock(mutex);
      if (ws.got_text())
        texts.emplace_back(reinterpret_cast<const char*>(bytes_here), data.size());
      else
        take_picture(bytes_here, data.size());
    }
    changed.notify_all();
    buffer.consume(buffer.size());
  }
  void take_picture(const std::uint8_t* data, std::size_t size) {
    if (size < header_bytes || data[0] != 1 || data[1] != 1) return;
    const auto start = read_at<std::uint16_t>(data, 2);
    if (start < header_bytes || start > size) return;
    ReceivedPicture picture;
    picture.number = read_at<std::uint32_t>(data, 4);
    picture.world_us = read_at<std::uint64_t>(data, 8);
    picture.input_seq = read_at<std::uint32_t>(data, 16);
    picture.width = read_at<std::uint16_t>(data, 20);
    picture.height = read_at<std::uint16_t>(data, 22);
    picture.made_in_us = read_at<std::uint32_t>(data, 24);
    picture.arrived_us = monotonic_us();
    picture.jpeg.assign(data + start, data + size);
    arrivals.push_back(picture.arrived_us);
    bytes += size;
    if (options.acknowledges && !stalled)
      queue(fmt::format(R"({{"type":"ack","frame":{}}})", picture.number), false);
    newest = std::move(picture);
  }
  void end() {
    {
      const std::lock_guard lock(mutex);
      ended = true;
    }
    changed.notify_all();
  }
  template <class Condition>
  bool wait(double patience_s, Condition condition) const {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, seconds(patience_s), condition);
  }
};

ViewClient::ViewClient(ViewClientOptions options)
    : impl_(std::make_unique<Impl>(std::move(options))) {}

ViewClient::~ViewClient() {
  impl_->work.reset();
  impl_->io.stop();
  if (impl_->thread.joinable()) impl_->thread.join();
}

Status ViewClient::connect() {
  Impl& client = *impl_;
  const auto& [host, port] = client.options.gateway;
  error_code e;
  tcp::resolver resolver(client.io);
  const auto found = resolver.resolve(host, std::to_string(port), e);
  if (!e) asio::connect(client.ws.next_layer().socket(), found, e);
  if (e) return Error::format("cannot connect to {}:{}: {}", host, port, e.message());
  client.ws.next_layer().socket().set_option(tcp::no_delay(true), e);
  client.ws.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
    if (!client.options.origin.empty())
      request.set(beast::http::field::origin, client.options.origin);
  }));
  client.ws.read_message_max(16u << 20);
  client.ws.handshake(fmt::format("{}:{}", host, port), "/ws", e);
  if (e) return Error::format("the WebSocket was refused: {}", e.message());
  client.ws.set_option(websocket::stream_base::timeout::suggested(beast::role_type::client));
  client.read();
  client.thread = std::thread([impl = impl_.get()] { impl->io.run(); });
  if (!client.options.joins) return Ok{};
  const std::string token = client.options.token.empty()
                                ? std::string{}
                                : fmt::format(R"("token":"{}",)", client.options.token);
  send(fmt::format(R"({{"type":"join","version":1,{}"name":"{}","width":{},"height":{}}})", token,
                   client.options.name, client.options.width, client.options.height));
  return Ok{};
}

void ViewClient::send(std::string text) {
  impl_->queue(std::move(text), false);
}
void ViewClient::send_binary(std::string bytes) {
  impl_->queue(std::move(bytes), true);
}

void ViewClient::send_input(std::uint32_t seq, unsigned keys, double yaw, double pitch) {
  send(fmt::format(R"({{"type":"input","seq":{},"keys":{},"yaw":{},"pitch":{}}})", seq, keys, yaw,
                   pitch));
}

void ViewClient::stall() {
  asio::post(impl_->io, [impl = impl_.get()] { impl->stalled = true; });
}

void ViewClient::drop() {
  asio::post(impl_->io, [impl = impl_.get()] {
    error_code ignored;
    impl->ws.next_layer().socket().close(ignored);
  });
}

std::optional<std::string> ViewClient::wait_for_text(const std::string& part, double patience_s) {
  std::optional<std::string> found;
  impl_->wait(patience_s, [&] {
    while (!impl_->texts.empty() && !found) {
      if (impl_->texts.front().find(part) != std::string::npos) found = impl_->texts.front();
      impl_->texts.pop_front();
    }
    return found || impl_->ended;
  });
  return found;
}

bool ViewClient::wait_for_pictures(std::size_t count, double patience_s) {
  impl_->wait(patience_s, [&] { return impl_->arrivals.size() >= count || impl_->ended; });
  return pictures() >= count;
}

bool ViewClient::wait_for_end(double patience_s) {
  return impl_->wait(patience_s, [&] { return impl_->ended; });
}

std::size_t ViewClient::pictures() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->arrivals.size();
}

std::uint64_t ViewClient::picture_bytes() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->bytes;
}

std::optional<ReceivedPicture> ViewClient::newest_picture() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->newest;
}

std::vector<std::int64_t> ViewClient::arrivals_us() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->arrivals;
}

}  // namespace aureole
