// Frames depend on scene and view alone: not on order, thread, renderer or what was drawn before.
#include <algorithm>
#include <array>
#include <thread>

#include "renderer/bench/render_bench.h"
#include "renderer/jpeg_encoder.h"
#include "tests/frames/render_scene.h"
#include "tests/support/catch.h"

namespace aureole::test {

TEST_CASE("Instances in shuffled order give identical bytes") {
  FixedScene fixed;
  const auto renderer = make_renderer(fixed.demo);
  const Image original = draw(*renderer, fixed.demo.scene, fixed.view);
  render::Scene shuffled = fixed.demo.scene;
  std::uint32_t state = 1;
  for (std::size_t k = shuffled.instances.size() - 1; k > 0; --k) {
    state = state * 1664525u + 1013904223u;
    std::swap(shuffled.instances[k], shuffled.instances[(state >> 8) % (k + 1)]);
  }
  REQUIRE(shuffled.instances.front().sort_key != fixed.demo.scene.instances.front().sort_key);
  CHECK(draw(*renderer, shuffled, fixed.view) == original);
}

TEST_CASE("Two renderers in two threads give identical bytes") {
  const FixedScene fixed;
  const Image expected = draw(*make_renderer(fixed.demo), fixed.demo.scene, fixed.view);
  std::array<int, 2> different{-1, -1};
  const auto work = [&](std::size_t thread) {
    const auto renderer = make_renderer(fixed.demo);
    int count = 0;
    for (int frame = 0; frame < 8; ++frame) {
      // In between, each thread draws something of its own.
      render::View other = fixed.view;
      other.camera = render::demo_walk(frame * 17 + static_cast<int>(thread) * 5);
      other.width = 320 + 64 * static_cast<int>(thread);
      renderer->render(fixed.demo.scene, other);
      if (draw(*renderer, fixed.demo.scene, fixed.view) != expected) ++count;
    }
    different[thread] = count;
  };
  std::thread first(work, 0), second(work, 1);
  first.join();
  second.join();
  CHECK(different[0] == 0);
  CHECK(different[1] == 0);
}

TEST_CASE("A renderer may be handed to another thread") {
  const FixedScene fixed;
  const auto renderer = make_renderer(fixed.demo);
  const Image here = draw(*renderer, fixed.demo.scene, fixed.view);
  Image there;
  std::thread([&] { there = draw(*renderer, fixed.demo.scene, fixed.view); }).join();
  CHECK(there == here);
  CHECK(draw(*renderer, fixed.demo.scene, fixed.view) == here);
}

TEST_CASE("Changing the size back and forth changes nothing") {
  FixedScene fixed;
  const auto renderer = make_renderer(fixed.demo);
  const Image before = draw(*renderer, fixed.demo.scene, fixed.view);
  render::View odd = fixed.view;
  odd.width = 333;
  odd.height = 77;
  const Image between = draw(*renderer, fixed.demo.scene, odd);
  CHECK(between.width == 333);
  CHECK(between.height == 77);
  CHECK(draw(*renderer, fixed.demo.scene, fixed.view) == before);
  odd.width = -5;
  odd.height = 1 << 30;
  const Image limited = draw(*renderer, fixed.demo.scene, odd);
  CHECK(limited.width == 16);
  CHECK(limited.height == 2160);
}

TEST_CASE("One's own avatar is not in one's own picture") {
  FixedScene fixed;
  const auto renderer = make_renderer(fixed.demo);
  const auto& instances = fixed.demo.scene.instances;
  const auto avatar = std::find_if(instances.begin(), instances.end(), [](const auto& i) {
    return i.position.isApprox(Eigen::Vector3f(-3.4f, 0.9f, 6.2f));
  });
  REQUIRE(avatar != instances.end());
  render::View own = fixed.view;
  own.hidden_key = avatar->sort_key;
  const Image hidden = draw(*renderer, fixed.demo.scene, own);
  CHECK(hidden != draw(*renderer, fixed.demo.scene, fixed.view));
  render::Scene without = fixed.demo.scene;
  without.instances.erase(without.instances.begin() + (avatar - instances.begin()));
  CHECK(hidden == draw(*renderer, without, fixed.view));
}

TEST_CASE("Replacing the static geometry changes the frame, and putting it back restores it") {
  FixedScene fixed;
  const auto renderer = make_renderer(fixed.demo);
  const Image before = draw(*renderer, fixed.demo.scene, fixed.view);
  render::StaticGeometry bare;
  bare.has_ground = false;
  renderer->set_static(bare);
  CHECK(draw(*renderer, fixed.demo.scene, fixed.view) != before);
  renderer->set_static(fixed.demo.geometry);
  CHECK(draw(*renderer, fixed.demo.scene, fixed.view) == before);
}

TEST_CASE("A frame comes back from JPEG nearly as it was drawn") {
  FixedScene fixed;
  const auto renderer = make_renderer(fixed.demo);
  const render::Pixels& pixels = renderer->render(fixed.demo.scene, fixed.view);
  render::JpegEncoder encoder;
  const auto jpeg = encoder.encode(pixels, 85);
  REQUIRE(jpeg);
  const auto decoded = render::decode_jpeg(*jpeg);
  REQUIRE(decoded);
  // Quality 85 with halved chroma: 2 levels on average; sharp coloured edges differ by more.
  const auto comparison = compare(image_from(*decoded), image_from(pixels), {48, 0.01, 2.5});
  INFO(comparison);
  CHECK(comparison.matches);
}

TEST_CASE("The benchmark measures frames that hold bodies") {
  render::RenderBenchOptions options;
  options.bodies = {300, 600};
  options.width = 160;
  options.height = 90;
  options.frames = 3;
  const auto results = render::run_render_bench(options);
  REQUIRE(results);
  REQUIRE(results->size() == 2);
  for (const auto& r : *results) {
    CHECK(r.render_cpu_ms > 0);
    CHECK(r.encode_cpu_ms > 0);
    CHECK(r.bytes_per_frame > 500);
    CHECK(r.as_triangles + r.as_points > 0);
  }
  CHECK((*results)[0].bodies == 300);
  CHECK((*results)[1].bodies == 600);
}

}  // namespace aureole::test
