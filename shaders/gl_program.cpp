#include "shaders/gl_program.h"

#include <algorithm>

#include <epoxy/gl.h>

#include "core/support/error.h"

namespace arete {
namespace {

GLenum stage_of(const std::string& name) {
  const std::string extension = name.substr(name.rfind('.') + 1);
  if (extension == "vert") return GL_VERTEX_SHADER;
  if (extension == "tesc") return GL_TESS_CONTROL_SHADER;
  if (extension == "tese") return GL_TESS_EVALUATION_SHADER;
  return GL_FRAGMENT_SHADER;
}

std::string one_line(std::string log) {
  std::replace(log.begin(), log.end(), '\n', ' ');
  return log;
}

/// The text of a stage with the files in it that it includes, one a line: #include "light.glsl".
std::string whole_text(const std::string& name) {
  const std::string text = stage_text(name), word = "#include \"";
  std::string whole;
  for (std::size_t at = 0, end; at < text.size(); at = end) {
    end = text.find('\n', at) + 1;
    if (end == 0) end = text.size();
    if (text.compare(at, word.size(), word) == 0)
      whole += stage_text(text.substr(at + word.size(), text.find('"', at + word.size()) - at - word.size()));
    else
      whole.append(text, at, end - at);
  }
  return whole;
}

GLuint compile(const std::string& name, const std::string& defined) {
  const GLuint shader = glCreateShader(stage_of(name));
  std::string source = whole_text(name);
  // After the line that says the version.
  if (!defined.empty()) source.insert(source.find('\n') + 1, "#define " + defined + "\n");
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (!ok) {
    char log[2048] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    throw Error(ErrorKind::format, "the OpenGL driver does not compile " + name + ": " + one_line(log));
  }
  return shader;
}

}  // namespace

unsigned link_program(const std::vector<std::string>& stages, const std::vector<const char*>& captured, const std::string& defined) {
  const GLuint program = glCreateProgram();
  for (const std::string& name : stages) {
    const GLuint shader = compile(name, defined);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  if (!captured.empty()) glTransformFeedbackVaryings(program, static_cast<GLsizei>(captured.size()), captured.data(), GL_INTERLEAVED_ATTRIBS);
  glLinkProgram(program);
  GLint ok = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  if (!ok) {
    char log[2048] = "";
    glGetProgramInfoLog(program, sizeof log, nullptr, log);
    throw Error(ErrorKind::format, "the OpenGL driver does not link " + stages.front() + ": " + one_line(log));
  }
  return program;
}

}  // namespace arete
