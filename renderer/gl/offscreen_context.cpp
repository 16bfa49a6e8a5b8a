// What does not depend on the library that draws: the software rasteriser's thread count.
#include "renderer/gl/offscreen_context.h"

#include <cstdlib>

namespace aureole::render {

int configure_software_rasteriser(int threads) {
  check(threads >= 0 && threads <= 16, "llvmpipe takes 0 to 16 helper threads");
  // Last argument 0: what the operator has set stays.
  setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), 0);
  const char* value = std::getenv("LP_NUM_THREADS");
  return value != nullptr ? std::atoi(value) : threads;
}

}  // namespace aureole::render
