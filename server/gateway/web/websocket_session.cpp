// The WebSocket behind Connection, by Boost.Beast.
#include "server/gateway/web/websocket_session.h"

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/bind_handler.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <deque>
#include <optional>

#include "server/net/world_clock.h"

namespace aureole {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::asio::ip::tcp;
using boost::system::error_code;

/// So long a browser may take to hear an error, and to agree that the server goes.
/// Longer than what is allowed, so that who sends too much is told so.
constexpr std::size_t readable_bytes = 4 * max_browser_message_bytes;
constexpr std::chrono::milliseconds last_words_time{2'000}, going_away_time{500};

/// So many messages may come at once when the network had held them up.
class TokenBucket {
 public:
  explicit TokenBucket(int per_s) : per_s_(per_s), tokens_(per_s) {}
  bool take(std::int64_t now_us) {
    if (last_us_ != 0)
      tokens_ = std::min(tokens_ + static_cast<double>(now_us - last_us_) * per_s_ / 1e6, per_s_);
    last_us_ = now_us;
    if (tokens_ < 1) return false;
    tokens_ -= 1;
    return true;
  }

 private:
  double per_s_;
  double tokens_;
  std::int64_t last_us_ = 0;
};

std::string remote_name(const tcp::socket& socket) {
  error_code failed;
  const auto remote = socket.remote_endpoint(failed);
  if (failed) return "gone";
  return fmt::format("{}:{}", remote.address().to_string(), remote.port());
}

class WebSocketSession : public Connection, public std::enable_shared_from_this<WebSocketSession> {
 public:
  WebSocketSession(beast::tcp_stream stream, const WebSocketOptions& options,
                   std::shared_ptr<void> guard)
      : remote_(remote_name(stream.socket())),
        ws_(std::move(stream)),
        linger_(ws_.get_executor()),
        bucket_(options.max_messages_per_s),
        options_(options),
        guard_(std::move(guard)) {}

  void accept(http::request<http::empty_body> upgrade,
              std::function<void(std::shared_ptr<Connection>)> opened) {
    error_code ignored;
    ws_.next_layer().socket().set_option(tcp::no_delay(true), ignored);
    ws_.next_layer().expires_never();  // from here on the WebSocket's own time-outs count
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = std::chrono::seconds(options_.handshake_s);
    timeout.idle_timeout = std::chrono::seconds(options_.idle_s);
    timeout.keep_alive_pings = true;
    ws_.set_option(timeout);
    ws_.read_message_max(readable_bytes);
    ws_.auto_fragment(false);  // a picture is one frame: header and data go out in one call
    upgrade_ = std::move(upgrade);
    ws_.async_accept(upgrade_,
                     [self = shared_from_this(), opened = std::move(opened)](error_code e) {
                       if (e || self->closed_) return;
                       self->opened_ = true;
                       opened(self);
                     });
  }

  void start(ConnectionEvents events) override {
    events_ = std::move(events);
    read();
  }

  void send_text(std::string text) override {
    if (closing_ || closed_) return;
    if (texts_.size() >= max_queued_texts) return fail("it does not take in what it is sent");
    texts_.push_back(std::move(text));
    write();
  }

  void send_status(std::string text) override {
    if (closing_ || closed_) return;
    status_ = std::move(text);
    write();
  }

  void send_picture(OutgoingPicture picture) override {
    if (closing_ || closed_) return;
    picture_ = std::move(picture);
    write();
  }

  bool picture_waiting() const override { return picture_.has_value(); }

  void close(const std::string& sentence) override {
    if (closing_ || closed_) return;
    closing_ = true;
    closing_reason_ = sentence;
    status_.reset();
    picture_.reset();
    texts_.clear();
    if (!sentence.empty()) texts_.push_back(error_text(sentence));
    // A browser that takes nothing in any more must not keep the connection open.
    linger_.expires_after(sentence.empty() ? going_away_time : last_words_time);
    linger_.async_wait([self = shared_from_this()](error_code e) {
      if (!e) self->fail(self->closing_reason_);
    });
    write();
  }

  const std::string& remote() const override { return remote_; }

  void give_up_unless_open() {
    if (!opened_) fail("the server stops");
  }

 private:
  void read() {
    ws_.async_read(buffer_,
                   [self = shared_from_this()](error_code e, std::size_t) { self->on_read(e); });
  }

  void on_read(error_code e) {
    if (closed_) return;
    if (e) return fail(closing_ ? closing_reason_ : reason_of(e));
    if (!closing_) {
      if (!bucket_.take(monotonic_us())) {
        close(fmt::format("More than {} messages came in a second", options_.max_messages_per_s));
      } else if (!ws_.got_text()) {
        close("Messages of a browser must be text");
      } else {
        const auto data = buffer_.cdata();
        events_.text(std::string_view(static_cast<const char*>(data.data()), data.size()));
      }
    }
    buffer_.consume(buffer_.size());
    if (!closed_) read();
  }

  static std::string reason_of(error_code e) {
    if (e == websocket::error::closed) return "the browser closed it";
    if (e == beast::error::timeout) return "nothing was heard for too long";
    return e.message();
  }

  /// Texts first: they are small, and an error must not wait for a picture.
  void write() {
    if (writing_ || closed_) return;
    const auto done = [self = shared_from_this()](error_code e, std::size_t) { self->on_write(e); };
    if (!texts_.empty() || status_) {
      writing_ = true;
      if (!texts_.empty()) {
        text_written_ = std::move(texts_.front());
        texts_.pop_front();
      } else {
        text_written_ = std::move(*status_);
        status_.reset();
      }
      ws_.text(true);
      ws_.async_write(asio::buffer(text_written_), done);
    } else if (picture_) {
      writing_ = true;
      picture_written_ = std::move(*picture_);
      picture_.reset();
      events_.picture_started(picture_written_.number);
      ws_.binary(true);
      ws_.async_write(std::array<asio::const_buffer, 2>{asio::buffer(picture_written_.header),
                                                        asio::buffer(*picture_written_.data)},
                      done);
    } else if (closing_) {
      writing_ = true;
      ws_.async_close(
          closing_reason_.empty() ? websocket::close_code::going_away
                                  : websocket::close_code::policy_error,
          [self = shared_from_this()](error_code) { self->fail(self->closing_reason_); });
    }
  }

  void on_write(error_code e) {
    writing_ = false;
    picture_written_ = {};
    if (closed_) return;
    if (e) return fail(closing_ ? closing_reason_ : reason_of(e));
    write();
  }

  /// The end, however it came about.
  void fail(const std::string& reason) {
    if (closed_) return;
    closed_ = true;
    linger_.cancel();
    error_code ignored;
    auto& socket = ws_.next_layer().socket();
    socket.shutdown(tcp::socket::shutdown_both, ignored);
    socket.close(ignored);
    texts_.clear();
    status_.reset();
    picture_.reset();
    // Not from inside of a call of the owner: events go out from a fresh turn of the loop.
    asio::post(ws_.get_executor(), [self = shared_from_this(), reason] {
      const ConnectionEvents events = std::move(self->events_);
      self->events_ = {};
      if (events.closed) events.closed(reason);
    });
  }

  std::string remote_;
  websocket::stream<beast::tcp_stream> ws_;
  asio::steady_timer linger_;
  http::request<http::empty_body> upgrade_;
  beast::flat_buffer buffer_{readable_bytes};
  ConnectionEvents events_;
  TokenBucket bucket_;
  WebSocketOptions options_;
  std::shared_ptr<void> guard_;

  std::deque<std::string> texts_;
  std::optional<std::string> status_;
  std::optional<OutgoingPicture> picture_;
  std::string text_written_;
  OutgoingPicture picture_written_;
  std::string closing_reason_;
  bool writing_ = false;
  bool closing_ = false;
  bool closed_ = false;
  bool opened_ = false;
};

}  // namespace

std::function<void()> accept_websocket(beast::tcp_stream stream,
                                       http::request<http::empty_body> upgrade,
                                       const WebSocketOptions& options, std::shared_ptr<void> guard,
                                       std::function<void(std::shared_ptr<Connection>)> opened) {
  const auto session =
      std::make_shared<WebSocketSession>(std::move(stream), options, std::move(guard));
  session->accept(std::move(upgrade), std::move(opened));
  return [weak = std::weak_ptr(session)] {
    if (const auto alive = weak.lock()) alive->give_up_unless_open();
  };
}

}  // namespace aureole
