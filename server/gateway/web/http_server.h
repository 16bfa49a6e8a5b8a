// HTTP for the page and the tools, and the door through which WebSockets come in.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/base/result.h"
#include "server/gateway/web/connection.h"
#include "server/net/endpoint.h"

namespace aureole {

/// A GET or HEAD without body.
struct HttpRequest {
  std::string path;   ///< As sent, without the query.
  std::string query;  ///< Without "?".
  std::string if_none_match;
  bool from_loopback = false;  ///< Straight from this machine, with no proxy in between.
};

struct HttpResponse {
  unsigned status = 200;
  std::string content_type = "application/json";
  std::string body;
  std::string etag;  ///< Left out if empty.
};

/// A sentence as plain text.
HttpResponse plain_response(unsigned status, std::string sentence);

struct HttpServerOptions {
  Endpoint listen;
  std::size_t max_connections = 256;  ///< WebSockets included; more are closed at once.
};

/// Runs wholly on the io_context's one thread; handlers are called from there.
class HttpServer {
 public:
  using Respond = std::function<void(HttpResponse)>;
  struct Handlers {
    /// Answers now or later, once. Later than `answer_s` is too late: the connection is closed.
    std::function<void(const HttpRequest&, Respond)> request;
    /// A WebSocket on /ws has been opened by a page of this host (or by no page).
    std::function<void(std::shared_ptr<Connection>)> websocket;
  };

  HttpServer(boost::asio::io_context& io, HttpServerOptions options, Handlers handlers);
  ~HttpServer();
  /// Listens; port 0 picks one. Returns the port, or why not: a sentence.
  Result<std::uint16_t> start();
  /// Closes all connections but WebSockets that are open: these go with their owners. No handler is
  /// called afterwards.
  void stop();

  struct Place;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

/// Whether a request with this Origin may open a WebSocket of `host` (its Host header): pages of
/// the same host name, whatever the port, and programs that send no Origin.
bool is_same_host(std::string_view origin, std::string_view host);

}  // namespace aureole
