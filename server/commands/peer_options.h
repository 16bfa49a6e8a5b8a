// Reads the r1=host:port options that tell a server where the regions are.
#pragma once

#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/net/endpoint.h"

namespace aureole {

/// Every region of 0 … count-1 but `self` (-1: none is left out) must be named exactly once.
Result<std::vector<PeerAddress>> parse_regions(const std::vector<std::string>& texts,
                                               const std::string& option, int count, int self);

}  // namespace aureole
