// The framebuffer object that is drawn into, and its way into memory.
#pragma once

#include "renderer/gl/gl.h"
#include "renderer/pixels.h"

namespace aureole::render {

/// Colour and depth of one size. The OpenGL objects die with their context.
class RenderTargets {
 public:
  /// Binds the framebuffer in this size, making it anew if the size changed.
  void bind(int width, int height);
  /// Waits until everything is drawn and copies it to `pixels`.
  void read(Pixels& pixels) const;

 private:
  GLuint framebuffer_ = 0, colour_ = 0, depth_ = 0;
  int width_ = 0, height_ = 0;
};

}  // namespace aureole::render
