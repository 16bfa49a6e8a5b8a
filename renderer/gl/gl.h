// OpenGL's functions for this room: prototypes are exported by the library, so no loader is
// involved.
#pragma once

#include <GL/gl.h>
#include <GL/glext.h>
