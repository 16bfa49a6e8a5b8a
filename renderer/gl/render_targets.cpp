// The framebuffer object that is drawn into, and its way into memory.
#include "renderer/gl/render_targets.h"

#include "renderer/outcome.h"

namespace aureole::render {

void RenderTargets::bind(int width, int height) {
  if (framebuffer_ == 0) {
    glGenFramebuffers(1, &framebuffer_);
    glGenTextures(1, &colour_);
    glGenRenderbuffers(1, &depth_);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, width, height);
  if (width == width_ && height == height_) return;

  // BGRA bytes in the texture are what is read back: the read is a plain copy.
  glBindTexture(GL_TEXTURE_2D, colour_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_BGRA, GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour_, 0);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_);
  // Floats: llvmpipe compares them as they are, 24 bits it has to convert.
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  check(glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE,
        "an 8 bit frame of at most 3840 x 2160 pixels can be drawn into");
  width_ = width;
  height_ = height;
}

void RenderTargets::read(Pixels& pixels) const {
  pixels.width = width_;
  pixels.height = height_;
  pixels.bottom_up = true;
  pixels.bgrx.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * 4);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width_, height_, GL_BGRA, GL_UNSIGNED_BYTE, pixels.bgrx.data());
}

}  // namespace aureole::render
