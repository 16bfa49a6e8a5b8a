// URLs and answers that come from people and from sockets.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <thread>

#include "server/ops/http_get.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

/// Listens on a free loopback port and answers one connection with `answer`; keeps it open if told.
class OneAnswer {
 public:
  explicit OneAnswer(std::string answer, bool then_close = true) {
    fd_ = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(bind(fd_, reinterpret_cast<sockaddr*>(&at), sizeof at) == 0);
    REQUIRE(::listen(fd_, 1) == 0);
    socklen_t size = sizeof at;
    getsockname(fd_, reinterpret_cast<sockaddr*>(&at), &size);
    url = "http://127.0.0.1:" + std::to_string(ntohs(at.sin_port)) + "/page";
    thread_ = std::thread([this, answer = std::move(answer), then_close] {
      const int link = accept(fd_, nullptr, nullptr);
      char part[2048];
      const ssize_t n = recv(link, part, sizeof part, 0);
      asked.assign(part, n > 0 ? static_cast<std::size_t>(n) : 0);
      send(link, answer.data(), answer.size(), MSG_NOSIGNAL);
      if (!then_close) {
        while (recv(link, part, sizeof part, 0) > 0) {
        }
      }
      close(link);
    });
  }
  ~OneAnswer() {
    finish();
    close(fd_);
  }
  void finish() {
    if (thread_.joinable()) thread_.join();
  }

  std::string url;
  std::string asked;  ///< What the client sent; after finish().

 private:
  int fd_ = -1;
  std::thread thread_;
};

}  // namespace

TEST_CASE("a URL falls into host, port and path") {
  const auto plain = parse_http_url("http://localhost");
  REQUIRE(plain);
  REQUIRE((plain->host == "localhost" && plain->port == "80" && plain->path == "/"));
  const auto full = parse_http_url("http://10.0.0.2:8080/api/status");
  REQUIRE(full);
  REQUIRE((full->host == "10.0.0.2" && full->port == "8080" && full->path == "/api/status"));
  const auto six = parse_http_url("http://[::1]:99/");
  REQUIRE(six);
  REQUIRE((six->host == "::1" && six->port == "99"));
}

TEST_CASE("what is not an http URL is refused") {
  const auto url = GENERATE("", "localhost:8080", "https://x", "http://", "http://x:", "http://x:0",
                            "http://x:65536", "http://x:8o", "http://[::1", "http://[::1]8",
                            "http://x/\r\nHost: y", "http://x y");
  INFO(url);
  REQUIRE_FALSE(parse_http_url(url));
}

TEST_CASE("who asks over https is told to ask the gateway itself") {
  const auto url = parse_http_url("https://localhost:8080/api/status");
  REQUIRE_FALSE(url);
  REQUIRE(url.error().message.find("only http:// is spoken here") != std::string::npos);
  REQUIRE(url.error().message.find("gateway's own, like http://localhost:8080") !=
          std::string::npos);
  REQUIRE(parse_http_url("foo").error().message == "'foo' is not a URL like http://localhost:8080");
}

TEST_CASE("an answer falls into status and body; the body ends where its length says") {
  const auto answer =
      parse_http_answer("HTTP/1.1 503 No\r\nContent-LENGTH: 4\r\n\r\nbusy and more");
  REQUIRE(answer);
  REQUIRE(answer->status == 503);
  REQUIRE(answer->body == "busy");
  const auto open_end = parse_http_answer("HTTP/1.0 200 OK\r\n\r\nall of it");
  REQUIRE(open_end);
  REQUIRE(open_end->body == "all of it");
}

TEST_CASE("answers that are cut short or are no HTTP are errors, at every cut") {
  const std::string whole = "HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\nok";
  REQUIRE(parse_http_answer(whole));
  for (std::size_t n = 0; n < whole.size(); ++n)
    REQUIRE_FALSE(parse_http_answer(whole.substr(0, n)));
  REQUIRE_FALSE(parse_http_answer("SSH-2.0-OpenSSH\r\n\r\n"));
  REQUIRE_FALSE(parse_http_answer("HTTP/1.1 abc OK\r\n\r\n"));
  REQUIRE_FALSE(parse_http_answer("HTTP/1.1 200 OK\r\nContent-Length: many\r\n\r\nok"));
}

TEST_CASE("a page is fetched from a listening server") {
  OneAnswer server("HTTP/1.1 200 OK\r\nContent-Length: 3\r\n\r\nyes");
  const auto answer = http_get(server.url, 5000);
  server.finish();
  REQUIRE(answer);
  REQUIRE(answer->body == "yes");
  REQUIRE(server.asked.rfind("GET /page HTTP/1.0\r\nHost: 127.0.0.1:", 0) == 0);
}

TEST_CASE("a server that never ends its answer costs no more than the limit") {
  OneAnswer server("HTTP/1.1 200 OK\r\n\r\nand so on", false);
  const auto answer = http_get(server.url, 50);
  REQUIRE_FALSE(answer);
  REQUIRE(answer.error().message.find("does not answer") != std::string::npos);
}

TEST_CASE("an answer past 1 MiB is refused instead of kept") {
  OneAnswer server("HTTP/1.1 200 OK\r\n\r\n" + std::string(2u << 20, 'x'));
  REQUIRE_FALSE(http_get(server.url, 5000));
}
