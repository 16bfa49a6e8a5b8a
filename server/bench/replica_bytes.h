// What replica updates weigh for each moving body, keys apart.
#pragma once

#include <string>

#include "protocol/wire.h"

namespace aureole {

class ReplicaBytes {
 public:
  /// `frame`: a whole FrameType::replica_update.
  void add(const Bytes& frame);
  std::string note() const;

 private:
  std::size_t moving_ = 0;  ///< Bodies told of, times ticks.
  std::size_t keys_ = 0;
  std::size_t payload_ = 0;
};

}  // namespace aureole
