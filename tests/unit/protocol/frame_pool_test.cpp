// Frames in the memory of frames that nobody holds any more.
#include "protocol/frame_pool.h"

#include <cstddef>
#include <memory>
#include <vector>

#include "tests/support/catch.h"

using namespace aureole;

namespace {

/// `size` bytes that say which one it is.
Bytes payload(std::size_t size, int which) {
  return Bytes(size, static_cast<std::byte>(which));
}

SharedBytes make(FramePool& pool, const Bytes& payload) {
  return pool.make(FrameType::auras, 0, payload);
}

}  // namespace

TEST_CASE("a frame of a pool is the one that would be encoded without it") {
  FramePool pool(2);
  // Longer, shorter, not a multiple of 8, and empty: each in the place of the one before the last.
  for (const std::size_t size : {40u, 13u, 800u, 0u, 7u, 64u}) {
    const Bytes bytes = payload(size, static_cast<int>(size));
    REQUIRE(*make(pool, bytes) == encode_frame(FrameType::auras, 0, bytes));
    REQUIRE(*pool.make(FrameType::handoff, 9, bytes) == encode_frame(FrameType::handoff, 9, bytes));
  }
}

TEST_CASE("a frame that somebody holds stays as it is") {
  FramePool pool(2);
  std::vector<SharedBytes> held;
  for (int which = 0; which < 7; ++which) held.push_back(make(pool, payload(24, which)));
  for (int which = 0; which < 7; ++which)
    REQUIRE(*held[static_cast<std::size_t>(which)] ==
            encode_frame(FrameType::auras, 0, payload(24, which)));
}

TEST_CASE("a frame that nobody holds gives its memory to a later one") {
  FramePool pool(2);
  const std::byte* const first = make(pool, payload(24, 1))->data();
  const SharedBytes second = make(pool, payload(24, 2));
  REQUIRE(second->data() != first);
  REQUIRE(make(pool, payload(24, 3))->data() == first);
  // The second one is still held: its turn goes to a frame of its own, which is kept from then on.
  const std::byte* const fourth = make(pool, payload(24, 4))->data();
  REQUIRE(fourth != second->data());
  REQUIRE(make(pool, payload(24, 5))->data() == first);
  REQUIRE(make(pool, payload(24, 6))->data() == fourth);
  REQUIRE(*second == encode_frame(FrameType::auras, 0, payload(24, 2)));
}

TEST_CASE("of long frames no memory is kept") {
  FramePool pool(1);
  const std::weak_ptr<const Bytes> longest = make(pool, payload(FramePool::kept_payload_max, 1));
  REQUIRE_FALSE(longest.expired());
  const SharedBytes longer = make(pool, payload(FramePool::kept_payload_max + 1, 2));
  REQUIRE(longer->size() > FramePool::kept_payload_max);
  REQUIRE(longer.use_count() == 1);
}
