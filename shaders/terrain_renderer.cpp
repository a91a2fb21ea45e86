#include "shaders/terrain_renderer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include <epoxy/gl.h>

#include "core/support/error.h"
#include "core/support/parallel.h"
#include "core/support/random.h"
#include "shaders/gl_context.h"
#include "shaders/gl_program.h"
#include "shaders/ground_textures.h"
#include "shaders/srgb.h"
#include "shaders/tile_cache.h"

namespace arete {
namespace {

constexpr std::int64_t largest_picture = 16384;
// Parts that are drawn at once, in pixels of the canvas, and regions of them, in pixels of the picture.
constexpr std::int64_t largest_part = 1280, smallest_region = 32;
// All alike.
constexpr GLsizei patch_vertices = 4;

using Colour3 = std::array<float, 3>;

float to_linear(double v) { return static_cast<float>(srgb_to_linear(v)); }
Colour3 linear(int r, int g, int b) { return {to_linear(r / 255.0), to_linear(g / 255.0), to_linear(b / 255.0)}; }

const Colour3 haze_colour = linear(222, 231, 240), zenith_colour = linear(104, 150, 202), below_colour = linear(247, 246, 243),
              water_colour = linear(148, 186, 212);

/// What the vertex stage reads of a patch.
struct PatchVertex {
  std::int32_t x, y, level, layer;
  std::int32_t outer[4];
  std::int32_t inner[2], side, number;
};

constexpr GLuint line_mark = 0x80000000u;

constexpr int samples_per_pixel = 4;

/// What is seen at each sample of a picture: the number of a patch, and how far away. And a picture to colour.
class Canvas {
 public:
  Canvas(std::int64_t width, std::int64_t height) : size_{width, height} {
    const auto w = static_cast<GLsizei>(width), h = static_cast<GLsizei>(height);
    glCreateTextures(GL_TEXTURE_2D_MULTISAMPLE, 2, seen_);
    glCreateRenderbuffers(1, &picture_);
    glCreateFramebuffers(2, frames_);
    glTextureStorage2DMultisample(seen_[0], samples_per_pixel, GL_R32UI, w, h, GL_TRUE);
    glTextureStorage2DMultisample(seen_[1], samples_per_pixel, GL_DEPTH_COMPONENT32F, w, h, GL_TRUE);
    glNamedRenderbufferStorage(picture_, GL_RGBA16F, w, h);
    glNamedFramebufferTexture(frames_[0], GL_COLOR_ATTACHMENT0, seen_[0], 0);
    glNamedFramebufferTexture(frames_[0], GL_DEPTH_ATTACHMENT, seen_[1], 0);
    glNamedFramebufferRenderbuffer(frames_[1], GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, picture_);
    for (const GLuint frame : frames_)
      if (glCheckNamedFramebufferStatus(frame, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw Error(ErrorKind::format, "the OpenGL driver cannot draw to integers with a depth of 32 bits and four samples, or to half floats");
    glBindFramebuffer(GL_FRAMEBUFFER, frames_[0]);
    for (int i = 0; i < samples_per_pixel; ++i) {
      GLfloat at[2];
      glGetMultisamplefv(GL_SAMPLE_POSITION, static_cast<GLuint>(i), at);
      offsets_x_[i] = at[0] - 0.5f;
      offsets_y_[i] = at[1] - 0.5f;
    }
  }
  ~Canvas() {
    glDeleteFramebuffers(2, frames_);
    glDeleteTextures(2, seen_);
    glDeleteRenderbuffers(1, &picture_);
  }
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  Size size() const { return size_; }
  /// Nothing is seen any more within the scissors.
  void clear() const {
    const GLuint nothing[4] = {};
    const GLfloat far = 0;
    glDepthMask(GL_TRUE);
    glClearNamedFramebufferuiv(frames_[0], GL_COLOR, 0, nothing);
    glClearNamedFramebufferfv(frames_[0], GL_DEPTH, 0, &far);
  }
  void begin_surfaces(std::int64_t width, std::int64_t height) const { begin(frames_[0], width, height); }
  void begin_colours(std::int64_t width, std::int64_t height) const {
    begin(frames_[1], width, height);
    glBindTextureUnit(0, seen_[0]);
    glBindTextureUnit(1, seen_[1]);
  }
  /// Of each sample from the middle of its pixel.
  const GLfloat* offsets_x() const { return offsets_x_; }
  const GLfloat* offsets_y() const { return offsets_y_; }
  /// Linear RGBA in half floats, row 0 at the bottom.
  void read(std::int64_t width, std::int64_t height, std::vector<std::uint16_t>& pixels) const {
    pixels.resize(static_cast<std::size_t>(width * height * 4));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, frames_[1]);
    glReadPixels(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height), GL_RGBA, GL_HALF_FLOAT, pixels.data());
  }

