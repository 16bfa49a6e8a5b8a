// Whose turn it is, and whether anybody still reads it.
#include "protocol/frame_pool.h"

#include "server/base/prefetch.h"

namespace aureole {

SharedBytes FramePool::make(FrameType type, std::uint64_t sequence,
                            std::span<const std::byte> payload) {
  if (payload.size() > kept_payload_max)
    return std::make_shared<const Bytes>(encode_frame(type, sequence, payload));
  std::shared_ptr<Bytes>& frame = frames_[next_];
  next_ = (next_ + 1) % frames_.size();
  // Whoever still holds that one keeps it.
  if (frame.use_count() != 1) frame = std::make_shared<Bytes>();
  encode_frame_into(*frame, type, sequence, payload);
  // Nobody has touched the next one for some ticks.
  if (const auto& next = frames_[next_]) prefetch(next.get());
  return frame;
}

}  // namespace aureole
