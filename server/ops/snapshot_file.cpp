// Mapping, writing and judging the two files; see snapshot_file.h.
#include "server/ops/snapshot_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace aureole {
namespace {

constexpr std::uint64_t magic = 0x31'50'41'4e'53'52'55'41;  // "AURSNAP1" as bytes.
/// Larger states than any world has; a header that says more is damaged.
constexpr std::uint64_t bytes_max = std::uint64_t{1} << 32;
/// Of a file: a content, its header, and what is reserved ahead.
constexpr std::uint64_t size_max = 2 * bytes_max;
constexpr std::size_t page = 4096;

struct Header {
  std::uint64_t magic;
  std::uint64_t world_hash;
  std::uint64_t region;
  std::uint64_t sequence;  ///< 0 while the content is being written.
  std::uint64_t incarnation;
  std::int64_t tick;
  std::uint64_t bytes;
  std::uint64_t checksum;
};
static_assert(sizeof(Header) == 64);

/// Over the header as it is when it is whole, and the content. Eight bytes at a time, because it is
/// taken in the step: multiply and fold, so that every bit of every word reaches all others.
std::uint64_t checksum_of(const Header& header, std::span<const std::byte> bytes) {
  std::uint64_t sum = 0x9e37'79b9'7f4a'7c15u;
  const auto mix = [&sum](std::uint64_t word) {
    sum = (sum ^ word) * 0xff51'afd7'ed55'8ccdu;
    sum ^= sum >> 32;
  };
  for (const std::uint64_t field :
       {header.magic, header.world_hash, header.region, header.sequence, header.incarnation,
        static_cast<std::uint64_t>(header.tick), header.bytes})
    mix(field);
  std::uint64_t word = 0;
  for (; bytes.size() >= sizeof word; bytes = bytes.subspan(sizeof word)) {
    std::memcpy(&word, bytes.data(), sizeof word);
    mix(word);
  }
  word = 0;
  if (!bytes.empty()) std::memcpy(&word, bytes.data(), bytes.size());
  mix(word);
  return sum;
}

std::string reason() {
  return std::generic_category().message(errno);
}

}  // namespace

class SnapshotFile::Slot {
 public:
  Slot() = default;
  Slot(const Slot&) = delete;
  Slot& operator=(const Slot&) = delete;
  ~Slot() {
    if (map_ != nullptr) munmap(map_, size_);
    if (fd_ >= 0) close(fd_);
  }

  Status open(const std::filesystem::path& path) {
    fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (fd_ < 0) return Error::format("cannot open {}: {}", path.string(), reason());
    if (flock(fd_, LOCK_EX | LOCK_NB) != 0)
      return Error::format("{} is in use: is this region running already?", path.string());
    struct stat about {};
    if (fstat(fd_, &about) != 0)
      return Error::format("cannot read {}: {}", path.string(), reason());
    const auto size = static_cast<std::uint64_t>(about.st_size);
    if (size > size_max)
      return Error::format("{} has {} bytes, expected at most {}: it is no state of a region",
                           path.string(), size, size_max);
    // As large as it is: what grew with each opening would fill the disk, restart by restart.
    return map_pages(static_cast<std::size_t>(size));
  }

  Header header() const {
    Header h{};
    std::memcpy(&h, map_, sizeof h);
    return h;
  }
  /// Whether it holds a whole content.
  bool is_whole() const {
    const Header h = header();
    if (h.magic != magic || h.sequence == 0 || h.bytes > bytes_max) return false;
    if (sizeof(Header) + h.bytes > size_) return false;
    return checksum_of(h, content(h.bytes)) == h.checksum;
  }
  std::span<const std::byte> content(std::size_t bytes) const {
    return {static_cast<const std::byte*>(map_) + sizeof(Header), bytes};
  }