 private:
  static void begin(GLuint frame, std::int64_t width, std::int64_t height) {
    glBindFramebuffer(GL_FRAMEBUFFER, frame);
    glViewport(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  }

  Size size_;
  GLuint seen_[2]{}, picture_ = 0, frames_[2]{};
  GLfloat offsets_x_[samples_per_pixel]{}, offsets_y_[samples_per_pixel]{};
};

/// IEEE 754 binary16, finite values.
float from_half(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31, fraction = bits & 1023;
  const double size = exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  return static_cast<float>(bits >> 15 ? -size : size);
}

template <typename Function>
std::vector<float> tabulate(const Function& f) {
  std::vector<float> table(65536);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = f(static_cast<std::uint16_t>(i));
  return table;
}

float srgb_of(double linear) { return static_cast<float>(255 * linear_to_srgb(std::clamp(linear, 0.0, 1.0))); }

/// Averages pixels of linear light and writes them as sRGB of 8 bits, with noise of one step against banding.
void develop(const std::vector<std::uint16_t>& pixels, std::int64_t rows, int supersampling, const PicturePart& part, int threads, Frame& frame) {
  static const std::vector<float> linear = tabulate(from_half), direct = tabulate([](std::uint16_t bits) { return srgb_of(static_cast<double>(from_half(bits))); });
  const std::int64_t stride = part.width * supersampling;
  const double share = 1.0 / (supersampling * supersampling);
  parallel_for(part.height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < part.width; ++x) {
      const std::uint16_t* from = &pixels[static_cast<std::size_t>(((rows - 1 - y * supersampling) * stride + x * supersampling) * 4)];
      float exact[3], covered = linear[from[3]];
      if (supersampling == 1) {
        for (std::size_t c = 0; c < 3; ++c) exact[c] = direct[from[c]];
      } else {
        double sum[4] = {};
        for (std::int64_t v = 0; v < supersampling; ++v, from -= stride * 4)
          for (std::int64_t u = 0; u < 4 * supersampling; ++u) sum[u % 4] += static_cast<double>(linear[from[u]]);
        for (std::size_t c = 0; c < 3; ++c) exact[c] = srgb_of(sum[c] * share);
        covered = static_cast<float>(sum[3] * share);
      }
      std::uint64_t noise = hash_position(11, static_cast<std::uint64_t>(part.x + x), static_cast<std::uint64_t>(part.y + y));
      std::uint8_t* out = &frame.rgba[static_cast<std::size_t>(((part.y + y) * frame.size.width + part.x + x) * 4)];
      // Whole + 1 where the noise is less than the rest.
      for (std::size_t c = 0; c < 3; ++c, noise >>= 21)
        out[c] = static_cast<std::uint8_t>(std::min(255, static_cast<int>(exact[c] + static_cast<float>(0x1fffff - (noise & 0x1fffff)) * 0x1p-21f)));
      out[3] = static_cast<std::uint8_t>(255 * std::clamp(covered, 0.0f, 1.0f) + 0.5f);
    }
  });
}

/// A few at a time: Mesa 22.3 in software takes the levels and values of one patch for another in longer calls, and of one vertex.
void draw_patches(GLsizei first, GLsizei count) {
  constexpr GLsizei at_once = 8;
  for (GLsizei i = 0; i < count; i += at_once) glDrawArrays(GL_PATCHES, (first + i) * patch_vertices, std::min(at_once, count - i) * patch_vertices);
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
    whole = link_program({"terrain.vert", "terrain.tesc", "terrain.tese", "whole.frag"});
    holed = link_program({"terrain.vert", "terrain.tesc", "terrain.tese", "holed.frag"});
    capture = link_program({"terrain.vert", "terrain.tesc", "terrain.tese"}, {"sample_height"});
    surface = link_program({"screen.vert", "surface.frag"});
    make_light();
    ramp = make_ramp_texture(options);
    if (options.drape) drape = make_drape_texture(*options.drape, surface, options.threads);
    options.drape.reset();
    make_patches();
    set_ground();
    set_colours();
    set_style(options.style);
  }
  ~Impl() {
    context.make_current();
    for (const GLuint program : {whole, holed, capture, surface}) glDeleteProgram(program);
    const GLuint textures[] = {light, ramp, drape};
    glDeleteTextures(3, textures);
    glDeleteBuffers(1, &patch_buffer);
    glDeleteBuffers(1, &tile_buffer);
    glDeleteVertexArrays(2, arrays);
    tiles.reset();
    canvas.reset();
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

  void make_patches() {
    glCreateBuffers(1, &patch_buffer);
    glCreateBuffers(1, &tile_buffer);
    glCreateVertexArrays(2, arrays);  // patches; nothing
    glVertexArrayVertexBuffer(arrays[0], 0, patch_buffer, 0, sizeof(PatchVertex));
    for (GLuint i = 0; i < 3; ++i) {
      glEnableVertexArrayAttrib(arrays[0], i);
      glVertexArrayAttribIFormat(arrays[0], i, 4, GL_INT, i * 16);
      glVertexArrayAttribBinding(arrays[0], i, 0);
    }
  }

  void set_ground() const {
    const TerrainPlacement& at = scene->placement;
    for (const GLuint program : {whole, holed, capture, surface}) {
      set_int(program, "heights", 0);
      set_int(program, "last", scene->tree.size.width - 1, scene->tree.size.height - 1);
      set(program, "cell", at.cell.x_m, at.cell.y_m);
      set(program, "exaggeration", at.exaggeration);
      set(program, "base", at.base);
    }
  }

  void set_colours() const {
    const char* const units[] = {"seen", "depths", "shapes", "light", "ramps", "drape"};
    for (int i = 0; i < 6; ++i) set_int(surface, units[i], i);
    const Overview& overview = scene->overview;
    const std::int64_t columns = overview.across * overview.cells.width(), rows = overview.down * overview.cells.height();
    set(surface, "light_scale", 1 / static_cast<double>(columns), 1 / static_cast<double>(rows));
    const double span = scene->facts.ramp_high_m - scene->facts.ramp_low_m;
    set(surface, "ramp_range", scene->facts.ramp_low_m, span > 0 ? 1 / span : 1);
    const double azimuth = options.sun_azimuth_deg * M_PI / 180, elevation = options.sun_elevation_deg * M_PI / 180;
    const double level = std::cos(elevation);
    set(surface, "to_sun", Colour3{static_cast<float>(std::sin(azimuth) * level), static_cast<float>(std::cos(azimuth) * level), static_cast<float>(std::sin(elevation))});
    set(surface, "water_colour", water_colour);
    set(surface, "slope_scale", 1 / scene->facts.steepest_deg);
    set(surface, "facing", flat_share, facing_share);
    set(surface, "flat_colour", linear(options.flat_colour[0], options.flat_colour[1], options.flat_colour[2]));
    set(surface, "haze_colour", haze_colour);
    set(surface, "zenith_colour", zenith_colour);
    set(surface, "below_colour", below_colour);
  }

  void set_style(const GroundStyle& style) {
    options.style = settle(style, scene->facts.high_m - scene->facts.low_m);
    set_int(surface, "coloured", static_cast<int>(style.colour));
    set_int(surface, "draped", drape != 0 && style.drape);
    set(surface, "contours", options.style.contour_interval_m > 0 ? 1 / options.style.contour_interval_m : 0);
  }

  Box box() const {
    const TerrainPatch all{0, 0, static_cast<std::int32_t>(scene->tree.levels.size()) - 1, {}, {}, 0};
    return patch_box(scene->tree, scene->placement, all);
  }

  void set_camera(const Camera& camera, DrawMode mode) const {
    const CellSize cell = scene->placement.cell;
    const double column = camera.eye[0] / cell.x_m, row = -camera.eye[1] / cell.y_m;
    for (const GLuint program : {whole, holed, capture, surface}) {
      set_int(program, "eye_sample", std::llround(std::floor(column)), std::llround(std::floor(row)));
      set(program, "eye_part", column - std::floor(column), row - std::floor(row));
      set(program, "eye_height", camera.eye[2]);
    }
    const auto [nearest, farthest] = distances(box(), camera.eye);
    set(surface, "haze", -std::log(1 - std::clamp(options.haze, 0.0, 0.99)) / (farthest - nearest));
    set(surface, "haze_from", nearest);
    set_int(surface, "mode", mode == DrawMode::coverage ? 2 : mode == DrawMode::levels ? 1 : 0);
  }

  /// The one of the frame before where it has this size: memory that was touched already.
  const Canvas& canvas_of(Size size) {
    if (!canvas || canvas->size() != size) {
      canvas.reset();
      canvas = std::make_unique<Canvas>(size.width, size.height);
    }
    return *canvas;
  }

  void load_vertices(std::span<const TerrainPatch> patches, const std::vector<TileCache::Place>& places, std::span<const std::size_t> order) {
    std::vector<PatchVertex> vertices;
    vertices.reserve(order.size() * patch_vertices);
    for (const std::size_t i : order) {
      const TerrainPatch& p = patches[i];
      vertices.insert(vertices.end(), patch_vertices,
                      {p.x, p.y, p.level, places[i].layer, {p.outer[0], p.outer[1], p.outer[2], p.outer[3]}, {p.inner[0], p.inner[1]}, p.side, 1 + 8 * places[i].layer + p.side});
    }
    glNamedBufferData(patch_buffer, static_cast<GLsizeiptr>(vertices.size() * sizeof(PatchVertex)), vertices.data(), GL_STREAM_DRAW);
    glPatchParameteri(GL_PATCH_VERTICES, patch_vertices);
    glBindVertexArray(arrays[0]);
    glBindTextureUnit(0, tiles->heights());
  }

  /// Which patches are seen where.
  void draw_surfaces(std::span<const TerrainPatch> patches, const std::vector<TileCache::Place>& places, DrawMode mode) {
    std::vector<std::size_t> order;
    for (const bool with_voids : {false, true})
      for (std::size_t i = 0; i < patches.size(); ++i)
        if ((places[i].holed && patches[i].side != 5) == with_voids) order.push_back(i);
    const auto without = std::count_if(order.begin(), order.end(), [&](std::size_t i) { return !places[i].holed || patches[i].side == 5; });
    load_vertices(patches, places, order);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    const auto draw_all = [&](GLuint marks) {
      for (const GLuint program : {whole, holed}) {
        glProgramUniform1ui(program, glGetUniformLocation(program, "marks"), marks);
        glUseProgram(program);
        if (program == whole) draw_patches(0, static_cast<GLsizei>(without));
        else draw_patches(static_cast<GLsizei>(without), static_cast<GLsizei>(order.size()) - static_cast<GLsizei>(without));
      }
    };
    if (mode != DrawMode::wireframe) return draw_all(0);
    // The faces a little behind their sides.
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(-1, -1);
    draw_all(0);
    glDisable(GL_POLYGON_OFFSET_FILL);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    draw_all(line_mark);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  }

  void colour() {
    const std::vector<std::array<std::int32_t, 4>> table = tiles->table();
    glNamedBufferData(tile_buffer, static_cast<GLsizeiptr>(table.size() * sizeof table[0]), table.data(), GL_STREAM_DRAW);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, tile_buffer);
    glBindTextureUnit(2, tiles->shapes());
    glBindTextureUnit(3, light);
    glBindTextureUnit(4, ramp);
    glBindTextureUnit(5, drape);
    glDisable(GL_DEPTH_TEST);
    glUseProgram(surface);
    glBindVertexArray(arrays[1]);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }

