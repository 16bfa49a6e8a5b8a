// HTTP connections, by Boost.Beast.
#include "server/gateway/web/http_server.h"

#include <utility>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <cctype>
#include <chrono>
#include <optional>
#include <set>
#include <vector>

#include "server/gateway/web/websocket_session.h"
#include "server/net/listener.h"

namespace aureole {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::size_t max_header_bytes = 8192;
/// For a request to come in, and between requests on a connection that is kept.
constexpr std::chrono::seconds request_time{15};
/// For an answer to be made and taken in.
constexpr std::chrono::seconds answer_time{30};

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

bool is_websocket(const http::request<http::empty_body>& request) {
  return beast::websocket::is_upgrade(request) && view(request.target()).substr(0, 3) == "/ws" &&
         (request.target().size() == 3 || request.target()[3] == '?');
}

/// Host name of "name", "name:port" or "[address]:port".
std::string_view host_name(std::string_view authority) {
  if (!authority.empty() && authority.front() == '[')
    return authority.substr(0, std::min(authority.find(']') + 1, authority.size()));
  return authority.substr(0, std::min(authority.find(':'), authority.size()));
}

/// A name of this machine that no other machine's page can have. A page that has let its own name
/// point here (DNS rebinding) comes with that name.
bool is_own_name(std::string_view host) {
  const std::string_view name = host_name(host);
  error_code no_address;
  const auto address = asio::ip::make_address(
      std::string(name.starts_with('[') ? name.substr(1, name.size() - 2) : name), no_address);
  return no_address ? name == "localhost" : address.is_loopback();
}

}  // namespace

bool is_same_host(std::string_view origin, std::string_view host) {
  if (origin.empty()) return true;
  const std::size_t scheme = origin.find("://");
  if (scheme == std::string_view::npos) return false;  // "null" among them
  const std::string_view a = host_name(origin.substr(scheme + 3)), b = host_name(host);
  return !a.empty() && std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) ==
           std::tolower(static_cast<unsigned char>(y));
  });
}

HttpResponse plain_response(unsigned status, std::string sentence) {
  return {status, "text/plain; charset=utf-8", std::move(sentence) + "\n", {}};
}

/// A connection's place among those that are allowed; kept by whatever of it is left.
struct HttpServer::Place {
  std::shared_ptr<Impl> server;
  std::function<void()> close;  ///< Ends the connection at once.
  ~Place();
};

struct HttpServer::Impl : std::enable_shared_from_this<Impl> {
  Impl(asio::io_context& context, HttpServerOptions o, Handlers h)
      : io(context),
        options(std::move(o)),
        handlers(std::move(h)) {}

  Result<std::uint16_t> listen();
  void admit(tcp::socket socket);

  asio::io_context& io;
  std::shared_ptr<Listener> listener;
  HttpServerOptions options;
  Handlers handlers;
  std::set<Place*> places;
  bool stopped = false;
};

HttpServer::Place::~Place() {
  server->places.erase(this);
}

