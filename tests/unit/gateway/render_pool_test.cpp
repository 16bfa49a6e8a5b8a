// Render threads with a maker that draws nothing.
#include "server/gateway/pictures/render_pool.h"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>

#include "tests/support/catch.h"

using namespace aureole;

namespace {

/// Holds every picture back until it is let go, and counts.
struct Gate {
  std::mutex mutex;
  std::condition_variable changed;
  int made = 0;
  int allowed = 0;
  std::deque<std::function<void()>> posted;

  void allow(int more) {
    const std::lock_guard lock(mutex);
    allowed += more;
    changed.notify_all();
  }
  RenderPool::Post post() {
    return [this](std::function<void()> f) {
      const std::lock_guard lock(mutex);
      posted.push_back(std::move(f));
      changed.notify_all();
    };
  }
  /// Runs answers as they come until `count` have been given.
  void answer(int count) {
    while (count > 0) {
      std::function<void()> next;
      {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return !posted.empty(); });
        next = std::move(posted.front());
        posted.pop_front();
      }
      next();
      --count;
    }
  }
};

class GatedMaker : public PictureMaker {
 public:
  explicit GatedMaker(Gate& gate) : gate_(gate) {}
  Result<Picture> make(const PictureRequest& request) override {
    std::unique_lock lock(gate_.mutex);
    ++gate_.made;
    gate_.changed.notify_all();
    gate_.changed.wait(lock, [&] { return gate_.allowed > 0; });
    --gate_.allowed;
    if (request.quality == 13) return Error{"no picture of quality 13"};
    Picture picture;
    picture.bytes = std::make_shared<const std::vector<std::byte>>(
        static_cast<std::size_t>(request.view.width));
    return picture;
  }

 private:
  Gate& gate_;
};

PictureMakerFactory factory(Gate& gate) {
  return [&gate]() -> Result<std::unique_ptr<PictureMaker>> {
    return std::unique_ptr<PictureMaker>(std::make_unique<GatedMaker>(gate));
  };
}

PictureRequest request(const SharedScene& scene, int width = 100) {
  PictureRequest r;
  r.scene = scene;
  r.view.width = width;
  return r;
}

}  // namespace

TEST_CASE("Equal views of one scene are drawn once and answered each") {
  Gate gate;
  RenderPool pool(factory(gate), gate.post());
  REQUIRE(pool.start(1));
  const auto scene = std::make_shared<const render::Scene>();
  std::vector<std::size_t> sizes;
  const auto answer = [&](const Result<Picture>& p) { sizes.push_back(p->bytes->size()); };
  for (int i = 0; i < 3; ++i) REQUIRE(pool.submit(request(scene), answer));
  REQUIRE(pool.submit(request(scene, 200), answer));
  // The same content in another object is another moment.
  REQUIRE(pool.submit(request(std::make_shared<const render::Scene>(), 100), answer));
  gate.allow(10);
  gate.answer(3);
  REQUIRE(sizes == std::vector<std::size_t>{100, 100, 100, 200, 100});
  REQUIRE(gate.made == 3);
}

TEST_CASE("A picture that fails is answered with its error, and the next one is drawn") {
  Gate gate;
  RenderPool pool(factory(gate), gate.post());
  REQUIRE(pool.start(1));
  auto bad = request(std::make_shared<const render::Scene>());
  bad.quality = 13;
  std::vector<bool> good;
  const auto answer = [&](const Result<Picture>& p) { good.push_back(bool(p)); };
  REQUIRE(pool.submit(bad, answer));
  REQUIRE(pool.submit(request(std::make_shared<const render::Scene>()), answer));
  gate.allow(2);
  gate.answer(2);
  REQUIRE(good == std::vector<bool>{false, true});
}

TEST_CASE("A pool that is full takes no more, and ends with requests still waiting") {
  Gate gate;
  {
    RenderPool pool(factory(gate), gate.post());
    REQUIRE(pool.start(1));
    const auto ignore = [](const Result<Picture>&) {};
    REQUIRE(pool.submit(request(std::make_shared<const render::Scene>()), ignore));
    {
      std::unique_lock lock(gate.mutex);
      gate.changed.wait(lock, [&] { return gate.made == 1; });
    }
    for (std::size_t i = 0; i < RenderPool::max_queued; ++i)
      REQUIRE(pool.submit(request(std::make_shared<const render::Scene>()), ignore));
    REQUIRE_FALSE(pool.submit(request(std::make_shared<const render::Scene>()), ignore));
    gate.allow(static_cast<int>(RenderPool::max_queued) + 1);
  }
  // Nobody has answered: what was drawn was posted, what was not is forgotten.
  REQUIRE(static_cast<int>(gate.posted.size()) == gate.made);
}

TEST_CASE("A thread that cannot draw is reported when the pool starts") {
  RenderPool pool([]() -> Result<std::unique_ptr<PictureMaker>> { return Error{"no OpenGL here"}; },
                  [](std::function<void()>) {});
  const auto started = pool.start(2);
  REQUIRE_FALSE(started);
  REQUIRE(started.error().message == "no OpenGL here");
}
