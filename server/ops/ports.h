// Which TCP ports of this machine are free.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace aureole {

/// Whether a server could listen there now. `address`: numeric, IPv4 or IPv6; port 1 … 65535.
/// Errors: a sentence with the reason (taken, not permitted, no such address).
Status check_port_is_free(const std::string& address, std::uint16_t port);

/// `count` different ports that were free on 127.0.0.1 a moment ago. They lie below the range from
/// which Linux takes the ports of outgoing connections, so that no link can steal one before its
/// server has started; `seed` chooses where the search begins, so that two searchers seldom meet.
/// Errors: not that many are free.
Result<std::vector<std::uint16_t>> free_loopback_ports(int count, std::uint32_t seed);

}  // namespace aureole
