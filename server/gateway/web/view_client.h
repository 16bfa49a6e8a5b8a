// A player without a screen: joins a gateway, takes its pictures, says what a test or a benchmark
// tells it to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/net/endpoint.h"

namespace aureole {

/// One picture as it came, header taken apart (protocol/WIRE_FORMAT.md).
struct ReceivedPicture {
  std::uint32_t number = 0;
  std::uint64_t world_us = 0;
  std::uint32_t input_seq = 0;
  int width = 0, height = 0;
  std::uint32_t made_in_us = 0;
  std::int64_t arrived_us = 0;  ///< Local monotonic time.
  std::vector<std::uint8_t> jpeg;
};

struct ViewClientOptions {
  Endpoint gateway;
  std::string token;
  std::string name = "Test";
  int width = 320, height = 180;
  std::string origin;        ///< Left out if empty.
  bool acknowledges = true;  ///< Every picture, at once.
  bool joins = true;         ///< Says `join` by itself.
};

/// Works on a thread of its own; all functions may be called from any one other thread. Waiting
/// functions give up after `patience_s` so that a test fails instead of hanging.
class ViewClient {
 public:
  explicit ViewClient(ViewClientOptions options);
  ~ViewClient();

  /// Connects, shakes hands, joins.
  Status connect();
  /// Sends any text as a message.
  void send(std::string text);
  void send_binary(std::string bytes);
  void send_input(std::uint32_t seq, unsigned keys, double yaw, double pitch);
  /// Says nothing more and reads nothing more, with the connection left open.
  void stall();
  /// Closes the socket without a word.
  void drop();

  /// The first text since the last call (or the start) that contains `part`; those before are taken
  /// too.
  std::optional<std::string> wait_for_text(const std::string& part, double patience_s = 20);
  /// Waits until `count` pictures have come in all; false if it takes too long.
  bool wait_for_pictures(std::size_t count, double patience_s = 20);
  /// Waits for the connection to be closed by the other side.
  bool wait_for_end(double patience_s = 20);

  std::size_t pictures() const;
  std::uint64_t picture_bytes() const;
  std::optional<ReceivedPicture> newest_picture() const;
  /// Arrival times (µs) of all pictures, and the pictures' sizes; for benchmarks.
  std::vector<std::int64_t> arrivals_us() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aureole
