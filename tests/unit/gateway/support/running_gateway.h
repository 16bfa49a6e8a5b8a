// A whole gateway, with its renderer, on a thread of its own; and players without browsers.
#pragma once

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <chrono>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "server/gateway/gateway.h"
#include "server/gateway/web/view_client.h"
#include "tests/support/catch.h"
#include "tests/support/http_exchange.h"
#include "tests/unit/gateway/support/fake_region.h"
#include "tests/unit/gateway/support/small_world.h"

namespace aureole::test {

using Json = nlohmann::json;

inline const WorldDefinition& world() {
  static const WorldDefinition small = small_world();
  return small;
}

/// A gateway on a thread of its own.
class RunningGateway {
 public:
  explicit RunningGateway(std::vector<PeerAddress> regions, int max_players = 8,
                          const WorldDefinition& of = world(),
                          Incarnation incarnation = Incarnation{1})
      : gateway_(std::make_unique<Gateway>(io_, of,
                                           options(std::move(regions), max_players, incarnation))) {
    const auto port = gateway_->start();
    if (!port) FAIL(port.error().message);
    at = {"127.0.0.1", *port};
    thread_ = std::thread([this] { io_.run(); });
  }
  ~RunningGateway() {
    boost::asio::post(io_, [this] { gateway_->stop(); });
    work_.reset();
    thread_.join();  // run() returns by itself: nothing of the gateway goes on after stop()
  }

  Json status() const { return Json::parse(get("/api/status").body); }
  HttpAnswer get(const std::string& path) const {
    auto answer = http_get_from(at, path);
    REQUIRE(answer);
    return *answer;
  }
  /// What it has told its owner last; empty: nothing.
  std::string rejection() const {
    const std::lock_guard lock(mutex_);
    return rejection_;
  }
  /// Asks until the answer is as wanted; the clock only ends a test that would hang.
  void wait_until_healthy() const {
    wait_for([&] { return get("/healthz").status == 200; });
  }
  template <class Condition>
  static void wait_for(Condition condition) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > give_up) FAIL("waited for too long");
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  Endpoint at;

 private:
  GatewayOptions options(std::vector<PeerAddress> regions, int max_players,
                         Incarnation incarnation) {
    GatewayOptions o;
    o.number = 5;
    o.incarnation = incarnation;
    o.rejected = [this](const std::string& why) {
      const std::lock_guard lock(mutex_);
      rejection_ = why;
    };
    o.listen = {"127.0.0.1", 0};
    o.regions = std::move(regions);
    o.render_threads = 1;
    o.max_players = max_players;
    return o;
  }
  mutable std::mutex mutex_;
  std::string rejection_;
  boost::asio::io_context io_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_ =
      boost::asio::make_work_guard(io_);
  std::unique_ptr<Gateway> gateway_;
  std::thread thread_;
};

/// Both regions and a gateway that has heard all of them.
struct Stage2 {
  FakeRegion west{world(), {.id = RegionId{0}, .bodies = 40, .moving = 2}};
  FakeRegion east{world(), {.id = RegionId{1}, .bodies = 30, .moving = 0}};
  RunningGateway gateway{{west.address(), east.address()}};
  Stage2() { gateway.wait_until_healthy(); }

  ViewClientOptions client(const std::string& token = {}) const {
    ViewClientOptions o;
    o.gateway = gateway.at;
    o.token = token;
    return o;
  }
};

inline Json welcome_of(ViewClient& client) {
  const auto text = client.wait_for_text("\"welcome\"");
  REQUIRE(text);
  return Json::parse(*text);
}

inline PlayerId player_in(const Json& welcome) {
  return PlayerId{welcome["player"].get<std::uint32_t>()};
}

inline bool applied_kind(const FakeRegion& region, wire::CommandKind kind) {
  for (const auto& command : region.applied())
    if (command.kind() == kind) return true;
  return false;
}

}  // namespace aureole::test