  void draw_part(std::span<const TerrainPatch> patches, const Camera& camera, Size picture, const PicturePart& part, int supersampling, DrawMode mode,
                 const Canvas& to) {
    const std::int64_t width = part.width * supersampling, height = part.height * supersampling;
    const double near = std::max(0.1 * distances(box(), camera.eye)[0], 1e-6 * distances(box(), camera.eye)[1]);
    const auto projection = projection_matrix(camera, picture, part, near);
    for (const GLuint program : {whole, holed}) set(program, "projection", projection);
    set(surface, "to_ray", ray_matrix(camera, picture, part));
    set(surface, "near", near);
    set(surface, "pixel", 2 / static_cast<double>(width), 2 / static_cast<double>(height));
    glProgramUniform4fv(surface, glGetUniformLocation(surface, "offsets_x"), 1, to.offsets_x());
    glProgramUniform4fv(surface, glGetUniformLocation(surface, "offsets_y"), 1, to.offsets_y());
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_SCISSOR_TEST);
    // In pixels of the canvas, `more` around the region.
    const auto cut = [&](const PicturePart& region, std::int64_t more) {
      glScissor(static_cast<GLint>((region.x - part.x) * supersampling - more), static_cast<GLint>((part.y + part.height - region.y - region.height) * supersampling - more),
                static_cast<GLsizei>(region.width * supersampling + 2 * more), static_cast<GLsizei>(region.height * supersampling + 2 * more));
    };

