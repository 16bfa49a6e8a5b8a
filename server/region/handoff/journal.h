// Messages that must arrive: kept by the sender until they are safe, taken once by the receiver.
//
// TCP keeps order and loses what was in flight when a link is reset; what is in doubt then is sent
// again from here, and the sequence tells the receiver what it has already taken. What has been
// taken is safe only once it is durable: part of a snapshot that survives the receiver's process.
// One journal serves one pair of servers in both directions.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "protocol/frame.h"
#include "server/base/ids.h"
#include "server/base/result.h"

namespace aureole {

class Journal {
 public:
  /// Of what the receiver has taken no more is kept than so many messages and bytes: it writes its
  /// state every 96 ms, so that more means that its disk has failed. The oldest is let go then.
  static constexpr std::size_t taken_max = 16'384;
  static constexpr std::size_t taken_bytes_max = 32u << 20;

  struct Entry {
    FrameType type{};
    Bytes payload;  ///< Without header; the sequence is written when it is sent.
    std::uint64_t sequence = 0;
  };

  // ---- Sending side ----------------------------------------------------------------------------

  /// Keeps the message until it is durable at the receiver. Returns its sequence.
  std::uint64_t append(FrameType type, Bytes payload);

  /// Frames that have not been sent over the present link yet, in order; marks them as sent.
  std::vector<SharedBytes> take_unsent();

  /// The receiver has taken everything up to and with `taken`, and everything up to and with
  /// `durable` survives its death. An Error if it was never sent, or is durable without being
  /// taken.
  Status acknowledge(std::uint64_t taken, std::uint64_t durable);

  /// A link to the peer begins. To the same incarnation what it has not taken is sent again; to a
  /// new one, which knows of nothing, all that is not durable, numbered anew from 1.
  void link_up(Incarnation peer);

  /// Entries that are not durable, oldest first: the bodies in them are passive copies.
  const std::deque<Entry>& unacknowledged() const { return entries_; }
  /// Whether the present incarnation of the receiver has taken it.
  bool is_taken(const Entry& entry) const { return entry.sequence <= peer_taken_; }
  /// Messages that it has not said that it has taken.
  std::size_t untaken() const { return entries_.size() - taken_entries(); }
  /// How many were let go although they are not durable: if the receiver dies, too, what it had of
  /// them is lost.
  std::uint64_t let_go() const { return let_go_; }
  /// Who the other side is at present; 0 before the first link.
  Incarnation peer() const { return peer_; }

  // ---- Receiving side --------------------------------------------------------------------------

  enum class Arrival { fresh, repeated };
  /// Judges an arriving sequence (> 0). Fresh ones count as taken from now on. An Error if earlier
  /// ones are missing: no honest peer over an ordered link leaves a gap.
  Result<Arrival> arrive(std::uint64_t sequence);

  /// Everything up to here has been taken; 0: nothing yet.
  std::uint64_t taken() const { return taken_; }
  /// What has been taken up to and with `sequence` of this incarnation survives our death.
  void note_durable(std::uint64_t sequence);
  std::uint64_t durable() const { return durable_; }
  /// True once after arrivals (repeated ones too) and after more has become durable.
  bool take_acknowledgement_due();

 private:
  /// At the front of all that are kept.
  std::size_t taken_entries() const;
  void drop_oldest();

  std::deque<Entry> entries_;
  std::size_t taken_bytes_ = 0;  ///< Of the payloads of those that are taken.
  std::uint64_t let_go_ = 0;
  std::uint64_t next_sequence_ = 1;
  std::uint64_t sent_ = 0;          ///< Highest sequence sent over the present link.
  std::uint64_t highest_sent_ = 0;  ///< Over any link to this incarnation.
  std::uint64_t peer_taken_ = 0;    ///< Of ours, by this incarnation.
  std::uint64_t taken_ = 0;
  std::uint64_t durable_ = 0;
  bool acknowledgement_due_ = false;
  Incarnation peer_;
};

}  // namespace aureole
