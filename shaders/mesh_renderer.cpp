#include "shaders/mesh_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <epoxy/gl.h>

#include "core/support/error.h"
#include "shaders/canvas.h"
#include "shaders/gl_context.h"
#include "shaders/gl_program.h"
#include "shaders/gl_uniforms.h"
#include "shaders/ground_textures.h"
#include "shaders/mesh_scene.h"
#include "shaders/scene_light.h"

namespace arete {
namespace {

// Of lines, in pixels of the picture.
constexpr double line_px = 1.1;

void set_int3(GLuint program, const char* name, const std::array<std::int64_t, 3>& v) {
  glProgramUniform3i(program, glGetUniformLocation(program, name), static_cast<GLint>(v[0]), static_cast<GLint>(v[1]), static_cast<GLint>(v[2]));
}

template <class T>
GLuint make_buffer(const std::vector<T>& values, const char* what) {
  GLint64 most = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  const auto bytes = static_cast<std::int64_t>(values.size() * sizeof(T));
  if (bytes > most)
    throw Error(ErrorKind::memory, "cannot draw the mesh: its " + std::string(what) + " take " + std::to_string(bytes / 1'000'000) +
                                       " MB, and the OpenGL driver holds " + std::to_string(most / 1'000'000) + " MB of them; draw a coarser mesh");
  GLuint buffer = 0;
  glCreateBuffers(1, &buffer);
  glNamedBufferStorage(buffer, static_cast<GLsizeiptr>(bytes), values.data(), 0);
  if (glGetError() == GL_OUT_OF_MEMORY) {
    glDeleteBuffers(1, &buffer);
    throw Error(ErrorKind::memory, "cannot draw the mesh: the OpenGL driver has no room for its " + std::string(what) + ", " +
                                       std::to_string(bytes / 1'000'000) + " MB; draw a coarser mesh");
  }
  return buffer;
}

}  // namespace

struct MeshRenderer::Impl {
  Impl(TriangleMesh mesh, const SceneOptions& scene_options, Progress& progress)
      : options(scene_options), scene(prepare_mesh(std::move(mesh), scene_options, progress)) {
    context.make_current();
    places = make_buffer(scene->places, "vertices");
    triangles = make_buffer(scene->triangles, "triangles");
    std::vector<MeshPlace>().swap(scene->places);
    std::vector<std::array<std::uint32_t, 3>>().swap(scene->triangles);
    glCreateVertexArrays(2, arrays);  // the mesh; nothing
    glVertexArrayVertexBuffer(arrays[0], 0, places, 0, sizeof(MeshPlace));
    glVertexArrayElementBuffer(arrays[0], triangles);
    glEnableVertexArrayAttrib(arrays[0], 0);
    glVertexArrayAttribIFormat(arrays[0], 0, 3, GL_INT, 0);
    glVertexArrayAttribBinding(arrays[0], 0, 0);
    geometry = link_program({"mesh.vert", "mesh.frag"});
    surface = link_program({"screen.vert", "mesh_surface.frag"});
    light = make_light_texture(scene->light);
    ramp = make_ramp_texture(options);
    if (options.drape) {
      drape = make_drape_texture(*options.drape, surface, options.threads);
      drape_cell = options.drape->cell;
      options.drape.reset();
    }
    set_scene();
    set_style(options.style);
  }
  ~Impl() {
    context.make_current();
    for (const GLuint program : {geometry, surface}) glDeleteProgram(program);
    const GLuint textures[] = {light, ramp, drape}, buffers[] = {places, triangles};
    glDeleteTextures(3, textures);
    glDeleteVertexArrays(2, arrays);
    glDeleteBuffers(2, buffers);
    canvas.reset();
  }

