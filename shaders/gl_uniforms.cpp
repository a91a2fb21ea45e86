#include "shaders/gl_uniforms.h"

#include <algorithm>

#include <epoxy/gl.h>

namespace arete {

void set(GLuint program, const char* name, const Colour3& v) { glProgramUniform3f(program, glGetUniformLocation(program, name), v[0], v[1], v[2]); }
void set(GLuint program, const char* name, double x) { glProgramUniform1f(program, glGetUniformLocation(program, name), static_cast<float>(x)); }
void set(GLuint program, const char* name, double x, double y) {
  glProgramUniform2f(program, glGetUniformLocation(program, name), static_cast<float>(x), static_cast<float>(y));
}
void set_int(GLuint program, const char* name, int x) { glProgramUniform1i(program, glGetUniformLocation(program, name), x); }
void set_int(GLuint program, const char* name, std::int64_t x, std::int64_t y) {
  glProgramUniform2i(program, glGetUniformLocation(program, name), static_cast<GLint>(x), static_cast<GLint>(y));
}
void set(GLuint program, const char* name, const std::array<double, 16>& m) {
  std::array<float, 16> values;
  std::copy(m.begin(), m.end(), values.begin());
  glProgramUniformMatrix4fv(program, glGetUniformLocation(program, name), 1, GL_FALSE, values.data());
}

}  // namespace arete
