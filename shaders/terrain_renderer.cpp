#include "shaders/terrain_renderer.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <epoxy/gl.h>

#include "core/support/error.h"
#include "core/support/parallel.h"
#include "shaders/gl_context.h"
#include "shaders/gl_program.h"
#include "shaders/tile_cache.h"

namespace arete {
namespace {

constexpr std::int64_t largest_picture = 16384;
// All alike.
constexpr GLsizei patch_vertices = 4;

using Colour3 = std::array<float, 3>;

float to_linear(double v) { return static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4)); }  // IEC 61966-2-1
Colour3 linear(int r, int g, int b) { return {to_linear(r / 255.0), to_linear(g / 255.0), to_linear(b / 255.0)}; }

const Colour3 haze_colour = linear(222, 231, 240), zenith_colour = linear(104, 150, 202), below_colour = linear(247, 246, 243),
              water_colour = linear(148, 186, 212);

/// What the vertex stage reads of a patch.
struct PatchVertex {
  std::int32_t x, y, level, layer;
  std::int32_t outer[4];
  std::int32_t inner[2], side, unused;
};

/// A framebuffer to draw to and, where it has several samples per pixel, one that they are resolved to.
class Canvas {
 public:
  Canvas(std::int64_t width, std::int64_t height, int samples) : width_(static_cast<GLsizei>(width)), height_(static_cast<GLsizei>(height)) {
    glCreateRenderbuffers(3, buffers_);
    glCreateFramebuffers(2, frames_);
    glNamedRenderbufferStorageMultisample(buffers_[0], samples, GL_RGBA16F, width_, height_);
    glNamedRenderbufferStorageMultisample(buffers_[1], samples, GL_DEPTH_COMPONENT32F, width_, height_);
    glNamedRenderbufferStorage(buffers_[2], GL_RGBA16F, width_, height_);
    glNamedFramebufferRenderbuffer(frames_[0], GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers_[0]);
    glNamedFramebufferRenderbuffer(frames_[0], GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers_[1]);
    glNamedFramebufferRenderbuffer(frames_[1], GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers_[2]);
    if (glCheckNamedFramebufferStatus(frames_[0], GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw Error(ErrorKind::format, "the OpenGL driver cannot draw to half floats with a depth of 32 bits");
  }
  ~Canvas() {
    glDeleteFramebuffers(2, frames_);
    glDeleteRenderbuffers(3, buffers_);
  }
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  void begin(std::int64_t width, std::int64_t height) const {
    glBindFramebuffer(GL_FRAMEBUFFER, frames_[0]);
    glViewport(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  }
  /// Linear RGBA, row 0 at the bottom.
  std::vector<float> read(std::int64_t width, std::int64_t height) const {
    const auto w = static_cast<GLsizei>(width), h = static_cast<GLsizei>(height);
    glBlitNamedFramebuffer(frames_[0], frames_[1], 0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    std::vector<float> pixels(static_cast<std::size_t>(width * height * 4));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, frames_[1]);
    glReadPixels(0, 0, w, h, GL_RGBA, GL_FLOAT, pixels.data());
    return pixels;
  }

 private:
  GLsizei width_, height_;
  GLuint buffers_[3]{}, frames_[2]{};
};

/// Averages pixels of a part (row 0 at the bottom) into the rows that it lies in.
void average(const std::vector<float>& pixels, int supersampling, const PicturePart& part, int threads, LightRows& rows) {
  const std::int64_t stride = part.width * supersampling, last = part.height * supersampling - 1;
  const double share = 1.0 / (supersampling * supersampling);
  parallel_for(part.height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < part.width; ++x) {
      double sum[4] = {};
      for (std::int64_t v = 0; v < supersampling; ++v)
        for (std::int64_t u = 0; u < supersampling; ++u) {
          const std::int64_t row = last - (y * supersampling + v);
          for (std::size_t c = 0; c < 4; ++c) sum[c] += static_cast<double>(pixels[static_cast<std::size_t>((row * stride + x * supersampling + u) * 4) + c]);
        }
      float* out = &rows.rgba[static_cast<std::size_t>((y * rows.size.width + part.x + x) * 4)];
      for (std::size_t c = 0; c < 4; ++c) out[c] = static_cast<float>(sum[c] * share);
    }
  });
}

/// A few at a time: Mesa 22.3 in software takes the levels and values of one patch for another in longer calls, and of one vertex.
void draw_patches(GLsizei count) {
  constexpr GLsizei at_once = 8;
  for (GLsizei i = 0; i < count; i += at_once) glDrawArrays(GL_PATCHES, i * patch_vertices, std::min(at_once, count - i) * patch_vertices);
}

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

/// Nearest and farthest distance of a box.
std::array<double, 2> distances(const Box& box, const Point3& eye) {
  double nearest = 0, farthest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double below = box.low[c] - eye[c], above = eye[c] - box.high[c];
    nearest += std::pow(std::max({0.0, below, above}), 2);
    farthest += std::pow(std::max(std::abs(below), std::abs(above)), 2);
  }
  return {std::sqrt(nearest), std::sqrt(farthest)};
}

}  // namespace

