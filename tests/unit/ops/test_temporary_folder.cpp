// Folders that vanish with who made them, however that ends.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <thread>

#include "server/ops/temporary_folder.h"
#include "tests/support/catch.h"

using namespace aureole;
namespace fs = std::filesystem;

namespace {

std::unique_ptr<TemporaryFolder> folder() {
  auto made = TemporaryFolder::make();
  REQUIRE(made);
  return std::move(*made);
}

}  // namespace

TEST_CASE("a temporary folder goes with what is in it") {
  fs::path path;
  {
    const auto place = folder();
    path = place->path();
    std::ofstream(path / "state") << "x";
    REQUIRE(fs::exists(path / "state"));
  }
  REQUIRE_FALSE(fs::exists(path));
}

TEST_CASE("folders that killed processes left behind go when the next one is made, others stay") {
  const auto outer = folder();
  const fs::path parent = outer->path();
  const auto living = TemporaryFolder::make(parent);
  REQUIRE(living);
  // A process that is killed while it holds a folder.
  int told[2];
  REQUIRE(pipe(told) == 0);
  const pid_t child = fork();
  if (child == 0) {
    const auto held = TemporaryFolder::make(parent);
    if (!held) _exit(1);
    std::ofstream((*held)->path() / "state") << "x";
    const std::string path = (*held)->path().string();
    if (write(told[1], path.data(), path.size()) < 0) _exit(1);
    while (true) pause();
  }
  close(told[1]);
  char name[256] = {};
  const bool heard = read(told[0], name, sizeof name - 1) > 0;
  close(told[0]);
  const fs::path killed = name;
  const auto beside = TemporaryFolder::make(parent);
  const bool kept_while_it_lives = fs::exists(killed / "state");
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  REQUIRE(heard);
  REQUIRE(kept_while_it_lives);
  REQUIRE(fs::exists(killed / "state"));

  for (const char* other : {"aureole-state-longer1", "aureole-state-abc", "aureole-other-abcdef"})
    fs::create_directory(parent / other);
  std::ofstream(parent / "aureole-state-abcdef") << "a file";
  fs::create_directory(parent / "elsewhere");
  std::ofstream(parent / "elsewhere" / "state") << "x";
  fs::create_directory_symlink("elsewhere", parent / "aureole-state-linked");
  const auto next = TemporaryFolder::make(parent);
  REQUIRE(next);
  REQUIRE_FALSE(fs::exists(killed));
  for (const fs::path& stays : {(*living)->path(), (*beside)->path(), (*next)->path(),
                                parent / "aureole-state-longer1", parent / "aureole-state-abc",
                                parent / "aureole-other-abcdef", parent / "aureole-state-abcdef",
                                parent / "aureole-state-linked", parent / "elsewhere" / "state"})
    REQUIRE(fs::exists(stays));
}

TEST_CASE("folders of another user stay, also where one may remove them") {
  if (geteuid() != 0) return;  // Only the superuser can give a folder away.
  const auto outer = folder();
  const fs::path foreign = outer->path() / "aureole-state-abcdef";
  fs::create_directory(foreign);
  REQUIRE(chown(foreign.c_str(), 12345, 12345) == 0);
  REQUIRE(TemporaryFolder::make(outer->path()));
  REQUIRE(fs::exists(foreign));
}

TEST_CASE("folders that many make at once are all there, and each has one holder") {
  const auto outer = folder();
  constexpr std::size_t makers = 4, rounds = 4000;
  std::vector<std::thread> threads;
  std::vector<std::size_t> kept(makers);
  for (std::size_t n = 0; n < makers; ++n)
    threads.emplace_back([&, n] {
      for (std::size_t round = 0; round < rounds; ++round) {
        const auto made = TemporaryFolder::make(outer->path());
        if (!made) continue;
        std::ofstream((*made)->path() / "state") << "x";
        std::this_thread::yield();
        kept[n] += fs::exists((*made)->path() / "state");
      }
    });
  for (std::thread& thread : threads) thread.join();
  REQUIRE(kept == std::vector(makers, rounds));
  REQUIRE(fs::is_empty(outer->path()));
}

TEST_CASE("where no folder can be made the error names the place") {
  const auto made = TemporaryFolder::make("/proc/nowhere");
  REQUIRE(made.error().message.find("/proc/nowhere") != std::string::npos);
}
