// OffscreenContext by OSMesa, Mesa's context that draws into memory.
#include <GL/osmesa.h>

#include <array>
#include <mutex>
#include <vector>

#include "renderer/gl/gl.h"
#include "renderer/gl/offscreen_context.h"

namespace aureole::render {
namespace {

// OSMesa keeps a list of buffers and a state tracker for the whole process and does not say that
// they are guarded; contexts come, go and change threads rarely, so one lock costs nothing.
std::mutex& library_lock() {
  static std::mutex lock;
  return lock;
}

// OSMesa wants a default framebuffer of its own. Nothing is drawn there, so one pixel block does.
constexpr int default_framebuffer_side = 16;

class OsmesaContext final : public OffscreenContext {
 public:
  explicit OsmesaContext(OSMesaContext context)
      : context_(context), memory_(default_framebuffer_side * default_framebuffer_side * 4) {}

  ~OsmesaContext() override {
    std::lock_guard guard(library_lock());
    OSMesaDestroyContext(context_);
  }

  bool make_current() override {
    if (OSMesaGetCurrentContext() == context_) return true;
    std::lock_guard guard(library_lock());
    return OSMesaMakeCurrent(context_, memory_.data(), GL_UNSIGNED_BYTE, default_framebuffer_side,
                             default_framebuffer_side) == GL_TRUE;
  }

  std::string description() const override { return description_; }

  /// Asks the library for its names; false if it cannot be used at all.
  bool describe() {
    if (!make_current()) return false;
    const auto text = [](GLenum name) {
      const auto* bytes = glGetString(name);
      return bytes != nullptr ? std::string(reinterpret_cast<const char*>(bytes)) : std::string();
    };
    description_ = "OSMesa, OpenGL " + text(GL_VERSION) + ", " + text(GL_RENDERER);
    return glGetError() == GL_NO_ERROR;
  }

 private:
  OSMesaContext context_;
  std::vector<unsigned char> memory_;
  std::string description_;
};

OSMesaContext create(int major, int minor) {
  const std::array<int, 13> attributes{OSMESA_FORMAT,
                                       OSMESA_BGRA,
                                       OSMESA_DEPTH_BITS,
                                       0,
                                       OSMESA_PROFILE,
                                       OSMESA_CORE_PROFILE,
                                       OSMESA_CONTEXT_MAJOR_VERSION,
                                       major,
                                       OSMESA_CONTEXT_MINOR_VERSION,
                                       minor,
                                       0,
                                       0,
                                       0};
  std::lock_guard guard(library_lock());
  return OSMesaCreateContextAttribs(attributes.data(), nullptr);
}

}  // namespace

Outcome<std::unique_ptr<OffscreenContext>> make_osmesa_context() {
  for (const int minor : {5, 4, 3, 2}) {
    OSMesaContext handle = create(4, minor);
    if (handle == nullptr) continue;
    auto context = std::make_unique<OsmesaContext>(handle);
    if (!context->describe()) {
      return Failure{
          "OSMesa made an OpenGL context but could not make it current; is the memory "
          "limit of this process very low?"};
    }
    return std::unique_ptr<OffscreenContext>(std::move(context));
  }
  return Failure{
      "OSMesa offers no OpenGL core context of version 4.2 to 4.5; install Mesa's "
      "libosmesa6 (version 22 to 25.0)"};
}

}  // namespace aureole::render
