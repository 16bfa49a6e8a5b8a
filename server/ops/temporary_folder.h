// A folder that nothing of is left once its process is gone.
#pragma once

#include <filesystem>
#include <memory>
#include <utility>

#include "server/base/result.h"

namespace aureole {

/// A folder of this user alone that vanishes with the object; on memory where the system has such.
/// A lock on it tells others that its process lives; the kernel takes it back when that is killed.
class TemporaryFolder {
 public:
  /// Also removes those of this user that processes which were killed have left behind.
  static Result<std::unique_ptr<TemporaryFolder>> make();
  /// The same in a folder of the caller's choice.
  static Result<std::unique_ptr<TemporaryFolder>> make(const std::filesystem::path& parent);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  TemporaryFolder(std::filesystem::path path, int held) : path_(std::move(path)), held_(held) {}
  std::filesystem::path path_;
  int held_;  ///< Descriptor of the folder, locked.
};

}  // namespace aureole