  void set_scene() const {
    const std::pair<const char*, int> units[] = {{"seen", 0}, {"depths", 1}, {"light", 3}, {"ramps", 4}, {"drape", 5}};
    for (const auto& [name, unit] : units) set_int(surface, name, unit);
    const auto unit = static_cast<float>(scene->unit_m), unit_up = static_cast<float>(scene->unit_m * scene->facts.exaggeration);
    for (const GLuint program : {geometry, surface}) set(program, "unit", Colour3{unit, unit, unit_up});
    set_int3(surface, "first_of", {scene->first_wall, scene->first_side, scene->first_floor});
    // Nothing is water where the mesh lies above 0 m.
    const double sea = std::round(-scene->ground.low[2] / scene->unit_m);
    set_int(surface, "sea_place", sea < 0 ? -1 : static_cast<int>(std::min(sea, 0x1p30)));
    set(surface, "exaggeration", scene->facts.exaggeration);
    set(surface, "light_scale", 1 / (scene->ground.high[0] - scene->ground.low[0]), -1 / (scene->ground.high[1] - scene->ground.low[1]));
    set_scene_light(surface, scene->facts, options);
  }

  void set_style(const GroundStyle& style) { options.style = set_ground_style(surface, style, scene->facts, drape != 0); }

  Box exaggerated(const Box& from, bool to_base) const {
    Box box = from;
    box.low[2] = to_base ? scene->base : box.low[2] * scene->facts.exaggeration;
    box.high[2] *= scene->facts.exaggeration;
    return box;
  }
  Box box() const { return exaggerated(scene->ground, options.walls); }

  void set_camera(const Camera& camera, DrawMode mode, int supersampling) const {
    const Point3 &low = scene->ground.low, &high = scene->ground.high;
    std::array<std::int64_t, 3> eye_place;
    Colour3 eye_part;
    for (std::size_t c = 0; c < 3; ++c) {
      const double place = (c == 2 ? camera.eye[2] / scene->facts.exaggeration - low[2] : camera.eye[c] - low[c]) / scene->unit_m;
      // An eye beyond is so far away that the rest needs no whole numbers.
      eye_place[c] = std::llround(std::clamp(std::floor(place), -0x1p30, 0x1p30));
      eye_part[c] = static_cast<float>(place - static_cast<double>(eye_place[c]));
    }
    for (const GLuint program : {geometry, surface}) {
      set_int3(program, "eye_place", eye_place);
      set(program, "eye_part", eye_part);
      set(program, "base", scene->base - camera.eye[2]);
    }
    set(surface, "eye_height", camera.eye[2]);
    set(surface, "eye_in_light", (camera.eye[0] - low[0]) / (high[0] - low[0]), (high[1] - camera.eye[1]) / (high[1] - low[1]));
    set(surface, "line_width", mode == DrawMode::wireframe ? line_px * supersampling : 0);
    set_int(surface, "mode", mode == DrawMode::coverage ? 2 : 0);
    set(surface, "eye_cells", camera.eye[0] / drape_cell.x_m, -camera.eye[1] / drape_cell.y_m);
    set(surface, "line_px", supersampling);
    set_haze(surface, box(), camera.eye, options.haze);
  }

  /// Chunks that may be seen, those that follow each other together.
  std::vector<MeshChunk> seen_chunks(const std::array<double, 16>& view, const Camera& camera, std::vector<char>* seen) const {
    std::vector<MeshChunk> runs;
    for (std::size_t i = 0; i < scene->chunks.size(); ++i) {
      const MeshChunk& chunk = scene->chunks[i];
      if (!sees(view, camera, exaggerated(chunk.box, chunk.to_base))) continue;
      if (seen != nullptr) (*seen)[i] = 1;
      if (!runs.empty() && runs.back().first + runs.back().count == chunk.first) runs.back().count += chunk.count;
      else runs.push_back(chunk);
    }
    return runs;
  }