struct TerrainRenderer::Impl {
  Impl(const RasterSource& source, CellSize cell, const SceneOptions& scene_options, Progress& progress)
      : options(scene_options), scene(prepare_scene(source, cell, scene_options, progress)) {
    context.make_current();
    tiles = std::make_unique<TileCache>(*scene->pyramid, options.memory_bytes / 4, options.threads);
    terrain = link_program({"terrain.vert", "terrain.tesc", "terrain.tese", "terrain.frag"});
    capture = link_program({"terrain.vert", "terrain.tesc", "terrain.tese"}, {"sample_height"});
    sky = link_program({"sky.vert", "sky.frag"});
    make_light();
    make_ramp();
    make_patches();
    for (const GLuint program : {terrain, capture}) set_ground(program);
    set_colours();
  }
  ~Impl() {
    context.make_current();
    for (const GLuint program : {terrain, capture, sky}) glDeleteProgram(program);
    const GLuint textures[] = {light, ramp};
    glDeleteTextures(2, textures);
    glDeleteBuffers(1, &patch_buffer);
    glDeleteVertexArrays(2, arrays);
    tiles.reset();
  }

  void make_light() {
    const Raster<float>&from = scene->light.sky, &sun = scene->light.sun;
    std::vector<float> both(static_cast<std::size_t>(2 * from.size().cells()));
    for (std::size_t i = 0; i < both.size() / 2; ++i) both[2 * i] = from.data()[i], both[2 * i + 1] = sun.data()[i];
    const auto width = static_cast<GLsizei>(from.width()), height = static_cast<GLsizei>(from.height());
    glCreateTextures(GL_TEXTURE_2D, 1, &light);
    glTextureStorage2D(light, 1, GL_RG32F, width, height);
    glTextureSubImage2D(light, 0, 0, 0, width, height, GL_RG, GL_FLOAT, both.data());
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glTextureParameteri(light, wrap, GL_CLAMP_TO_EDGE);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) glTextureParameteri(light, filter, GL_LINEAR);
  }

  void make_ramp() {
    std::vector<std::array<std::uint8_t, 3>> colours = options.ramp;
    if (colours.empty()) colours = {{200, 198, 194}};
    std::vector<float> table;
    for (const auto& colour : colours)
      for (const std::uint8_t value : colour) table.push_back(to_linear(value / 255.0));
    const auto count = static_cast<GLsizei>(colours.size());
    glCreateTextures(GL_TEXTURE_1D, 1, &ramp);
    glTextureStorage1D(ramp, 1, GL_RGB32F, count);
    glTextureSubImage1D(ramp, 0, 0, count, GL_RGB, GL_FLOAT, table.data());
    glTextureParameteri(ramp, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) glTextureParameteri(ramp, filter, GL_LINEAR);
  }

  void make_patches() {
    glCreateBuffers(1, &patch_buffer);
    glCreateVertexArrays(2, arrays);  // patches; nothing
    glVertexArrayVertexBuffer(arrays[0], 0, patch_buffer, 0, sizeof(PatchVertex));
    for (GLuint i = 0; i < 3; ++i) {
      glEnableVertexArrayAttrib(arrays[0], i);
      glVertexArrayAttribIFormat(arrays[0], i, 4, GL_INT, i * 16);
      glVertexArrayAttribBinding(arrays[0], i, 0);
    }
  }

  void set_ground(GLuint program) const {
    const TerrainPlacement& at = scene->placement;
    set_int(program, "tiles", 0);
    set_int(program, "last", scene->tree.size.width - 1, scene->tree.size.height - 1);
    set(program, "cell", at.cell.x_m, at.cell.y_m);
    set(program, "exaggeration", at.exaggeration);
    set(program, "base", at.base);
  }

  void set_colours() const {
    set_int(terrain, "light", 1);
    set_int(terrain, "ramp", 2);
    const Overview& overview = scene->overview;
    const std::int64_t columns = overview.across * overview.cells.width(), rows = overview.down * overview.cells.height();
    set(terrain, "light_scale", 1 / static_cast<double>(columns), 1 / static_cast<double>(rows));
    const double span = scene->facts.ramp_high_m - scene->facts.ramp_low_m;
    set(terrain, "ramp_range", scene->facts.ramp_low_m, span > 0 ? 1 / span : 1);
    const double azimuth = options.sun_azimuth_deg * M_PI / 180, elevation = options.sun_elevation_deg * M_PI / 180;
    const double level = std::cos(elevation);
    set(terrain, "to_sun", Colour3{static_cast<float>(std::sin(azimuth) * level), static_cast<float>(std::cos(azimuth) * level), static_cast<float>(std::sin(elevation))});
    set(terrain, "water_colour", water_colour);
    for (const GLuint program : {terrain, sky}) set(program, "haze_colour", haze_colour);
    set(sky, "zenith_colour", zenith_colour);
    set(sky, "below_colour", below_colour);
  }

  Box box() const {
    const TerrainPatch all{0, 0, static_cast<std::int32_t>(scene->tree.levels.size()) - 1, {}, {}, 0};
    return patch_box(scene->tree, scene->placement, all);
  }

  void set_camera(const Camera& camera, DrawMode mode) const {
    const CellSize cell = scene->placement.cell;
    const double column = camera.eye[0] / cell.x_m, row = -camera.eye[1] / cell.y_m;
    set_int(terrain, "eye_sample", std::llround(std::floor(column)), std::llround(std::floor(row)));
    set(terrain, "eye_part", column - std::floor(column), row - std::floor(row));
    set(terrain, "eye_height", camera.eye[2]);
    const auto [nearest, farthest] = distances(box(), camera.eye);
    set(terrain, "haze", -std::log(1 - std::clamp(options.haze, 0.0, 0.99)) / (farthest - nearest));
    set(terrain, "haze_from", nearest);
    set_int(terrain, "mode", mode == DrawMode::coverage ? 2 : mode == DrawMode::levels ? 1 : 0);
    set_int(sky, "mode", mode == DrawMode::coverage ? 2 : 0);
  }

  /// Draws patches, as many at a time as have their tiles on the GPU.
  template <typename Draw>
  void in_batches(std::span<const TerrainPatch> patches, const Draw& draw) {
    std::vector<std::int32_t> layers;
    std::vector<PatchVertex> vertices;
    glPatchParameteri(GL_PATCH_VERTICES, patch_vertices);
    glBindTextureUnit(0, tiles->texture());
    glBindTextureUnit(1, light);
    glBindTextureUnit(2, ramp);
    while (!patches.empty()) {
      const std::size_t count = tiles->load(patches, layers);
      vertices.clear();
      for (std::size_t i = 0; i < count; ++i) {
        const TerrainPatch& p = patches[i];
        vertices.insert(vertices.end(), patch_vertices,
                        {p.x, p.y, p.level, layers[i], {p.outer[0], p.outer[1], p.outer[2], p.outer[3]}, {p.inner[0], p.inner[1]}, p.side, 0});
      }
      glNamedBufferData(patch_buffer, static_cast<GLsizeiptr>(vertices.size() * sizeof(PatchVertex)), vertices.data(), GL_STREAM_DRAW);
      glBindVertexArray(arrays[0]);
      draw(patches.first(count));
      patches = patches.subspan(count);
    }
  }

  void draw_part(std::span<const TerrainPatch> patches, const Camera& camera, Size picture, const PicturePart& part, DrawMode mode) {
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glClearDepth(0);
    glDepthMask(GL_TRUE);
    glClear(GL_DEPTH_BUFFER_BIT);
    glDisable(GL_DEPTH_TEST);
    set(sky, "to_ray", ray_matrix(camera, picture, part));
    glUseProgram(sky);
    glBindVertexArray(arrays[1]);
    glDrawArrays(GL_TRIANGLES, 0, 3);

    const double diagonal = distances(box(), camera.eye)[1];
    const auto projection = projection_matrix(camera, picture, part, std::max(0.1 * distances(box(), camera.eye)[0], 1e-6 * diagonal));
    std::vector<TerrainPatch> seen;
    for (const TerrainPatch& patch : patches)
      if (sees(projection, camera, patch_box(scene->tree, scene->placement, patch))) seen.push_back(patch);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    set(terrain, "projection", projection);
    glUseProgram(terrain);
    in_batches(seen, [&](std::span<const TerrainPatch> batch) {
      const auto count = static_cast<GLsizei>(batch.size());
      if (mode != DrawMode::wireframe) return draw_patches(count);
      // The faces a little behind their sides.
      glEnable(GL_POLYGON_OFFSET_FILL);
      glPolygonOffset(-1, -1);
      draw_patches(count);
      glDisable(GL_POLYGON_OFFSET_FILL);
      glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
      set_int(terrain, "mode", 3);
      draw_patches(count);
      set_int(terrain, "mode", 0);
      glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    });
  }

  SceneOptions options;
  GlContext context;  // first, so that a missing driver is told before the terrain is read
  std::unique_ptr<TerrainScene> scene;
  std::unique_ptr<TileCache> tiles;
  GLuint terrain = 0, capture = 0, sky = 0, light = 0, ramp = 0, patch_buffer = 0;
  GLuint arrays[2]{};
};

