// States on the disk: the newest whole one is found, whatever happened to the other.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <fstream>

#include "server/ops/snapshot_file.h"
#include "server/ops/temporary_folder.h"
#include "tests/support/catch.h"

using namespace aureole;
namespace fs = std::filesystem;

namespace {

const SnapshotFile::Owner owner{7, RegionId{2}};

std::vector<std::byte> bytes(char c, std::size_t size) {
  return std::vector<std::byte>(size, static_cast<std::byte>(c));
}

std::unique_ptr<TemporaryFolder> folder() {
  auto made = TemporaryFolder::make();
  REQUIRE(made);
  return std::move(*made);
}

std::unique_ptr<SnapshotFile> open(const fs::path& path) {
  auto file = SnapshotFile::open(path, owner);
  REQUIRE((file ? "" : file.error().message) == "");
  return std::move(*file);
}

void spoil(const fs::path& path, std::streamoff at) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(at);
  file.put('\x55');
}

}  // namespace

TEST_CASE("the newest state is found again, of any size, with the start and tick it is of") {
  const auto place = folder();
  REQUIRE_FALSE(open(place->path() / "new")->newest());
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{100'003}}) {
    const auto file = open(place->path());
    for (char c = 'a'; c < 'f'; ++c) REQUIRE(file->write(bytes(c, size), Incarnation{3}, Tick{c}));
    REQUIRE(file->newest()->bytes == bytes('e', size));
  }
  const auto found = open(place->path())->newest();
  REQUIRE(found->bytes == bytes('e', 100'003));
  REQUIRE(found->incarnation == Incarnation{3});
  REQUIRE(found->tick == Tick{'e'});
}

TEST_CASE("a state that is damaged or half written counts as none, and the one before is found") {
  const auto place = folder();
  {
    const auto file = open(place->path());
    for (char c = 'a'; c < 'e'; ++c) REQUIRE(file->write(bytes(c, 5000), Incarnation{1}, Tick{c}));
  }
  // a and c are in the first file, b and d in the second one.
  spoil(place->path() / "r2-b.snapshot", 64 + 3000);
  auto file = open(place->path());
  REQUIRE(file->newest()->bytes == bytes('c', 5000));
  // It goes on in the damaged one, never in the only good one.
  REQUIRE(file->write(bytes('x', 5000), Incarnation{2}, Tick{9}));
  file.reset();
  spoil(place->path() / "r2-b.snapshot", 24);
  REQUIRE(open(place->path())->newest()->bytes == bytes('c', 5000));
  spoil(place->path() / "r2-a.snapshot", 64);
  REQUIRE_FALSE(open(place->path())->newest());
}

TEST_CASE("a state that is opened and written again and again keeps its size on the disk") {
  const auto place = folder();
  const auto size = [&] { return fs::file_size(place->path() / "r2-a.snapshot"); };
  REQUIRE(open(place->path())->write(bytes('a', 50'000), Incarnation{1}, Tick{1}));
  const auto at_first = size();
  REQUIRE(at_first < 100'000);
  for (int restart = 0; restart < 10; ++restart) {
    const auto file = open(place->path());
    for (int n = 0; n < 3; ++n)
      REQUIRE(file->write(bytes('b', 50'000), Incarnation{1}, Tick{2 + n}));
  }
  REQUIRE(size() == at_first);
}

TEST_CASE("a file that is too large for any state is refused before it is read") {
  const auto place = folder();
  std::ofstream(place->path() / "r2-a.snapshot") << "x";
  fs::resize_file(place->path() / "r2-a.snapshot", std::uintmax_t{1} << 34);  // Without pages.
  const auto file = SnapshotFile::open(place->path(), owner);
  REQUIRE(file.error().message.find("expected at most") != std::string::npos);
}

TEST_CASE("files of another world are refused, and files that are in use") {
  const auto place = folder();
  {
    const auto file = open(place->path());
    REQUIRE(file->write(bytes('a', 10), Incarnation{1}, Tick{1}));
    const auto twice = SnapshotFile::open(place->path(), owner);
    REQUIRE(twice.error().message.find("is this region running already?") != std::string::npos);
  }
  const auto other = SnapshotFile::open(place->path(), {8, RegionId{2}});
  REQUIRE(other.error().message.find("holds the state of another world") != std::string::npos);
  REQUIRE(SnapshotFile::open(place->path(), {8, RegionId{3}}));
}

TEST_CASE("a folder that cannot be made is told by its name") {
  const auto file = SnapshotFile::open("/proc/nowhere", owner);
  REQUIRE(file.error().message.find("/proc/nowhere") != std::string::npos);
}

TEST_CASE("whenever a writer is killed, a whole state is left behind") {
  const auto place = folder();
  for (int n = 0; n < 20; ++n) {
    // A busy machine may start the child late: it says when there is a state to leave behind.
    int written[2] = {-1, -1};
    REQUIRE(pipe(written) == 0);
    const pid_t child = fork();
    if (child == 0) {
      auto file = SnapshotFile::open(place->path(), owner);
      if (!file) _exit(1);
      for (int i = 0;; ++i) {
        const char c = static_cast<char>('a' + i % 26);
        static_cast<void>((*file)->write(bytes(c, 200'000), Incarnation{1}, Tick{c}));
        if (i == 0 && write(written[1], &c, 1) != 1) _exit(1);
      }
    }
    close(written[1]);
    char first = 0;
    const bool has_written = read(written[0], &first, 1) == 1;
    close(written[0]);
    usleep(static_cast<useconds_t>(700 * n));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(has_written);
    REQUIRE(WIFSIGNALED(status));
    const auto found = open(place->path())->newest();
    REQUIRE(found);
    REQUIRE(found->bytes == bytes(static_cast<char>(found->tick.value), 200'000));
  }
}
