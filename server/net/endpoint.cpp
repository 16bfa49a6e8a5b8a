// Reads host:port, with IPv6 hosts in brackets.
#include "server/net/endpoint.h"

#include <charconv>

namespace aureole {

Result<Endpoint> parse_endpoint(const std::string& text) {
  const auto colon = text.rfind(':');
  std::string host = colon == std::string::npos ? "" : text.substr(0, colon);
  if (host.size() >= 2 && host.front() == '[' && host.back() == ']')
    host = host.substr(1, host.size() - 2);
  else if (host.find(':') != std::string::npos)
    host.clear();
  unsigned port = 65'536;
  if (colon != std::string::npos) {
    const char* end = text.data() + text.size();
    const auto [stop, ec] = std::from_chars(text.data() + colon + 1, end, port);
    if (ec != std::errc{} || stop != end) port = 65'536;
  }
  if (host.empty() || port > 65'535)
    return Error::format("\"{}\" is no address; expected host:port, for example 127.0.0.1:7000",
                         text);
  return Endpoint{host, static_cast<std::uint16_t>(port)};
}

}  // namespace aureole
