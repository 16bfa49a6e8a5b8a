// One WebSocket: a read at a time, a write at a time, and slots of fixed size for what waits.
#pragma once

#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <functional>
#include <memory>

#include "server/gateway/web/connection.h"

namespace aureole {

struct WebSocketOptions {
  int max_messages_per_s = 400;
  int idle_s = 30;       ///< Pinged after half of it in silence, closed after all of it.
  int handshake_s = 10;  ///< For opening and for closing.
};

/// Answers the upgrade request. Once the WebSocket is open, `opened` is given the connection, and
/// has to start() it; if it never opens, nothing is called. `guard` lives as long as the
/// connection.
/// Returns a function that gives up a WebSocket that has not opened yet; later it does nothing.
std::function<void()> accept_websocket(
    boost::beast::tcp_stream stream,
    boost::beast::http::request<boost::beast::http::empty_body> upgrade,
    const WebSocketOptions& options, std::shared_ptr<void> guard,
    std::function<void(std::shared_ptr<Connection>)> opened);

}  // namespace aureole