TerrainRenderer::TerrainRenderer(const RasterSource& source, CellSize cell, const SceneOptions& options, Progress& progress)
    : impl_(std::make_unique<Impl>(source, cell, options, progress)) {}
TerrainRenderer::~TerrainRenderer() = default;

const SceneFacts& TerrainRenderer::facts() const { return impl_->scene->facts; }
Box TerrainRenderer::box() const { return impl_->box(); }

double TerrainRenderer::ground_height(double x_m, double y_m) const {
  const TerrainScene& scene = *impl_->scene;
  const Overview& overview = scene.overview;
  const auto block = [](double metres, double cell_m, std::int64_t cells, std::int64_t count) {
    return std::clamp(static_cast<std::int64_t>(std::floor((metres / cell_m + 0.5) / static_cast<double>(cells))), std::int64_t{0}, count - 1);
  };
  const std::int64_t x = block(x_m, scene.placement.cell.x_m, overview.across, overview.cells.width());
  const std::int64_t y = block(-y_m, scene.placement.cell.y_m, overview.down, overview.cells.height());
  return static_cast<double>(overview.cells(x, y)) * scene.placement.exaggeration;
}

void TerrainRenderer::relight(double exaggeration, double sun_azimuth_deg, double sun_elevation_deg) {
  impl_->context.make_current();
  impl_->options.sun_azimuth_deg = sun_azimuth_deg;
  impl_->options.sun_elevation_deg = sun_elevation_deg;
  light_scene(*impl_->scene, exaggeration, sun_azimuth_deg, sun_elevation_deg, impl_->options.threads);
  glDeleteTextures(1, &impl_->light);
  impl_->make_light();
  for (const GLuint program : {impl_->terrain, impl_->capture}) impl_->set_ground(program);
  impl_->set_colours();
}

