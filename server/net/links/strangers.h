// Links whose other side has yet to say who it is.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "server/net/links/link.h"
#include "server/net/rare_warning.h"

namespace aureole {

/// Each has a few seconds. A server says who it is within a round trip, and strangers that say
/// nothing keep none of them out: who comes takes the place of whoever has been here for longest.
class Strangers {
 public:
  /// So many of those that came to us wait at a time.
  static constexpr std::size_t accepted_max = 256;
  static constexpr std::chrono::seconds time_to_speak{3};

  explicit Strangers(boost::asio::io_context& io) : io_(io) {}

  /// `dialled` from here, which does not count: those are as many as there are peers. May close
  /// another one.
  void add(const std::shared_ptr<Link>& link, bool dialled);
  /// It has said who it is, or something else: it is not closed for its silence any more.
  void note_spoken(const Link* link);
  /// It is no stranger any more, or gone. Nothing if it is none.
  void remove(const Link* link);
  void close_all(const std::string& reason);

 private:
  struct Stranger {
    std::shared_ptr<Link> link;
    bool dialled;
    boost::asio::steady_timer deadline;
    bool spoken = false;
  };
  void make_room();

  boost::asio::io_context& io_;
  std::vector<std::shared_ptr<Stranger>> strangers_;  ///< In the order in which they came.
  RareWarning crowded_;
};

}  // namespace aureole
