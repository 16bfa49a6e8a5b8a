// The scene and the renderers that the frame tests share.
#pragma once

#include <memory>
#include <utility>

#include "renderer/bench/demo_scene.h"
#include "renderer/renderer.h"
#include "tests/support/images/compare_images.h"

namespace aureole::test {

/// Room for another Mesa or LLVM than the one that drew the golden images. With the same Mesa,
/// frames are byte-identical on machines with AVX, and differ by 1 in a few hundred pixels without.
/// Another version may put an edge pixel on the other side: such pixels differ by anything up to
/// 255 but are few, so the maximum is not bounded; the number of pixels that differ visibly (by
/// more than 12) and the mean are. The tests below prove that a missing body or a camera moved by 1
/// cm exceeds this.
inline constexpr Tolerance another_rasteriser{12, 0.0008, 0.05};

/// A playground of 273 bodies with everything that can be drawn, at the golden images' size.
struct FixedScene {
  render::DemoScene demo = render::make_demo_scene(0);
  render::View view;

  FixedScene() {
    view.camera = demo.camera;
    view.width = 640;
    view.height = 360;
  }
};

/// A renderer of the demo's meshes; ends the test run with a sentence if there is no OpenGL.
inline std::unique_ptr<render::Renderer> make_renderer(const render::DemoScene& demo) {
  render::configure_software_rasteriser(0);
  auto context = render::make_osmesa_context();
  render::check(static_cast<bool>(context), "frame tests need OSMesa");
  auto renderer = render::Renderer::make(std::move(*context), demo.meshes, demo.geometry);
  render::check(static_cast<bool>(renderer), "frame tests need a renderer");
  return std::move(*renderer);
}

inline Image draw(render::Renderer& renderer, const render::Scene& scene,
                  const render::View& view) {
  return image_from(renderer.render(scene, view));
}

}  // namespace aureole::test
