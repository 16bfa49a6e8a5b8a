// Messages that must arrive: kept by the sender until acknowledged, taken once by the receiver.
//
// TCP keeps order and loses what was in flight when a link is reset; what is in doubt then is sent
// again from here, and the sequence tells the receiver what it has already taken. One journal
// serves one pair of servers in both directions.
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
  struct Entry {
    FrameType type{};
    Bytes payload;  ///< Without header; the sequence is written when it is sent.
    std::uint64_t sequence = 0;
  };

  // ---- Sending side ----------------------------------------------------------------------------

  /// Keeps the message until it is acknowledged. Returns its sequence.
  std::uint64_t append(FrameType type, Bytes payload);

  /// Frames that have not been sent over the present link yet, in order; marks them as sent.
  std::vector<SharedBytes> take_unsent();

  /// The receiver has taken everything up to and with `sequence`. An Error if it was never sent.
  Status acknowledge(std::uint64_t sequence);

  /// A link to the peer begins. Everything unacknowledged is sent again; towards a new incarnation,
  /// which knows of nothing, it is numbered anew from 1.
  void link_up(Incarnation peer);

  /// Entries without acknowledgement, oldest first: the bodies in them are passive copies.
  const std::deque<Entry>& unacknowledged() const { return entries_; }

  // ---- Receiving side --------------------------------------------------------------------------

  enum class Arrival { fresh, repeated };
  /// Judges an arriving sequence (> 0). Fresh ones count as taken from now on. An Error if earlier
  /// ones are missing: no honest peer over an ordered link leaves a gap.
  Result<Arrival> arrive(std::uint64_t sequence);

  /// Everything up to here has been taken; 0: nothing yet.
  std::uint64_t taken() const { return taken_; }
  /// True once after arrivals (repeated ones too): an acknowledgement is due.
  bool take_acknowledgement_due();

 private:
  std::deque<Entry> entries_;
  std::uint64_t next_sequence_ = 1;
  std::uint64_t sent_ = 0;          ///< Highest sequence sent over the present link.
  std::uint64_t highest_sent_ = 0;  ///< Over any link to this incarnation.
  std::uint64_t taken_ = 0;
  bool acknowledgement_due_ = false;
  Incarnation peer_;
};

}  // namespace aureole
