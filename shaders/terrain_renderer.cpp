#include "shaders/terrain_renderer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include <epoxy/gl.h>

#include "core/support/error.h"
#include "shaders/canvas.h"
#include "shaders/gl_context.h"
#include "shaders/gl_program.h"
#include "shaders/gl_uniforms.h"
#include "shaders/ground_textures.h"
#include "shaders/scene_light.h"
#include "shaders/tile_cache.h"

namespace arete {
namespace {

// Regions of a part that are drawn at once, in pixels of the picture.
constexpr std::int64_t smallest_region = 32;
// All alike.
constexpr GLsizei patch_vertices = 4;
constexpr GLuint line_mark = 0x80000000u;

/// What the vertex stage reads of a patch.
struct PatchVertex {
  std::int32_t x, y, level, layer;
  std::int32_t outer[4];
  std::int32_t inner, side, number, above;
};

/// A few at a time: Mesa 22.3 in software takes the levels and values of one patch for another in longer calls, and of one vertex.
void draw_patches(GLsizei first, GLsizei count) {
  constexpr GLsizei at_once = 8;
  for (GLsizei i = 0; i < count; i += at_once) glDrawArrays(GL_PATCHES, (first + i) * patch_vertices, std::min(at_once, count - i) * patch_vertices);
}

std::vector<std::size_t> numbers_to(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  return numbers;
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
    plain_surface = link_program({"screen.vert", "surface.frag"}, {}, "PLAIN");
    light = make_light_texture(scene->light);
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
    for (const GLuint program : {whole, holed, capture, surface, plain_surface}) glDeleteProgram(program);
    const GLuint textures[] = {light, ramp, drape};
    glDeleteTextures(3, textures);
    glDeleteBuffers(1, &patch_buffer);
    glDeleteBuffers(1, &tile_buffer);
    glDeleteVertexArrays(2, arrays);
    tiles.reset();
    canvas.reset();
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
    for (const GLuint program : {whole, holed, capture, surface, plain_surface}) {
      set_int(program, "heights", 0);
      set_int(program, "last", scene->tree.size.width - 1, scene->tree.size.height - 1);
      set(program, "cell", at.cell.x_m, at.cell.y_m);
      set(program, "exaggeration", at.exaggeration);
      set(program, "base", at.base);
    }
  }

  void set_colours() const {
    const char* const units[] = {"seen", "depths", "shapes", "light", "ramps", "drape"};
    const Overview& overview = scene->overview;
    const std::int64_t columns = overview.across * overview.cells.width(), rows = overview.down * overview.cells.height();
    for (const GLuint program : {surface, plain_surface}) {
      for (int i = 0; i < 6; ++i) set_int(program, units[i], i);
      set(program, "light_scale", 1 / static_cast<double>(columns), 1 / static_cast<double>(rows));
      set_scene_light(program, scene->facts, options);
    }
  }

  void set_style(const GroundStyle& style) { options.style = set_ground_style(surface, style, scene->facts, drape != 0); }

  Box box() const {
    const TerrainPatch all{0, 0, static_cast<std::int32_t>(scene->tree.levels.size()) - 1, {}, {}, 0};
    return patch_box(scene->tree, scene->placement, all);
  }

  void set_camera(const Camera& camera, DrawMode mode) const {
    const CellSize cell = scene->placement.cell;
    const double column = camera.eye[0] / cell.x_m, row = -camera.eye[1] / cell.y_m;
    for (const GLuint program : {whole, holed, capture, surface, plain_surface}) {
      set_int(program, "eye_sample", std::llround(std::floor(column)), std::llround(std::floor(row)));
      set(program, "eye_part", column - std::floor(column), row - std::floor(row));
      set(program, "eye_height", camera.eye[2]);
    }
    for (const GLuint program : {surface, plain_surface}) {
      set_haze(program, box(), camera.eye, options.haze);
      set_int(program, "mode", mode == DrawMode::coverage ? 2 : mode == DrawMode::levels ? 1 : 0);
    }
  }

  void load_vertices(std::span<const TerrainPatch> patches, const std::vector<TileCache::Place>& places, std::span<const std::size_t> order) {
    std::vector<PatchVertex> vertices;
    vertices.reserve(order.size() * patch_vertices);
    for (const std::size_t i : order) {
      const TerrainPatch& p = patches[i];
      vertices.insert(vertices.end(), patch_vertices,
                      {p.x, p.y, p.level, places[i].layer, {p.outer[0], p.outer[1], p.outer[2], p.outer[3]}, p.inner[0] | p.inner[1] << 8, p.side | p.from_above << 8,
                       1 + 8 * places[i].layer + p.side, places[i].above});
    }
    glNamedBufferData(patch_buffer, static_cast<GLsizeiptr>(vertices.size() * sizeof(PatchVertex)), vertices.data(), GL_STREAM_DRAW);
    glPatchParameteri(GL_PATCH_VERTICES, patch_vertices);
    glBindVertexArray(arrays[0]);
    glBindTextureUnit(0, tiles->heights());
  }