  void draw_part(const Camera& camera, Size picture, const PicturePart& part, int supersampling, const Canvas& to, std::vector<char>& seen) const {
    const std::int64_t width = part.width * supersampling, height = part.height * supersampling;
    const double near = near_of(box(), camera.eye);
    const auto projection = projection_matrix(camera, picture, part, near);
    for (const GLuint program : {geometry, surface}) set(program, "projection", projection);
    to.set_samples(surface, camera, picture, part, supersampling, near);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    to.begin_surfaces(width, height);
    to.clear();
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glUseProgram(geometry);
    glBindVertexArray(arrays[0]);
    for (const MeshChunk& run : seen_chunks(projection, camera, &seen)) {
      glProgramUniform1ui(geometry, glGetUniformLocation(geometry, "first"), static_cast<GLuint>(run.first));
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * run.count), GL_UNSIGNED_INT, reinterpret_cast<const void*>(static_cast<std::intptr_t>(12 * run.first)));
    }
    to.begin_colours(width, height);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, places);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, triangles);
    glBindTextureUnit(3, light);
    glBindTextureUnit(4, ramp);
    glBindTextureUnit(5, drape);
    glDisable(GL_DEPTH_TEST);
    glUseProgram(surface);
    glBindVertexArray(arrays[1]);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }

  SceneOptions options;
  GlContext context;  // first, so that a missing driver is told before the mesh is prepared
  std::unique_ptr<MeshScene> scene;
  std::unique_ptr<Canvas> canvas;
  GLuint places = 0, triangles = 0, geometry = 0, surface = 0, light = 0, ramp = 0, drape = 0;
  CellSize drape_cell;
  GLuint arrays[2]{};
};

MeshRenderer::MeshRenderer(TriangleMesh mesh, const SceneOptions& options, Progress& progress)
    : impl_(std::make_unique<Impl>(std::move(mesh), options, progress)) {}
MeshRenderer::~MeshRenderer() = default;

const SceneFacts& MeshRenderer::facts() const { return impl_->scene->facts; }
std::string MeshRenderer::driver() const { return impl_->context.description(); }
Box MeshRenderer::box() const { return impl_->box(); }

double MeshRenderer::ground_height(double x_m, double y_m) const {
  const MeshScene& scene = *impl_->scene;
  const Size size = scene.overview.cells.size();
  const auto cell = [](double metres, double cell_m, std::int64_t count) {
    return static_cast<std::int64_t>(std::clamp(std::floor(metres / cell_m), 0.0, static_cast<double>(count - 1)));
  };
  const std::int64_t x = cell(x_m - scene.ground.low[0], scene.block.x_m, size.width), y = cell(scene.ground.high[1] - y_m, scene.block.y_m, size.height);
  return static_cast<double>(scene.overview.cells(x, y)) * scene.facts.exaggeration;
}

void MeshRenderer::relight(double exaggeration, double sun_azimuth_deg, double sun_elevation_deg) {
  impl_->context.make_current();
  impl_->options.sun_azimuth_deg = sun_azimuth_deg;
  impl_->options.sun_elevation_deg = sun_elevation_deg;
  light_mesh(*impl_->scene, exaggeration, sun_azimuth_deg, sun_elevation_deg, impl_->options);
  glDeleteTextures(1, &impl_->light);
  impl_->light = make_light_texture(impl_->scene->light);
  impl_->set_scene();
}

void MeshRenderer::restyle(const GroundStyle& style) {
  impl_->context.make_current();
  impl_->set_style(style);
}

const GroundStyle& MeshRenderer::style() const { return impl_->options.style; }

int MeshRenderer::threads() const { return impl_->options.threads; }

Frame MeshRenderer::draw_parts(const Camera& camera, Size picture, DrawMode mode, Highlights highlights, const std::function<void(const DrawnPart&)>& take) {
  impl_->context.make_current();
  const int supersampling = mode == DrawMode::coverage ? 1 : std::clamp(impl_->options.supersampling, 1, 4);
  impl_->set_camera(camera, mode, supersampling);
  set_highlights(impl_->surface, highlights);
  std::vector<char> seen(impl_->scene->chunks.size());
  draw_in_parts(picture, supersampling, impl_->canvas, take,
                [&](const PicturePart& part, const Canvas& canvas) { impl_->draw_part(camera, picture, part, supersampling, canvas, seen); });
  Frame frame{picture, {}, 0, 0, 0};
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen[i]) ++frame.patches, frame.triangles += impl_->scene->chunks[i].count;
  return frame;
}

}  // namespace arete
