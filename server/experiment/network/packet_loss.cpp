// Segment by segment.
#include "server/experiment/network/packet_loss.h"

#include <algorithm>

namespace aureole {

PacketLoss::Fate PacketLoss::draw(std::size_t frame_bytes) {
  Fate fate;
  if (!any()) return fate;
  const std::size_t segments =
      std::max<std::size_t>(1, (frame_bytes + segment_bytes - 1) / segment_bytes);
  for (std::size_t i = 0; i < segments; ++i) {
    fate.last_lost = random_.chance(share_);
    if (!fate.last_lost) continue;
    fate.lost = true;
    Micros again_us = 0;
    for (int n = 0; random_.chance(share_); ++n)
      again_us += timer_us() << std::min(n, doublings_max);
    // All that were lost are sent again at the same time.
    fate.again_us = std::max(fate.again_us, again_us);
  }
  return fate;
}

}  // namespace aureole
