// Fetches one small page of a server of ours; blocking, with a time limit.
#pragma once

#include <string>

#include "server/base/result.h"

namespace aureole {

struct HttpUrl {
  std::string host;
  std::string port;
  std::string path;  ///< Begins with '/'.
};

/// http://host[:port][/path]; IPv6 hosts in brackets. Errors: anything else, https:// too.
Result<HttpUrl> parse_http_url(const std::string& url);

struct HttpAnswer {
  int status = 0;
  std::string body;
};

/// What a server sent until it closed the connection, taken apart. Errors: no HTTP, or cut short.
Result<HttpAnswer> parse_http_answer(const std::string& bytes);

/// GET over HTTP/1.0 semantics (the server closes at the end), at most 1 MiB and `limit_ms`
/// milliseconds in all (name look-up aside). Errors: a sentence naming the URL.
Result<HttpAnswer> http_get(const std::string& url, int limit_ms);

}  // namespace aureole
