// A GET over plain sockets, for health checks and the status command; see http_get.h.
#include "server/ops/http_get.h"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <memory>

namespace aureole {
namespace {

constexpr std::size_t max_answer_bytes = 1u << 20;

class Deadline {
 public:
  explicit Deadline(int limit_ms)
      : end_(std::chrono::steady_clock::now() + std::chrono::milliseconds(limit_ms)) {}
  int left_ms() const {
    using std::chrono::milliseconds;
    const auto left = std::chrono::ceil<milliseconds>(end_ - std::chrono::steady_clock::now());
    return static_cast<int>(std::max<std::int64_t>(0, left.count()));
  }

 private:
  std::chrono::steady_clock::time_point end_;
};

struct Socket {
  int fd;
  explicit Socket(int descriptor) : fd(descriptor) {}
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() {
    if (fd >= 0) close(fd);
  }
};

/// Waits until the socket is ready for `events`; an errno value, 0 when ready.
int wait_for(int fd, short events, const Deadline& deadline) {
  pollfd waiting{fd, events, 0};
  while (true) {
    const int ready = poll(&waiting, 1, deadline.left_ms());
    if (ready > 0) return 0;
    if (ready == 0) return ETIMEDOUT;
    if (errno != EINTR) return errno;
  }
}

int connect_to(int fd, const addrinfo& to, const Deadline& deadline) {
  if (connect(fd, to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  if (const int error = wait_for(fd, POLLOUT, deadline)) return error;
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

int send_all(int fd, std::string_view bytes, const Deadline& deadline) {
  while (!bytes.empty()) {
    const ssize_t n = send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(n));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (const int error = wait_for(fd, POLLOUT, deadline)) return error;
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

int receive_all(int fd, std::string& bytes, const Deadline& deadline) {
  std::array<char, 16'384> part;
  while (true) {
    if (const int error = wait_for(fd, POLLIN, deadline)) return error;
    const ssize_t n = recv(fd, part.data(), part.size(), 0);
    if (n == 0) return 0;
    if (n < 0) {
      if (errno == EINTR || errno == EAGAIN) continue;
      return errno;
    }
    bytes.append(part.data(), static_cast<std::size_t>(n));
    if (bytes.size() > max_answer_bytes) return EMSGSIZE;
  }
}

}  // namespace

Result<HttpUrl> parse_http_url(const std::string& url) {
  constexpr std::string_view scheme = "http://";
  const auto wrong = [&] {
    return Error::format("'{}' is not a URL like http://localhost:8080", url);
  };
  if (url.starts_with("https://"))
    return Error::format(
        "'{}' is an https URL, but only http:// is spoken here; expected the gateway's own, like "
        "http://localhost:8080, not that of what stands in front of it",
        url);
  if (!url.starts_with(scheme)) return wrong();
  // Spaces and line ends would let a URL write headers of its own.
  if (std::any_of(url.begin(), url.end(), [](unsigned char c) { return c <= ' ' || c >= 127; })) {
    return wrong();
  }
  std::string_view rest = std::string_view(url).substr(scheme.size());
  const auto slash = rest.find('/');
  HttpUrl out;
  out.path = slash == std::string_view::npos ? "/" : std::string(rest.substr(slash));
  rest = rest.substr(0, slash);

  std::string_view port = "80";
  if (rest.starts_with('[')) {
    const auto end = rest.find(']');
    if (end == std::string_view::npos) return wrong();
    out.host = rest.substr(1, end - 1);
    rest = rest.substr(end + 1);
    if (!rest.empty() && rest[0] != ':') return wrong();
    if (!rest.empty()) port = rest.substr(1);
  } else {
    const auto colon = rest.find(':');
    out.host = rest.substr(0, colon);
    if (colon != std::string_view::npos) port = rest.substr(colon + 1);
  }
  unsigned number = 0;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (out.host.empty() || error != std::errc{} || end != port.data() + port.size() || number == 0 ||
      number > 65'535) {
    return wrong();
  }
  out.port = port;
  return out;
}

Result<HttpAnswer> parse_http_answer(const std::string& bytes) {
  const auto head_end = bytes.find("\r\n\r\n");
  if (bytes.compare(0, 7, "HTTP/1.") != 0 || head_end == std::string::npos || head_end < 12) {
    return Error{"the answer is not HTTP"};
  }
  HttpAnswer out;
  const auto [end, error] = std::from_chars(&bytes[9], &bytes[12], out.status);
  if (error != std::errc{} || end != &bytes[12] || out.status < 100) {
    return Error{"the answer has no HTTP status"};
  }
  out.body = bytes.substr(head_end + 4);

  std::string head = bytes.substr(0, head_end + 2);
  std::transform(head.begin(), head.end(), head.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::string_view length_name = "\r\ncontent-length:";
  if (const auto at = head.find(length_name); at != std::string::npos) {
    auto digits = head.find_first_not_of(' ', at + length_name.size());
    std::size_t length = 0;
    if (digits == std::string::npos ||
        std::from_chars(&head[digits], head.data() + head.size(), length).ec != std::errc{}) {
      return Error{"the answer's Content-Length is not a number"};
    }
    if (out.body.size() < length) return Error{"the answer was cut short"};
    out.body.resize(length);
  }
  return out;
}

Result<HttpAnswer> http_get(const std::string& url, int limit_ms) {
  const Result<HttpUrl> parsed = parse_http_url(url);
  if (!parsed) return parsed.error();
  const Deadline deadline(limit_ms);

  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  if (const int e = getaddrinfo(parsed->host.c_str(), parsed->port.c_str(), &wanted, &list);
      e != 0) {
    return Error::format("no address for '{}': {}", parsed->host, gai_strerror(e));
  }
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> addresses(list, freeaddrinfo);

  int error = ECONNREFUSED;
  for (const addrinfo* to = list; to != nullptr; to = to->ai_next) {
    const Socket link(socket(to->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (link.fd < 0) continue;
    error = connect_to(link.fd, *to, deadline);
    if (error != 0) continue;
    const std::string request =
        fmt::format("GET {} HTTP/1.0\r\nHost: {}:{}\r\nConnection: close\r\n\r\n", parsed->path,
                    parsed->host, parsed->port);
    std::string answer;
    error = send_all(link.fd, request, deadline);
    if (error == 0) error = receive_all(link.fd, answer, deadline);
    if (error != 0) break;
    Result<HttpAnswer> taken_apart = parse_http_answer(answer);
    if (!taken_apart) return Error::format("{}: {}", url, taken_apart.error().message);
    return taken_apart;
  }
  return Error::format("{} does not answer: {}", url, std::strerror(error));
}

}  // namespace aureole
