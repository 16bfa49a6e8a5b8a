// Plain HTTP requests of one's own wording, answers in full.
#pragma once

#include <string>

#include "server/base/result.h"
#include "server/net/endpoint.h"

namespace aureole::test {

struct HttpAnswer {
  unsigned status = 0;
  std::string head;  ///< Status line and fields.
  std::string body;
};
/// One request of one's own wording, for tests of odd ones; reads until the server closes or the
/// body is whole.
Result<HttpAnswer> http_exchange(const Endpoint& at, const std::string& request);
/// GET `path`.
Result<HttpAnswer> http_get_from(const Endpoint& at, const std::string& path);

}  // namespace aureole::test
