// Turns that are taken one at a time, on a thread and a heap of one's own.
#include "server/experiment/server_thread.h"

#include <memory>
#include <set>
#include <stdexcept>
#include <vector>

#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("a server's turns are all taken by one thread, which is nobody else's, and waited for") {
  ServerThread first, second;
  std::set<std::thread::id> firsts, seconds;
  int turns = 0;  // Nothing guards it: nothing runs at the same time.
  for (int i = 0; i < 100; ++i) {
    first.run([&] {
      firsts.insert(std::this_thread::get_id());
      ++turns;
    });
    REQUIRE(turns == 2 * i + 1);
    second.run([&] {
      seconds.insert(std::this_thread::get_id());
      ++turns;
    });
    REQUIRE(turns == 2 * i + 2);
  }
  REQUIRE(firsts.size() == 1);
  REQUIRE(seconds.size() == 1);
  REQUIRE(firsts != seconds);
  REQUIRE(firsts.count(std::this_thread::get_id()) == 0);
}

TEST_CASE("what a server throws is thrown to who gave it its turn, and it goes on") {
  ServerThread thread;
  REQUIRE_THROWS_AS(thread.run([] { throw std::runtime_error("no"); }), std::runtime_error);
  bool ran = false;
  thread.run([&] { ran = true; });
  REQUIRE(ran);
}

TEST_CASE("what servers make by turns does not lie among what others make") {
  constexpr int servers = 40, things = 64;
  std::vector<std::unique_ptr<ServerThread>> threads;
  for (int i = 0; i < servers; ++i) threads.push_back(std::make_unique<ServerThread>());
  std::vector<std::vector<std::unique_ptr<char[]>>> made(servers);
  std::vector<std::set<std::uintptr_t>> pages(servers);
  for (int k = 0; k < things; ++k)
    for (std::size_t i = 0; i < servers; ++i)
      threads[i]->run([&] {
        made[i].push_back(std::make_unique<char[]>(500));
        pages[i].insert(reinterpret_cast<std::uintptr_t>(made[i].back().get()) / 4096);
      });
  for (std::size_t i = 0; i < servers; ++i) {
    INFO("server " << i);
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    // 64 things of 500 bytes need 8 pages; among those of 40 servers each would have its own.
    REQUIRE(pages[i].size() <= 16);
#else
    REQUIRE(pages[i].size() <= things);
#endif
  }
}
