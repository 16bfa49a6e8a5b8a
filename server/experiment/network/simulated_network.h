// A network in virtual time that keeps TCP's contract and nothing more: ordered, reliable until
// reset.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "protocol/frame.h"
#include "server/base/ids.h"
#include "server/experiment/network/packet_loss.h"
#include "server/experiment/random.h"

namespace aureole {

/// Virtual time since the start of the run (unit: µs).
using Micros = std::int64_t;
inline constexpr Micros never = std::numeric_limits<Micros>::max();

/// A process at one end of links: regions 0 … n - 1, and n for the gateway.
using End = int;

struct NetworkTiming {
  Micros latency_us = 2000;  ///< Longest time that an undisturbed message takes, one way.
  Micros jitter_us = 0;      ///< It takes this much less at most, uniformly.
  double loss_share = 0;     ///< Of TCP segments, 0 … 1; see PacketLoss.
};

/// What reaches an end: a link that comes or goes, a frame, or the answer to a ping.
struct Delivery {
  enum class Kind { up, down, frame, measured };
  Kind kind{};
  End from = 0;
  Micros arrived_us = 0;
  SharedBytes frame;        ///< frame
  Incarnation incarnation;  ///< up: the other side's
  double latency_ms = 0;    ///< measured: half of the round trip
};

/// One channel for each ordered pair of ends. A link (both channels of a pair) is up or down; while
/// it is down, or for a sender that has not noticed yet that it was reset, frames are lost. Ends
/// learn of resets and of new links through their deliveries, in order with the frames. Pings and
/// what comes and goes of links is never lost itself, but waits behind what is.
class SimulatedNetwork {
 public:
  SimulatedNetwork(int ends, NetworkTiming timing, std::uint64_t seed);

  /// Starts a process; links to all others that run come up within milliseconds, at once at time 0.
  void start(End end, Incarnation incarnation, Micros now);
  /// Ends a process: what is under way to and from it is lost, and the others notice soon.
  void kill(End end, Micros now);

  /// The frame is lost unless the link that the sender knows is still the present one.
  void send(End from, End to, SharedBytes frame, Micros now);
  /// Everything that has reached the end by now, in the order of arrival.
  std::vector<Delivery> take(End to, Micros now);
  /// Dials, pings; call whenever time has gone on, before take().
  void advance(Micros now);

  /// Nothing reaches `to` from `from` until then; it all comes afterwards.
  void stall(End from, End to, Micros until);
  /// All that is in flight between the two is lost in both directions; linked again later.
  void reset(End a, End b, Micros now, Micros back_after_us);

  bool runs(End end) const { return running_[index(end)].has_value(); }
  /// True while the link is down or held, and just after it was late: the truth about the latency
  /// tolerance `limit_us` that oracles excuse things by.
  bool is_disturbed(End a, End b, Micros now, Micros limit_us) const;
  std::uint64_t frames_lost() const { return frames_lost_; }
  /// Frames of which a segment had to be sent again.
  std::uint64_t frames_sent_again() const { return frames_sent_again_; }

  /// Told of every frame that is given to a link.
  using Watcher = std::function<void(End from, End to, const SharedBytes& frame)>;
  void watch(Watcher watcher) { watcher_ = std::move(watcher); }

  /// Frames that were given to a link since the start.
  struct Traffic {
    std::uint64_t messages = 0, bytes = 0;
  };
  const Traffic& traffic(End from, End to) const { return channel(from, to).traffic; }

 private:
  struct Item {
    Delivery what;
    Micros ready_us = 0;
    Micros sent_us = 0;
    std::uint64_t generation = 0;
    Micros alone_us = 0;     ///< When it would be ready if it did not have to wait for others.
    bool unnoticed = false;  ///< It was lost, and nothing that came later has told the sender.
    Micros again_us = 0;     ///< See PacketLoss::Fate.
  };
  struct Ping {
    bool under_way = false, returning = false;
    Micros sent_us = 0, ready_us = 0;
    Micros left_us = 0;    ///< On its present way.
    Micros behind_us = 0;  ///< When that which it waits behind is ready.
  };
  struct Channel {
    std::deque<Item> items;
    Micros last_ready_us = 0;
    Micros taken_ready_us = 0;  ///< Of the item that was taken last.
    std::size_t unnoticed = 0;  ///< Items.
    Micros held_until_us = 0;
    std::uint64_t known_generation = 0;  ///< Of the link, as its sending end knows it; 0: none.
    Micros late_at_us = -1;              ///< When something last arrived later than undisturbed,
    Micros late_by_us = 0;               ///< so long after it was sent: the longest of late.
    Ping ping;
    Traffic traffic;
  };
  struct Link {
    std::uint64_t generation = 1;
    bool up = false;
    Micros dial_at_us = never;
  };

  std::size_t index(End end) const { return static_cast<std::size_t>(end); }
  Channel& channel(End from, End to) { return channels_[index(from) * ends_ + index(to)]; }
  const Channel& channel(End from, End to) const {
    return channels_[index(from) * ends_ + index(to)];
  }
  Link& link(End a, End b);
  const Link& link(End a, End b) const;
  Micros transit_us();
  void push(End from, End to, Item item);
  void lose(Channel& channel, Item& item, Micros now);
  bool waits_behind_loss(const Channel& channel, Ping& ping, Micros now) const;
  void break_link(End a, End b, Micros now, std::optional<End> dead);
  void dial(End a, End b, Micros now, bool at_once);
  void advance_ping(End from, End to, Micros now);

  std::size_t ends_;
  NetworkTiming timing_;
  Random random_;
  PacketLoss loss_;
  Watcher watcher_;
  std::vector<std::optional<Incarnation>> running_;
  std::vector<Channel> channels_;
  std::vector<Link> links_;
  Micros next_ping_us_ = 0;
  std::uint64_t frames_lost_ = 0, frames_sent_again_ = 0;
};

}  // namespace aureole
