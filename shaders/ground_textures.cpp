#include "shaders/ground_textures.h"

#include <epoxy/gl.h>

#include <string>
#include <vector>

#include "core/support/error.h"
#include "shaders/picture_atlas.h"
#include "shaders/srgb.h"

namespace arete {

unsigned make_ramp_texture(const SceneOptions& options) {
  constexpr std::size_t count = 1024;
  std::vector<float> table;
  for (auto colours : {options.ramp, options.slope_ramp, options.aspect_ramp}) {
    if (colours.empty()) colours = {{200, 198, 194}};
    for (std::size_t i = 0; i < count; ++i)
      for (const std::uint8_t value : colours[(i * (colours.size() - 1) + count / 2) / (count - 1)])
        table.push_back(static_cast<float>(srgb_to_linear(value / 255.0)));
  }
  GLuint ramps = 0;
  glCreateTextures(GL_TEXTURE_1D_ARRAY, 1, &ramps);
  glTextureStorage2D(ramps, 1, GL_RGB32F, count, 3);
  glTextureSubImage2D(ramps, 0, 0, 0, count, 3, GL_RGB, GL_FLOAT, table.data());
  glTextureParameteri(ramps, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) glTextureParameteri(ramps, filter, GL_LINEAR);
  return ramps;
}

unsigned make_drape_texture(const GroundPicture& picture, unsigned program, int threads) {
  const PictureAtlas atlas = make_atlas(picture, threads);
  const auto width = static_cast<GLsizei>(atlas.size.width), height = static_cast<GLsizei>(atlas.size.height);
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (width > largest || height > largest)
    throw Error(ErrorKind::input, "the OpenGL driver takes no picture of " + std::to_string(picture.size.width) + " x " +
                                      std::to_string(picture.size.height) + " pixels to lay over the ground: its textures have " +
                                      std::to_string(largest) + " at most");
  GLuint drape = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &drape);
  glTextureStorage2D(drape, 1, GL_SRGB8_ALPHA8, width, height);
  glTextureSubImage2D(drape, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, atlas.rgba.data());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) glTextureParameteri(drape, filter, GL_LINEAR);

  const auto set = [&](const char* name, double x, double y) {
    glProgramUniform2f(program, glGetUniformLocation(program, name), static_cast<float>(x), static_cast<float>(y));
  };
  const std::vector<float> rows(atlas.rows.begin(), atlas.rows.end());
  glProgramUniform1fv(program, glGetUniformLocation(program, "drape_rows"), static_cast<GLsizei>(rows.size()), rows.data());
  glProgramUniform1i(program, glGetUniformLocation(program, "drape_last"), static_cast<GLint>(rows.size()) - 1);
  const auto columns = static_cast<double>(picture.size.width), lines = static_cast<double>(picture.size.height);
  set("drape_size", columns, lines);
  // Sample 0 is the centre of the first cell.
  set("drape_corner", picture.left - 0.5, picture.top - 0.5);
  set("drape_cell", picture.cell.x_m, picture.cell.y_m);
  set("drape_scale", columns / picture.width, lines / picture.height);
  return drape;
}

}  // namespace arete
