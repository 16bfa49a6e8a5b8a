// Requests over one connection each, with a time-out.
#include "tests/support/http_exchange.h"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <chrono>

namespace aureole::test {

namespace asio = boost::asio;
namespace beast = boost::beast;
using boost::system::error_code;
using tcp = asio::ip::tcp;

Result<HttpAnswer> http_exchange(const Endpoint& at, const std::string& request) {
  asio::io_context io;
  tcp::resolver resolver(io);
  beast::tcp_stream stream(io);
  error_code e;
  const auto found = resolver.resolve(at.host, std::to_string(at.port), e);
  if (!e) asio::connect(stream.socket(), found, e);
  if (!e) asio::write(stream.socket(), asio::buffer(request), e);
  if (e) return Error::format("no answer to an HTTP request: {}", e.message());
  // Asynchronous only for the sake of the time-out.
  std::string all;
  stream.expires_after(std::chrono::seconds(20));
  asio::async_read(stream, asio::dynamic_buffer(all),
                   [&](error_code end, std::size_t) { e = end; });
  io.run();
  const std::size_t head_end = all.find("\r\n\r\n");
  if (head_end == std::string::npos || all.size() < 12)
    return Error::format("an HTTP answer broke off after {} bytes", all.size());
  HttpAnswer answer;
  answer.head = all.substr(0, head_end);
  answer.body = all.substr(head_end + 4);
  answer.status = static_cast<unsigned>(std::stoul(all.substr(9, 3)));
  return answer;
}

Result<HttpAnswer> http_get_from(const Endpoint& at, const std::string& path) {
  return http_exchange(
      at, fmt::format("GET {} HTTP/1.1\r\nHost: {}:{}\r\nConnection: close\r\n\r\n", path, at.host,
                      at.port));
}

}  // namespace aureole::test
