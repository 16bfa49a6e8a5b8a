// HTTP: the page's files and nothing else, odd requests, and who may open a WebSocket.
#include "server/gateway/web/http_server.h"

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <filesystem>
#include <fstream>
#include <thread>

#include "server/gateway/web/api.h"
#include "server/gateway/web/static_files.h"
#include "tests/support/catch.h"
#include "tests/support/http_exchange.h"

using namespace aureole;
using namespace aureole::test;
namespace fs = std::filesystem;

namespace {

void write_file(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

/// A folder with a page in it and a secret beside it; gone afterwards.
struct WebFolder {
  fs::path base;
  WebFolder() {
    std::string name = (fs::temp_directory_path() / "aureole-web-XXXXXX").string();
    base = ::mkdtemp(name.data());
    write_file(base / "secret.txt", "secret");
    write_file(root() / "index.html", "<p>page</p>");
    write_file(root() / "app.js", "let a;");
    write_file(root() / "operator.html", "operator");
    write_file(root() / ".hidden", "hidden");
    write_file(root() / "sub/index.html", "sub");
    fs::create_symlink(base / "secret.txt", root() / "link.txt");
  }
  ~WebFolder() { fs::remove_all(base); }
  fs::path root() const { return base / "web"; }
};

/// A server that answers every request with its path, on a thread of its own.
struct EchoServer {
  boost::asio::io_context io;
  Endpoint at{"127.0.0.1", 0};  // Before the server, which listens there.
  HttpServer server;
  std::thread thread;

  EchoServer()
      : server(io, {.listen = at},
               {.request =
                    [](const HttpRequest& r, HttpServer::Respond respond) {
                      respond({200, "text/plain",
                               r.path + "|" + r.query + "|" + (r.from_loopback ? "near" : "far"),
                               "\"tag\""});
                    },
                .websocket = {}}) {
    const auto port = server.start();
    REQUIRE(port);
    at.port = *port;
    thread = std::thread([this] { io.run(); });
  }
  ~EchoServer() {
    boost::asio::post(io, [this] { server.stop(); });
    io.stop();
    thread.join();
  }
  HttpAnswer ask(const std::string& request) {
    auto answer = http_exchange(at, request);
    REQUIRE(answer);
    return *answer;
  }
};

}  // namespace

TEST_CASE("The page's files are served with their type, folders and bare names included") {
  const WebFolder folder;
  const StaticFiles files(folder.root());
  REQUIRE(files.load("/")->body == "<p>page</p>");
  REQUIRE(files.load("/")->content_type == "text/html; charset=utf-8");
  REQUIRE(files.load("/app.js")->content_type == "text/javascript; charset=utf-8");
  REQUIRE(files.load("/%61pp.js")->body == "let a;");
  REQUIRE(files.load("/operator")->body == "operator");
  REQUIRE(files.load("/sub/")->body == "sub");
  REQUIRE(files.load("/app.js")->etag == files.load("/app.js")->etag);
  REQUIRE(files.load("/app.js")->etag != files.load("/")->etag);
}

TEST_CASE("No path leads out of the page's folder or to what is hidden in it") {
  const WebFolder folder;
  const StaticFiles files(folder.root());
  for (const std::string path :
       {"/../secret.txt", "/%2e%2e/secret.txt", "/sub/../../secret.txt", "/..%2fsecret.txt",
        "/..\\secret.txt", "//secret.txt", "/./app.js", "/.hidden", "/link.txt", "/sub", "/nothing",
        "/app.js%00.html", "/%", "/%zz", "app.js", "", "/app.js/", "/sub//index.html"}) {
    INFO(path);
    REQUIRE_FALSE(files.load(path));
  }
  REQUIRE_FALSE(StaticFiles("/no/such/folder").load("/"));
  REQUIRE_FALSE(StaticFiles("").load("/etc/passwd"));
}

TEST_CASE("Pages of the same host may open a WebSocket, and programs without a page") {
  REQUIRE(is_same_host("", "localhost:8080"));
  REQUIRE(is_same_host("http://localhost:8080", "localhost:8080"));
  REQUIRE(is_same_host("https://Play.Example", "play.example:443"));
  REQUIRE(is_same_host("http://[::1]:8080", "[::1]:9000"));
  REQUIRE_FALSE(is_same_host("http://evil.example", "localhost:8080"));
  REQUIRE_FALSE(is_same_host("http://localhost.evil.example", "localhost:8080"));
  REQUIRE_FALSE(is_same_host("null", "localhost:8080"));
  REQUIRE_FALSE(is_same_host("http://", ""));
}

TEST_CASE("A request is taken apart, and HEAD is answered without its body") {
  EchoServer server;
  const auto get =
      server.ask("GET /a/b?c=d HTTP/1.1\r\nHost: localhost:80\r\nConnection: close\r\n\r\n");
  REQUIRE(get.status == 200);
  REQUIRE(get.body == "/a/b|c=d|near");
  REQUIRE(get.head.find("ETag: \"tag\"") != std::string::npos);
  REQUIRE(get.head.find("nosniff") != std::string::npos);
  const auto head =
      server.ask("HEAD /a/b?c=d HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  REQUIRE(head.status == 200);
  REQUIRE(head.body.empty());
  REQUIRE(head.head.find("Content-Length: 13") != std::string::npos);
  const auto proxied = server.ask(
      "GET / HTTP/1.1\r\nHost: localhost\r\nX-Forwarded-For: 1.2.3.4\r\nConnection: close\r\n\r\n");
  REQUIRE(proxied.body == "/||far");
}

TEST_CASE("Only who asks this machine by a name of its own counts as near") {
  EchoServer server;
  const auto asked_as = [&](const std::string& host) {
    return server.ask("GET / HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n").body;
  };
  for (const char* host : {"localhost", "localhost:8080", "127.0.0.1:8080", "[::1]:8080"})
    REQUIRE(asked_as(host) == "/||near");
  for (const char* host : {"rebound.example:8080", "[", "", "192.0.2.1", "localhost.example"})
    REQUIRE(asked_as(host) == "/||far");
}

TEST_CASE("Odd requests are told what is wrong with them, and the next one is served") {
  EchoServer server;
  REQUIRE(server.ask("DELETE / HTTP/1.1\r\nHost: x\r\n\r\n").status == 405);
  REQUIRE(server.ask("GET / HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\n\r\n12345").status == 413);
  const auto hosts = server.ask("GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil\r\n\r\n");
  REQUIRE(hosts.status == 400);
  REQUIRE(hosts.body.find("one Host; this one has several") != std::string::npos);
  REQUIRE(server.ask("nonsense\r\n\r\n").status == 400);
  REQUIRE(server.ask("GET / HTTP/1.1\r\nX: " + std::string(9000, 'a') + "\r\n\r\n").status == 431);
  REQUIRE(server
              .ask("GET /ws HTTP/1.1\r\nHost: x\r\nOrigin: http://evil\r\nUpgrade: websocket\r\n"
                   "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                   "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n")
              .status == 403);
  REQUIRE(http_get_from(server.at, "/still-here")->status == 200);
}

TEST_CASE("A port that is taken is said to be") {
  EchoServer first;
  boost::asio::io_context io;
  HttpServer second(io, {.listen = first.at}, {});
  const auto port = second.start();
  REQUIRE_FALSE(port);
  REQUIRE(port.error().message.find("is taken") != std::string::npos);
}

TEST_CASE("The query for a picture is read in full or refused") {
  const auto query = parse_frame_query(
      "x=1.5&y=-2&z=3e1&yaw=0.5&pitch=-0.1&w=640&h=360&tint=1&boundaries=1&format=ppm&quality=50");
  REQUIRE(query);
  REQUIRE(query->view.camera.eye == Eigen::Vector3f(1.5f, -2, 30));
  REQUIRE(query->view.camera.yaw_rad == 0.5f);
  REQUIRE(query->view.width == 640);
  REQUIRE(query->tinted);
  REQUIRE(query->view.show_boundaries);
  REQUIRE(query->format == PictureFormat::ppm);
  REQUIRE(query->quality == 50);
  for (const std::string bad :
       {"", "x=1&y=2", "x=1&y=2&z=nan", "x=1&y=2&z=inf", "x=1&y=2&z=0x10", "x=1&y=2&z=9000",
        "x=1&y=2&z=3&w=15", "x=1&y=2&z=3&w=100000", "x=1&y=2&z=3&w=20.5", "x=1&y=2&z=3&tint=2",
        "x=1&y=2&z=3&format=gif", "x=1&y=2&z=3&what=1", "x=1&y=2&z=%",
        "x=1&y=2&z=", "x=1&y=2&z=1 "}) {
    INFO(bad);
    REQUIRE_FALSE(parse_frame_query(bad));
  }
}
