// Where a server listens, as an operator writes it.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/ids.h"
#include "server/base/result.h"

namespace aureole {

/// host:port as an operator writes it; IPv6 hosts in brackets.
struct Endpoint {
  std::string host;
  std::uint16_t port = 0;
};
Result<Endpoint> parse_endpoint(const std::string& text);

/// Which server listens there.
struct PeerAddress {
  PeerId peer;
  Endpoint at;
};

}  // namespace aureole
