// Counting keys and motions.
#include "server/bench/replica_bytes.h"

#include <fmt/format.h>

#include "server/base/check.h"

namespace aureole {

void ReplicaBytes::add(const Bytes& frame) {
  const auto read = decode_frame(frame);
  AUREOLE_CHECK(read, "what was encoded here can be read back");
  const auto* update = verified<wire::ReplicaUpdate>(read->payload);
  AUREOLE_CHECK(update != nullptr, "it is a replica update");
  moving_ += update->keys()->size() + update->motions()->size();
  keys_ += update->keys()->size();
  payload_ += read->payload.size();
}

std::string ReplicaBytes::note() const {
  if (moving_ == 0) return "nothing moves";
  const auto each = [&](std::size_t bytes) {
    return static_cast<double>(bytes) / static_cast<double>(moving_);
  };
  const std::size_t of_keys = keys_ * sizeof(wire::ReplicaKey);
  return fmt::format("{:.2f} bytes a moving body and tick, and {:.2f} of key states",
                     each(payload_ - of_keys), each(of_keys));
}

}  // namespace aureole
