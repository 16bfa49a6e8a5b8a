// A browser's connection as the players' hub sees it, whatever carries it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "server/gateway/pictures/render_pool.h"
#include "server/gateway/web/browser_messages.h"

namespace aureole {

struct OutgoingPicture {
  std::uint32_t number = 0;
  std::array<std::byte, picture_header_bytes> header{};
  SharedPictureBytes data;
};

struct ConnectionEvents {
  std::function<void(std::string_view)> text;
  /// The picture is being written now.
  std::function<void(std::uint32_t number)> picture_started;
  /// Exactly once; nothing comes afterwards.
  std::function<void(const std::string& reason)> closed;
};

/// Nothing here blocks or grows without bound: texts beyond `max_queued_texts` end the connection,
/// a newer status or picture takes the place of one that has not begun to be written.
class Connection {
 public:
  static constexpr std::size_t max_queued_texts = 64;

  Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  virtual ~Connection() = default;

  /// Called once, before anything else.
  virtual void start(ConnectionEvents events) = 0;
  virtual void send_text(std::string text) = 0;
  virtual void send_status(std::string text) = 0;
  virtual void send_picture(OutgoingPicture picture) = 0;
  /// True while a picture waits behind others that are being written: another one would be too
  /// early.
  virtual bool picture_waiting() const = 0;
  /// Says the sentence to the browser as an `error` (unless it is empty), then closes. No event but
  /// `closed` follows.
  virtual void close(const std::string& sentence) = 0;
  /// "127.0.0.1:4711", for logs.
  virtual const std::string& remote() const = 0;
};

}  // namespace aureole