  Status write(Header h, std::span<const std::byte> bytes) {
    if (bytes.size() > bytes_max)
      return Error::format("a state has {} bytes, expected at most {}", bytes.size(), bytes_max);
    const std::size_t needed = sizeof(Header) + bytes.size();
    // States grow with their world: half as much again, so that this is rare.
    if (needed > size_)
      if (auto ok = map_pages(needed + needed / 2); !ok) return ok;
    h.checksum = checksum_of(h, bytes);
    const std::uint64_t sequence = std::exchange(h.sequence, 0);
    std::memcpy(map_, &h, sizeof h);
    std::atomic_thread_fence(std::memory_order_seq_cst);
    std::copy(bytes.begin(), bytes.end(), static_cast<std::byte*>(map_) + sizeof(Header));
    std::atomic_thread_fence(std::memory_order_seq_cst);
    h.sequence = sequence;
    std::memcpy(map_, &h, sizeof h);
    return Ok{};
  }

 private:
  /// Maps the file with room for `bytes`, at least one page. The pages are allocated at once: a
  /// full disk is an error here, not a signal in the step.
  Status map_pages(std::size_t bytes) {
    const std::size_t wanted = std::max((bytes + page - 1) / page, std::size_t{1}) * page;
    if (const int failed = posix_fallocate(fd_, 0, static_cast<off_t>(wanted)); failed != 0)
      return Error::format("no room for {} bytes of state: {}", wanted,
                           std::generic_category().message(failed));
    void* map = mmap(nullptr, wanted, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, 0);
    if (map == MAP_FAILED) return Error::format("cannot map the state file: {}", reason());
    if (map_ != nullptr) munmap(map_, size_);
    map_ = map;
    size_ = wanted;
    return Ok{};
  }

  int fd_ = -1;
  void* map_ = nullptr;
  std::size_t size_ = 0;
};

SnapshotFile::SnapshotFile() = default;
SnapshotFile::~SnapshotFile() = default;

Result<std::unique_ptr<SnapshotFile>> SnapshotFile::open(const std::filesystem::path& folder,
                                                         const Owner& owner) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed)
    return Error::format("cannot make the folder {}: {}", folder.string(), failed.message());
  std::unique_ptr<SnapshotFile> file(new SnapshotFile());
  file->owner_ = owner;
  for (int i = 0; i < 2; ++i) {
    auto& slot = file->slots_[i];
    slot = std::make_unique<Slot>();
    const auto path =
        folder / fmt::format("r{}-{}.snapshot", owner.region.value, i == 0 ? "a" : "b");
    if (auto ok = slot->open(path); !ok) return ok.error();
    const Header h = slot->header();
    if (h.magic == 0 || !slot->is_whole()) continue;
    if (h.world_hash != owner.world_hash || h.region != owner.region.value)
      return Error::format(
          "{} holds the state of another world: give each world a folder of its own, or remove it",
          path.string());
    file->sequence_ = std::max(file->sequence_, h.sequence);
  }
  return file;
}

std::optional<SnapshotFile::Content> SnapshotFile::newest() const {
  const Slot* best = nullptr;
  for (const auto& slot : slots_)
    if (slot->is_whole() && (best == nullptr || best->header().sequence < slot->header().sequence))
      best = slot.get();
  if (best == nullptr) return std::nullopt;
  const Header h = best->header();
  const auto bytes = best->content(h.bytes);
  return Content{{bytes.begin(), bytes.end()}, Incarnation{h.incarnation}, Tick{h.tick}};
}

Status SnapshotFile::write(std::span<const std::byte> bytes, Incarnation incarnation, Tick tick) {
  const std::uint64_t sequence = sequence_ + 1;
  // The number tells whose turn it is; after damage that is the damaged one's.
  Slot& turn = *slots_[slots_[0]->header().sequence == sequence_ && sequence_ != 0 ? 1 : 0];
  const Header h{magic,
                 owner_.world_hash,
                 owner_.region.value,
                 sequence,
                 incarnation.value,
                 tick.value,
                 bytes.size(),
                 0};
  if (auto ok = turn.write(h, bytes); !ok) return ok;
  sequence_ = sequence;
  return Ok{};
}

}  // namespace aureole