namespace {

/// One connection that speaks HTTP, until it closes or becomes a WebSocket.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(tcp::socket socket, HttpServer::Handlers* handlers,
              std::shared_ptr<HttpServer::Place> place)
      : stream_(std::move(socket)), handlers_(handlers), place_(std::move(place)) {
    error_code failed;
    const auto remote = stream_.socket().remote_endpoint(failed);
    is_local_ = !failed && is_loopback(remote.address());
  }

  void start() {
    place_->close = [weak = weak_from_this()] {
      if (const auto self = weak.lock()) self->stream_.close();
    };
    read();
  }

 private:
  void read() {
    parser_.emplace();
    parser_->header_limit(max_header_bytes);
    parser_->body_limit(std::uint64_t{0});
    stream_.expires_after(request_time);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](error_code e, std::size_t) { self->on_read(e); });
  }

  static bool is_loopback(const asio::ip::address& address) {
    if (address.is_v6() && address.to_v6().is_v4_mapped())
      return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()).is_loopback();
    return address.is_loopback();
  }

  void on_read(error_code e) {
    if (e == http::error::end_of_stream) return close();
    if (e == http::error::header_limit) return refuse(431, "The request's header is too long.");
    if (e == http::error::unexpected_body || e == http::error::body_limit)
      return refuse(413, "Requests may not carry a body here.");
    if (e.category() == http::make_error_code(http::error::bad_method).category())
      return refuse(400, "This is not an HTTP request that can be understood.");
    if (e) return;  // reset or timed out: there is nobody to tell

    request_ = parser_->release();
    if (request_.count(http::field::host) > 1)
      return refuse(400, "A request has one Host; this one has several.");
    if (is_websocket(request_)) return upgrade();
    head_ = request_.method() == http::verb::head;
    if (!head_ && request_.method() != http::verb::get)
      return refuse(405, "Only GET and HEAD are served here.");
    handle();
  }

  void upgrade() {
    if (!is_same_host(view(request_[http::field::origin]), view(request_[http::field::host])))
      return refuse(403, "Pages of other hosts may not connect to this one.");
    if (!handlers_->websocket) return refuse(503, "The server is stopping.");
    const std::shared_ptr<HttpServer::Place> place = std::move(place_);
    place->close = accept_websocket(std::move(stream_), std::move(request_), {}, place,
                                    [handlers = handlers_](std::shared_ptr<Connection> connection) {
                                      // The connection holds its place, and so the server with
                                      // these handlers.
                                      if (handlers->websocket)
                                        handlers->websocket(std::move(connection));
                                    });
  }

  void handle() {
    const std::string_view target = view(request_.target());
    const std::size_t question = std::min(target.find('?'), target.size());
    HttpRequest request;
    request.path = target.substr(0, question);
    request.query = target.substr(std::min(question + 1, target.size()));
    request.if_none_match = view(request_[http::field::if_none_match]);
    request.from_loopback = is_local_ && is_own_name(view(request_[http::field::host])) &&
                            request_.count("X-Forwarded-For") == 0 &&
                            request_.count("Forwarded") == 0;
    if (!handlers_->request) return refuse(503, "The server is stopping.");
    // Nothing is read while an answer is being made, so that one connection is one request.
    stream_.expires_after(answer_time);
    handlers_->request(request, [self = shared_from_this()](HttpResponse response) {
      self->respond(std::move(response));
    });
  }

  void refuse(unsigned status, std::string sentence) {
    keep_alive_ = false;
    respond(plain_response(status, std::move(sentence)));
  }

  void respond(HttpResponse answer) {
    const unsigned version = request_.version() == 10 ? 10 : 11;
    http::response<http::string_body> response{http::int_to_status(answer.status), version};
    response.set(http::field::content_type, answer.content_type);
    response.set(http::field::cache_control, "no-cache");
    response.set("X-Content-Type-Options", "nosniff");
    response.set("X-Frame-Options", "SAMEORIGIN");
    if (!answer.etag.empty()) response.set(http::field::etag, answer.etag);
    if (answer.status == 405) response.set(http::field::allow, "GET, HEAD");
    keep_alive_ = keep_alive_ && request_.keep_alive();
    response.keep_alive(keep_alive_);
    response.content_length(answer.body.size());
    if (!head_ && answer.status != 304) response.body() = std::move(answer.body);
    if (answer.status == 304) response.erase(http::field::content_length);
    send(std::make_shared<http::response<http::string_body>>(std::move(response)));
  }

  void send(const std::shared_ptr<http::response<http::string_body>>& response) {
    stream_.expires_after(answer_time);
    http::async_write(stream_, *response,
                      [self = shared_from_this(), response](error_code e, std::size_t) {
                        if (e) return;
                        if (!self->keep_alive_) return self->close();
                        self->read();
                      });
  }

  /// Lets the answer arrive before the socket goes; what the client still sends is left unread.
  void close() {
    error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  beast::tcp_stream stream_;
  HttpServer::Handlers* handlers_;  ///< Lives as long as place_.
  std::shared_ptr<HttpServer::Place> place_;
  beast::flat_buffer buffer_{2 * max_header_bytes};
  std::optional<http::request_parser<http::empty_body>> parser_;
  http::request<http::empty_body> request_;
  bool is_local_ = false;
  bool head_ = false;
  bool keep_alive_ = true;
};

}  // namespace

Result<std::uint16_t> HttpServer::Impl::listen() {
  listener = std::make_shared<Listener>(io, [weak = weak_from_this()](tcp::socket socket) {
    const auto self = weak.lock();
    if (self && self->places.size() < self->options.max_connections) self->admit(std::move(socket));
  });
  return listener->listen(options.listen);
}

void HttpServer::Impl::admit(tcp::socket socket) {
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  const auto place = std::make_shared<Place>();
  place->server = shared_from_this();
  places.insert(place.get());
  std::make_shared<HttpSession>(std::move(socket), &handlers, place)->start();
}

HttpServer::HttpServer(asio::io_context& io, HttpServerOptions options, Handlers handlers)
    : impl_(std::make_shared<Impl>(io, std::move(options), std::move(handlers))) {}

HttpServer::~HttpServer() {
  stop();
}

Result<std::uint16_t> HttpServer::start() {
  return impl_->listen();
}

void HttpServer::stop() {
  if (impl_->stopped) return;
  impl_->stopped = true;
  impl_->handlers = {};
  if (impl_->listener) impl_->listener->stop();
  // Copied: closing may end the last of a connection, and with it its place.
  std::vector<std::function<void()>> closers;
  for (const Place* place : impl_->places) closers.push_back(place->close);
  for (const auto& close : closers) close();
}

}  // namespace aureole
