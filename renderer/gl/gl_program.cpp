// Compiling shaders into a program.
#include "renderer/gl/gl_program.h"

#include <array>

namespace aureole::render {
namespace {

Outcome<GLuint> compile(std::string_view name, GLenum stage, const std::string& source) {
  const GLuint shader = glCreateShader(stage);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  std::array<char, 2048> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  glDeleteShader(shader);
  return Failure{"the OpenGL driver refuses the shader '" + std::string(name) + "': " + log.data()};
}

}  // namespace

Outcome<GLuint> link_program(std::string_view name, const std::string& vertex_source,
                             const std::string& fragment_source) {
  const auto vertex = compile(name, GL_VERTEX_SHADER, vertex_source);
  if (!vertex) return vertex.failure();
  const auto fragment = compile(name, GL_FRAGMENT_SHADER, fragment_source);
  if (!fragment) return fragment.failure();
  const GLuint program = glCreateProgram();
  glAttachShader(program, *vertex);
  glAttachShader(program, *fragment);
  glLinkProgram(program);
  glDeleteShader(*vertex);
  glDeleteShader(*fragment);
  GLint linked = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE) {
    std::array<char, 2048> log{};
    glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
    return Failure{"the OpenGL driver cannot link the shaders '" + std::string(name) +
                   "': " + log.data()};
  }
  const GLuint block = glGetUniformBlockIndex(program, "Frame");
  if (block != GL_INVALID_INDEX) glUniformBlockBinding(program, block, 0);
  return program;
}

}  // namespace aureole::render
