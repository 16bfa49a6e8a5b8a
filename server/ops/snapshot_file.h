// A region's newest state on this machine's disk, where it survives `kill -9` of the process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/tick.h"

namespace aureole {

/// Two memory-mapped files that are written in turn, so that one of them is whole whenever the
/// process dies. What was stored is the kernel's then and needs no fsync: it outlives the process,
/// not the machine, for whose loss there are the gateways' stores.
class SnapshotFile {
 public:
  struct Owner {
    std::uint64_t world_hash = 0;
    RegionId region;
  };
  struct Content {
    std::vector<std::byte> bytes;
    Incarnation incarnation;  ///< Of the start that wrote it.
    Tick tick;
  };

  /// Opens the files of a region in `folder`, which is made if it is not there. An Error is a
  /// sentence: the folder cannot be written, another process uses these files, or they are of
  /// another world.
  static Result<std::unique_ptr<SnapshotFile>> open(const std::filesystem::path& folder,
                                                    const Owner& owner);
  ~SnapshotFile();
  SnapshotFile(const SnapshotFile&) = delete;
  SnapshotFile& operator=(const SnapshotFile&) = delete;

  /// The newest whole content; nothing if there is none yet.
  std::optional<Content> newest() const;
  /// Takes the place of the older of the two. An Error (the disk is full) leaves the newer one.
  Status write(std::span<const std::byte> bytes, Incarnation incarnation, Tick tick);

 private:
  class Slot;
  SnapshotFile();
  Owner owner_;
  std::unique_ptr<Slot> slots_[2];
  std::uint64_t sequence_ = 0;
};

}  // namespace aureole
