// An OpenGL context without a window: the only thing that knows which library draws.
#pragma once

#include <memory>
#include <string>

#include "renderer/outcome.h"

namespace aureole::render {

/// One context, used from one thread at a time. Whoever draws makes an own framebuffer object; the
/// context's default framebuffer is never shown, so a context on a GPU (EGL) can stand in
/// unchanged. Destroying the context frees every OpenGL object that was made in it.
class OffscreenContext {
 public:
  OffscreenContext() = default;
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;
  virtual ~OffscreenContext() = default;

  /// Makes OpenGL calls of this thread go to this context; cheap when they already do.
  /// Returns false if the library refuses.
  virtual bool make_current() = 0;

  /// Library, version and rasteriser, for logs and for explaining a golden image that differs.
  virtual std::string description() const = 0;
};

/// A software context of OSMesa: core profile 4.5, or the highest of 4.2 … 4.4 that it offers (4.2
/// is the least that the renderer needs). The failure says which versions were tried.
Outcome<std::unique_ptr<OffscreenContext>> make_osmesa_context();

/// How many helper threads llvmpipe starts for each context, 0 … 16; 0 rasterises in the calling
/// thread. llvmpipe reads it when the process makes its first context, so call this before that and
/// before other threads start (it changes the environment). A value already set in the environment
/// (LP_NUM_THREADS) goes first, so that an operator can overrule it. Returns the number in force.
int configure_software_rasteriser(int threads);

}  // namespace aureole::render
