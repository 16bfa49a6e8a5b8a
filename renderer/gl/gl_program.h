// Compiling shaders into a program.
#pragma once

#include <string>
#include <string_view>

#include "renderer/gl/gl.h"
#include "renderer/outcome.h"

namespace aureole::render {

/// Links a program of one vertex and one fragment shader, in the current context, and binds its
/// uniform block `Frame`, if it has one, to binding point 0. The failure carries the compiler's
/// log.
Outcome<GLuint> link_program(std::string_view name, const std::string& vertex_source,
                             const std::string& fragment_source);

}  // namespace aureole::render