    // Regions of the part, each with patches whose tiles fit on the GPU together.
    std::vector<PicturePart> regions = {part};
    while (!regions.empty()) {
      const PicturePart region = regions.back();
      regions.pop_back();
      // With the pixels around it: Mesa 22.3 in software drops samples of the pixels at the edges of the scissors.
      const auto view = projection_matrix(camera, picture, {region.x - 1, region.y - 1, region.width + 2, region.height + 2}, near);
      std::vector<TerrainPatch> seen;
      for (const TerrainPatch& patch : patches)
        if (sees(view, camera, patch_box(scene->tree, scene->placement, patch))) seen.push_back(patch);
      while (!tiles->holds(seen) && std::max(region.width, region.height) <= smallest_region) tiles->grow();
      if (!tiles->holds(seen)) {
        const bool wide = region.width >= region.height;
        const std::int64_t half = (wide ? region.width : region.height) / 2;
        regions.push_back(wide ? PicturePart{region.x + half, region.y, region.width - half, region.height}
                               : PicturePart{region.x, region.y + half, region.width, region.height - half});
        regions.push_back({region.x, region.y, wide ? half : region.width, wide ? region.height : half});
        continue;
      }
      std::vector<TileCache::Place> places;
      tiles->load(seen, places);
      cut(region, 1);
      to.begin_surfaces(width, height);
      to.clear();
      draw_surfaces(seen, places, mode);
      cut(region, 0);
      to.begin_colours(width, height);
      colour();
    }
    glDisable(GL_SCISSOR_TEST);
  }

  SceneOptions options;
  GlContext context;  // first, so that a missing driver is told before the terrain is read
  std::unique_ptr<TerrainScene> scene;
  std::unique_ptr<TileCache> tiles;
  std::unique_ptr<Canvas> canvas;
  GLuint whole = 0, holed = 0, capture = 0, surface = 0, light = 0, ramp = 0, drape = 0, patch_buffer = 0, tile_buffer = 0;
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
  impl_->set_ground();
  impl_->set_colours();
}

