// Addresses as operators write them.
#include "server/net/endpoint.h"
#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("host:port is read, with IPv6 hosts in brackets") {
  REQUIRE(parse_endpoint("127.0.0.1:7000")->port == 7000);
  REQUIRE(parse_endpoint("region-3:65535")->host == "region-3");
  REQUIRE(parse_endpoint("[::1]:7")->host == "::1");
  REQUIRE(parse_endpoint("[::1]:7")->port == 7);
}

TEST_CASE("anything else is refused with an example") {
  for (const char* text : {"", "7000", ":7000", "host:", "host:x", "host:70000", "host:-1",
                           "host: 7", "::1:7000", "host:7 "}) {
    INFO(text);
    const auto endpoint = parse_endpoint(text);
    REQUIRE_FALSE(endpoint);
    REQUIRE(endpoint.error().message.find("for example") != std::string::npos);
  }
}
