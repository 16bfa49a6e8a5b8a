// Numbering, sending again, taking each message once, and keeping it until it is durable.
#include "server/region/handoff/journal.h"

#include <algorithm>
#include <utility>

#include "server/base/check.h"

namespace aureole {

std::uint64_t Journal::append(FrameType type, Bytes payload) {
  entries_.push_back({type, std::move(payload), next_sequence_});
  return next_sequence_++;
}

std::size_t Journal::taken_entries() const {
  if (entries_.empty() || entries_.front().sequence > peer_taken_) return 0;
  return std::min<std::size_t>(entries_.size(), peer_taken_ - entries_.front().sequence + 1);
}

void Journal::drop_oldest() {
  if (is_taken(entries_.front())) taken_bytes_ -= entries_.front().payload.size();
  entries_.pop_front();
}

std::vector<SharedBytes> Journal::take_unsent() {
  std::vector<SharedBytes> frames;
  const auto unsent = std::partition_point(entries_.begin(), entries_.end(),
                                           [&](const Entry& e) { return e.sequence <= sent_; });
  for (auto it = unsent; it != entries_.end(); ++it) {
    const Entry& entry = *it;
    frames.push_back(
        std::make_shared<const Bytes>(encode_frame(entry.type, entry.sequence, entry.payload)));
    sent_ = entry.sequence;
  }
  highest_sent_ = std::max(highest_sent_, sent_);
  return frames;
}

Status Journal::acknowledge(std::uint64_t taken, std::uint64_t durable) {
  if (taken > highest_sent_)
    return Error::format("acknowledgement of message {}, but only {} were sent", taken,
                         highest_sent_);
  if (durable > taken)
    return Error::format("message {} is said to be durable, but only {} to be taken", durable,
                         taken);
  for (std::size_t n = taken_entries(); n < entries_.size() && entries_[n].sequence <= taken; ++n)
    taken_bytes_ += entries_[n].payload.size();
  peer_taken_ = std::max(peer_taken_, taken);
  while (!entries_.empty() && entries_.front().sequence <= durable) drop_oldest();
  for (std::size_t kept = taken_entries(); kept > taken_max || taken_bytes_ > taken_bytes_max;
       --kept) {
    drop_oldest();
    ++let_go_;
  }
  return Ok{};
}

void Journal::link_up(Incarnation peer) {
  if (peer != peer_) {
    // The other side has started anew: it has taken nothing of ours, and its own numbers restart.
    peer_ = peer;
    next_sequence_ = 1;
    for (Entry& entry : entries_) entry.sequence = next_sequence_++;
    highest_sent_ = 0;
    peer_taken_ = 0;
    taken_bytes_ = 0;
    taken_ = 0;
    durable_ = 0;
    acknowledgement_due_ = false;
  }
  sent_ = peer_taken_;
}

Result<Journal::Arrival> Journal::arrive(std::uint64_t sequence) {
  if (sequence > taken_ + 1)
    return Error::format("message {} arrived while {} is still missing", sequence, taken_ + 1);
  acknowledgement_due_ = true;
  if (sequence <= taken_) return Arrival::repeated;
  taken_ = sequence;
  return Arrival::fresh;
}

void Journal::note_durable(std::uint64_t sequence) {
  AUREOLE_CHECK(sequence <= taken_, "only what was taken can be durable");
  if (sequence <= durable_) return;
  durable_ = sequence;
  acknowledgement_due_ = true;
}

bool Journal::take_acknowledgement_due() {
  return std::exchange(acknowledgement_due_, false);
}

}  // namespace aureole