void TerrainRenderer::restyle(const GroundStyle& style) {
  impl_->context.make_current();
  impl_->set_style(style);
}

const GroundStyle& TerrainRenderer::style() const { return impl_->options.style; }

std::string TerrainRenderer::driver() const { return impl_->context.description(); }

std::vector<TerrainPatch> TerrainRenderer::select(const Camera& camera, Size picture) const {
  return select_patches(impl_->scene->tree, impl_->scene->placement, camera, picture, impl_->options.detail);
}

Frame TerrainRenderer::draw(const Camera& camera, Size picture, DrawMode mode) { return draw(select(camera, picture), camera, picture, mode); }

Frame TerrainRenderer::draw(const std::vector<TerrainPatch>& patches, const Camera& camera, Size picture, DrawMode mode) {
  if (picture.width < 1 || picture.height < 1 || picture.width > largest_picture || picture.height > largest_picture)
    throw Error(ErrorKind::usage, "cannot draw a picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                                      " pixels: sides are 1 to " + std::to_string(largest_picture));
  impl_->context.make_current();
  const std::int64_t before = impl_->tiles->loaded();
  Frame frame{picture, std::vector<std::uint8_t>(static_cast<std::size_t>(picture.cells() * 4)), static_cast<std::int64_t>(patches.size()), 0, 0};
  for (const TerrainPatch& patch : patches) frame.triangles += count_triangles(patch);

  const int supersampling = mode == DrawMode::coverage ? 1 : std::clamp(impl_->options.supersampling, 1, 4);
  // Parts of about the same size.
  const auto side = [&](std::int64_t length) {
    const std::int64_t count = (length * supersampling + largest_part - 1) / largest_part;
    return (length + count - 1) / count;
  };
  const std::int64_t across = side(picture.width), down = side(picture.height);
  const Canvas& canvas = impl_->canvas_of({across * supersampling, down * supersampling});
  impl_->set_camera(camera, mode);
  set(impl_->surface, "line_px", supersampling);
  std::vector<std::uint16_t> pixels;
  for (std::int64_t y = 0; y < picture.height; y += down)
    for (std::int64_t x = 0; x < picture.width; x += across) {
      const PicturePart part{x, y, std::min(across, picture.width - x), std::min(down, picture.height - y)};
      impl_->draw_part(patches, camera, picture, part, supersampling, mode, canvas);
      canvas.read(part.width * supersampling, part.height * supersampling, pixels);
      develop(pixels, part.height * supersampling, supersampling, part, impl_->options.threads, frame);
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
  const Canvas& canvas = impl_->canvas_of({16, 16});
  canvas.begin_surfaces(16, 16);
  glEnable(GL_RASTERIZER_DISCARD);
  for (std::span<const TerrainPatch> rest = patches; !rest.empty();) {
    std::vector<TileCache::Place> places;
    const std::span<const TerrainPatch> batch = rest.first(impl_->tiles->load(rest, places));
    rest = rest.subspan(batch.size());
    std::vector<std::size_t> order(batch.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    impl_->load_vertices(batch, places, order);
    std::size_t count = 0;
    for (const TerrainPatch& patch : batch) count += static_cast<std::size_t>(3 * count_triangles(patch));
    glNamedBufferData(buffer, static_cast<GLsizeiptr>(count * sizeof vertices[0]), nullptr, GL_STREAM_READ);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
    glUseProgram(impl_->capture);
    glBeginTransformFeedback(GL_TRIANGLES);
    draw_patches(0, static_cast<GLsizei>(batch.size()));
    glEndTransformFeedback();
    const std::size_t from = vertices.size();
    vertices.resize(from + count);
    glGetNamedBufferSubData(buffer, 0, static_cast<GLsizeiptr>(count * sizeof vertices[0]), &vertices[from]);
  }
  glDisable(GL_RASTERIZER_DISCARD);
  glDeleteBuffers(1, &buffer);
  return vertices;
}

}  // namespace arete
