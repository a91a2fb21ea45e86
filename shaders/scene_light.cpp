#include "shaders/scene_light.h"

#include <algorithm>
#include <cmath>

#include <epoxy/gl.h>

#include "shaders/gl_uniforms.h"
#include "shaders/srgb.h"

namespace arete {
namespace {

float to_linear(double v) { return static_cast<float>(srgb_to_linear(v)); }
Colour3 linear(int r, int g, int b) { return {to_linear(r / 255.0), to_linear(g / 255.0), to_linear(b / 255.0)}; }

const Colour3 haze_colour = linear(222, 231, 240), zenith_colour = linear(104, 150, 202), below_colour = linear(247, 246, 243),
              water_colour = linear(148, 186, 212);

}  // namespace

unsigned make_light_texture(const SkyLight& light) {
  const Raster<float>&from = light.sky, &sun = light.sun;
  std::vector<float> both(static_cast<std::size_t>(2 * from.size().cells()));
  for (std::size_t i = 0; i < both.size() / 2; ++i) both[2 * i] = from.data()[i], both[2 * i + 1] = sun.data()[i];
  const auto width = static_cast<GLsizei>(from.width()), height = static_cast<GLsizei>(from.height());
  GLuint texture = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &texture);
  glTextureStorage2D(texture, 1, GL_RG32F, width, height);
  glTextureSubImage2D(texture, 0, 0, 0, width, height, GL_RG, GL_FLOAT, both.data());
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glTextureParameteri(texture, wrap, GL_CLAMP_TO_EDGE);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) glTextureParameteri(texture, filter, GL_LINEAR);
  return texture;
}

void set_scene_light(unsigned program, const SceneFacts& facts, const SceneOptions& options) {
  const double span = facts.ramp_high_m - facts.ramp_low_m;
  set(program, "ramp_range", facts.ramp_low_m, span > 0 ? 1 / span : 1);
  const double azimuth = options.sun_azimuth_deg * M_PI / 180, elevation = options.sun_elevation_deg * M_PI / 180;
  const double level = std::cos(elevation);
  set(program, "to_sun", Colour3{static_cast<float>(std::sin(azimuth) * level), static_cast<float>(std::cos(azimuth) * level), static_cast<float>(std::sin(elevation))});
  set(program, "slope_scale", 1 / facts.steepest_deg);
  set(program, "facing", flat_share, facing_share);
  set(program, "flat_colour", linear(options.flat_colour[0], options.flat_colour[1], options.flat_colour[2]));
  set(program, "water_colour", water_colour);
  set(program, "haze_colour", haze_colour);
  set(program, "zenith_colour", zenith_colour);
  set(program, "below_colour", below_colour);
}

GroundStyle set_ground_style(unsigned program, const GroundStyle& style, const SceneFacts& facts, bool has_drape) {
  const GroundStyle settled = settle(style, facts.high_m - facts.low_m);
  set_int(program, "coloured", static_cast<int>(settled.colour));
  set_int(program, "draped", has_drape && settled.drape);
  set(program, "contours", settled.contour_interval_m > 0 ? 1 / settled.contour_interval_m : 0);
  return settled;
}

void set_highlights(unsigned program, Highlights highlights) { set_int(program, "rolls_off", highlights == Highlights::roll_off); }

std::array<double, 2> distances(const Box& box, const Point3& eye) {
  double nearest = 0, farthest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double below = box.low[c] - eye[c], above = eye[c] - box.high[c];
    nearest += std::pow(std::max({0.0, below, above}), 2);
    farthest += std::pow(std::max(std::abs(below), std::abs(above)), 2);
  }
  return {std::sqrt(nearest), std::sqrt(farthest)};
}

double near_of(const Box& box, const Point3& eye) {
  const auto [nearest, farthest] = distances(box, eye);
  return std::max(0.1 * nearest, 1e-6 * farthest);
}

void set_haze(unsigned program, const Box& box, const Point3& eye, double haze) {
  const auto [nearest, farthest] = distances(box, eye);
  set(program, "haze", -std::log(1 - std::clamp(haze, 0.0, 0.99)) / (farthest - nearest));
  set(program, "haze_from", nearest);
}

}  // namespace arete
