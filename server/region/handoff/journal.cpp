// Acknowledged messages: numbering, sending again, and taking each one once.
#include "server/region/handoff/journal.h"

#include <algorithm>
#include <utility>

namespace aureole {

std::uint64_t Journal::append(FrameType type, Bytes payload) {
  entries_.push_back({type, std::move(payload), next_sequence_});
  return next_sequence_++;
}

std::vector<SharedBytes> Journal::take_unsent() {
  std::vector<SharedBytes> frames;
  for (const Entry& entry : entries_) {
    if (entry.sequence <= sent_) continue;
    frames.push_back(
        std::make_shared<const Bytes>(encode_frame(entry.type, entry.sequence, entry.payload)));
    sent_ = entry.sequence;
  }
  highest_sent_ = std::max(highest_sent_, sent_);
  return frames;
}

Status Journal::acknowledge(std::uint64_t sequence) {
  if (sequence > highest_sent_)
    return Error::format("acknowledgement of message {}, but only {} were sent", sequence,
                         highest_sent_);
  while (!entries_.empty() && entries_.front().sequence <= sequence) entries_.pop_front();
  return Ok{};
}

void Journal::link_up(Incarnation peer) {
  if (peer != peer_) {
    // The other side has started anew: it has taken nothing of ours, and its own numbers restart.
    peer_ = peer;
    next_sequence_ = 1;
    for (Entry& entry : entries_) entry.sequence = next_sequence_++;
    highest_sent_ = 0;
    taken_ = 0;
    acknowledgement_due_ = false;
  }
  sent_ = 0;
}

Result<Journal::Arrival> Journal::arrive(std::uint64_t sequence) {
  if (sequence > taken_ + 1)
    return Error::format("message {} arrived while {} is still missing", sequence, taken_ + 1);
  acknowledgement_due_ = true;
  if (sequence <= taken_) return Arrival::repeated;
  taken_ = sequence;
  return Arrival::fresh;
}

bool Journal::take_acknowledgement_due() {
  return std::exchange(acknowledgement_due_, false);
}

}  // namespace aureole