std::string TerrainRenderer::driver() const { return impl_->context.description(); }

std::vector<TerrainPatch> TerrainRenderer::select(const Camera& camera, Size picture) const {
  return select_patches(impl_->scene->tree, impl_->scene->placement, camera, picture, impl_->options.detail);
}

Frame TerrainRenderer::draw(const Camera& camera, Size picture, DrawMode mode) { return draw(select(camera, picture), camera, picture, mode); }

Frame TerrainRenderer::draw(const std::vector<TerrainPatch>& patches, const Camera& camera, Size picture, DrawMode mode) {
  std::vector<std::uint8_t> rgba;
  Frame frame = draw_rows(patches, camera, picture, mode, Highlights::roll_off, [&](const LightRows& rows) {
    rgba.resize(static_cast<std::size_t>(picture.cells() * 4));
    develop(rows, impl_->options.threads, &rgba[static_cast<std::size_t>(rows.y * picture.width * 4)]);
  });
  frame.rgba = std::move(rgba);
  return frame;
}

Frame TerrainRenderer::draw_rows(const Camera& camera, Size picture, DrawMode mode, Highlights highlights, const std::function<void(const LightRows&)>& take) {
  return draw_rows(select(camera, picture), camera, picture, mode, highlights, take);
}

Frame TerrainRenderer::draw_rows(const std::vector<TerrainPatch>& patches, const Camera& camera, Size picture, DrawMode mode, Highlights highlights,
                                 const std::function<void(const LightRows&)>& take) {
  if (picture.width < 1 || picture.height < 1 || picture.width > largest_picture || picture.height > largest_picture)
    throw Error(ErrorKind::usage, "cannot draw a picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                                      " pixels: sides are 1 to " + std::to_string(largest_picture));
  impl_->context.make_current();
  const std::int64_t before = impl_->tiles->loaded();
  Frame frame{picture, {}, static_cast<std::int64_t>(patches.size()), 0, 0};
  for (const TerrainPatch& patch : patches) frame.triangles += count_triangles(patch);

  const bool coverage = mode == DrawMode::coverage;
  const int supersampling = coverage ? 1 : std::clamp(impl_->options.supersampling, 1, 4);
  const std::int64_t side = 1024 / supersampling;
  const Canvas canvas(std::min(side, picture.width) * supersampling, std::min(side, picture.height) * supersampling, coverage ? 0 : 4);
  impl_->set_camera(camera, mode);
  set_int(impl_->terrain, "rolls_off", highlights == Highlights::roll_off);
  LightRows rows;
  for (std::int64_t y = 0; y < picture.height; y += side) {
    rows.y = y;
    rows.size = {picture.width, std::min(side, picture.height - y)};
    rows.rgba.resize(static_cast<std::size_t>(rows.size.cells() * 4));
    for (std::int64_t x = 0; x < picture.width; x += side) {
      const PicturePart part{x, y, std::min(side, picture.width - x), rows.size.height};
      const std::int64_t width = part.width * supersampling, height = part.height * supersampling;
      canvas.begin(width, height);
      impl_->draw_part(patches, camera, picture, part, mode);
      average(canvas.read(width, height), supersampling, part, impl_->options.threads, rows);
    }
    take(rows);
  }
  frame.tiles_loaded = impl_->tiles->loaded() - before;
  return frame;
}

std::vector<std::array<float, 3>> TerrainRenderer::evaluate(const std::vector<TerrainPatch>& patches) {
  impl_->context.make_current();
  std::vector<std::array<float, 3>> vertices;
  GLuint buffer = 0;
  glCreateBuffers(1, &buffer);
  // Nothing is drawn, but there must be something to draw to.
  const Canvas canvas(16, 16, 0);
  canvas.begin(16, 16);
  glUseProgram(impl_->capture);
  glEnable(GL_RASTERIZER_DISCARD);
  impl_->in_batches(patches, [&](std::span<const TerrainPatch> batch) {
    std::size_t count = 0;
    for (const TerrainPatch& patch : batch) count += static_cast<std::size_t>(3 * count_triangles(patch));
    glNamedBufferData(buffer, static_cast<GLsizeiptr>(count * sizeof vertices[0]), nullptr, GL_STREAM_READ);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
    glBeginTransformFeedback(GL_TRIANGLES);
    draw_patches(static_cast<GLsizei>(batch.size()));
    glEndTransformFeedback();
    const std::size_t from = vertices.size();
    vertices.resize(from + count);
    glGetNamedBufferSubData(buffer, 0, static_cast<GLsizeiptr>(count * sizeof vertices[0]), &vertices[from]);
  });
  glDisable(GL_RASTERIZER_DISCARD);
  glDeleteBuffers(1, &buffer);
  return vertices;
}

}  // namespace arete
