// Sorted lists that are searched by leaps and grow by blocks, against the standard's algorithms.
#include <algorithm>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "server/base/leap.h"
#include "server/base/merge_in.h"
#include "server/base/replace_in.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

/// Sorted; some of them equal.
std::vector<int> random_list(std::mt19937& random, std::size_t size) {
  std::uniform_int_distribution<int> number(0, 60);
  std::vector<int> list(size);
  for (int& one : list) one = number(random);
  std::sort(list.begin(), list.end());
  return list;
}

}  // namespace

TEST_CASE("a leap ends where a search of all of the list does") {
  std::mt19937 random(1);
  for (std::size_t size = 0; size < 70; ++size) {
    const std::vector<int> list = random_list(random, size);
    for (int key = -1; key <= 61; ++key) {
      const auto expected = std::lower_bound(list.begin(), list.end(), key);
      for (auto from = list.begin();; ++from) {
        REQUIRE(leap(from, list.end(), key, std::less<>{}) == std::max(from, expected));
        if (from == list.end()) break;
      }
    }
  }
}

TEST_CASE("what is merged in stands where std::inplace_merge() puts it, equal ones in order") {
  using Entry = std::pair<int, int>;  // Told apart by the second, sorted by the first.
  const auto before = [](const Entry& a, const Entry& b) { return a.first < b.first; };
  std::mt19937 random(2);
  for (std::size_t known = 0; known < 40; ++known) {
    for (std::size_t fresh = 0; fresh < 40; fresh += 3) {
      std::vector<Entry> list;
      for (const int key : random_list(random, known)) list.emplace_back(key, 0);
      for (const int key : random_list(random, fresh)) list.emplace_back(key, 1);
      for (std::size_t i = 0; i < list.size(); ++i)
        list[i].second = 100 * list[i].second + static_cast<int>(i);
      const auto middle = static_cast<std::ptrdiff_t>(known);
      std::vector<Entry> expected = list;
      std::inplace_merge(expected.begin(), expected.begin() + middle, expected.end(), before);
      merge_in(list, middle, before);
      REQUIRE(list == expected);
    }
  }
}

TEST_CASE("of a sorted list some go and others come, and all else keeps its order") {
  using Entry = std::pair<int, int>;  // Sorted by the first; the second says whether it came.
  const auto before = [](const Entry& a, const Entry& b) { return a.first < b.first; };
  std::mt19937 random(3);
  for (int round = 0; round < 4000; ++round) {
    // Who goes may have the key of who comes.
    const int going_of_8 = static_cast<int>(random() % 9),
              coming_of_8 = static_cast<int>(random() % 9);
    std::vector<Entry> list, fresh, expected;
    std::vector<std::size_t> gone;
    const int keys = static_cast<int>(random() % 40);
    for (int key = 0; key < keys; ++key) {
      const bool was = random() % 2 == 0;
      const bool goes = was && static_cast<int>(random() % 8) < going_of_8;
      const bool comes = (!was || goes) && static_cast<int>(random() % 8) < coming_of_8;
      if (goes) gone.push_back(list.size());
      if (was) list.emplace_back(key, 0);
      if (comes) fresh.emplace_back(key, 1);
      if (comes)
        expected.emplace_back(key, 1);
      else if (was && !goes)
        expected.emplace_back(key, 0);
    }
    replace_in<Entry>(list, gone, fresh, before);
    REQUIRE(list == expected);
  }
}