  /// Which patches are seen where.
  void draw_surfaces(std::span<const TerrainPatch> patches, const std::vector<TileCache::Place>& places, DrawMode mode) {
    // The floor is seen through voids.
    const auto is_whole = [&](std::size_t i) { return !places[i].holed || patches[i].side == 5; };
    std::vector<std::size_t> order = numbers_to(patches.size());
    const auto without = static_cast<GLsizei>(std::stable_partition(order.begin(), order.end(), is_whole) - order.begin());
    load_vertices(patches, places, order);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    const auto draw_all = [&](GLuint marks) {
      for (const GLuint program : {whole, holed}) {
        glProgramUniform1ui(program, glGetUniformLocation(program, "marks"), marks);
        glUseProgram(program);
        if (program == whole) draw_patches(0, without);
        else draw_patches(without, static_cast<GLsizei>(order.size()) - without);
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
    const GroundStyle& style = options.style;
    const bool plain = style.colour == GroundColour::height && style.contour_interval_m == 0 && (drape == 0 || !style.drape);
    glUseProgram(plain ? plain_surface : surface);
    glBindVertexArray(arrays[1]);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }

  void draw_part(std::span<const TerrainPatch> patches, const Camera& camera, Size picture, const PicturePart& part, int supersampling, DrawMode mode,
                 const Canvas& to) {
    const std::int64_t width = part.width * supersampling, height = part.height * supersampling;
    const double near = near_of(box(), camera.eye);
    const auto projection = projection_matrix(camera, picture, part, near);
    for (const GLuint program : {whole, holed}) set(program, "projection", projection);
    for (const GLuint program : {surface, plain_surface}) to.set_samples(program, camera, picture, part, supersampling, near);
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

  /// As SceneRenderer::draw_parts.
  Frame draw_parts(const std::vector<TerrainPatch>& patches, const Camera& camera, Size picture, DrawMode mode, Highlights highlights,
                   const std::function<void(const DrawnPart&)>& take) {
    context.make_current();
    const std::int64_t before = tiles->loaded();
    const int supersampling = mode == DrawMode::coverage ? 1 : std::clamp(options.supersampling, 1, 4);
    set_camera(camera, mode);
    for (const GLuint program : {surface, plain_surface}) set_highlights(program, highlights);
    set(surface, "line_px", supersampling);
    draw_in_parts(picture, supersampling, canvas, take,
                  [&](const PicturePart& part, const Canvas& to) { draw_part(patches, camera, picture, part, supersampling, mode, to); });
    Frame frame{picture, {}, static_cast<std::int64_t>(patches.size()), 0, tiles->loaded() - before};
    for (const TerrainPatch& patch : patches) frame.triangles += count_triangles(patch);
    return frame;
  }

  SceneOptions options;
  GlContext context;  // first, so that a missing driver is told before the terrain is read
  std::unique_ptr<TerrainScene> scene;
  std::unique_ptr<TileCache> tiles;
  std::unique_ptr<Canvas> canvas;
  GLuint whole = 0, holed = 0, capture = 0, surface = 0, plain_surface = 0, light = 0, ramp = 0, drape = 0, patch_buffer = 0, tile_buffer = 0;
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
  impl_->light = make_light_texture(impl_->scene->light);
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

int TerrainRenderer::threads() const { return impl_->options.threads; }

Frame TerrainRenderer::draw_parts(const Camera& camera, Size picture, DrawMode mode, Highlights highlights, const std::function<void(const DrawnPart&)>& take) {
  return impl_->draw_parts(select(camera, picture), camera, picture, mode, highlights, take);
}

Frame TerrainRenderer::draw(const std::vector<TerrainPatch>& patches, const Camera& camera, Size picture, DrawMode mode) {
  std::vector<std::uint8_t> rgba;
  Frame frame = impl_->draw_parts(patches, camera, picture, mode, Highlights::roll_off, develop_into(rgba, picture));
  frame.rgba = std::move(rgba);
  return frame;
}

std::vector<std::array<float, 3>> TerrainRenderer::evaluate(const std::vector<TerrainPatch>& patches) {
  impl_->context.make_current();
  std::vector<std::array<float, 3>> vertices;
  GLuint buffer = 0;
  glCreateBuffers(1, &buffer);
  // Nothing is drawn, but there must be something to draw to.
  const Canvas canvas(16, 16);
  canvas.begin_surfaces(16, 16);
  glEnable(GL_RASTERIZER_DISCARD);
  for (std::span<const TerrainPatch> rest = patches; !rest.empty();) {
    std::vector<TileCache::Place> places;
    const std::span<const TerrainPatch> batch = rest.first(impl_->tiles->load(rest, places));
    rest = rest.subspan(batch.size());
    impl_->load_vertices(batch, places, numbers_to(batch.size()));
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
