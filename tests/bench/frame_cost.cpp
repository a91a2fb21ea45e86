// What a frame costs, in triangles and processor seconds (median of five, all threads together), 1920 x 1080 pixels:
//   frame_cost DEM [PIXEL_ERROR]   the full grid, level of detail, and each beside a bare grid of the same triangles
//   frame_cost --growth            terrains of 1k x 1k to 32k x 32k samples of the same ground from the same camera
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <epoxy/gl.h>

#include "core/synthesis/mountains.h"
#include "gis/dem_file.h"
#include "shaders/terrain_renderer.h"

namespace arete {
namespace {

constexpr Size picture{1920, 1080};

double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6; };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double largest_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

double median_seconds(const std::function<void()>& draw) {
  draw();  // tiles and compiled stages stay
  std::vector<double> seconds;
  for (int i = 0; i < 5; ++i) {
    const double start = processor_seconds();
    draw();
    seconds.push_back(processor_seconds() - start);
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[2];
}

/// The triangles of patches as a plain indexed mesh under one lamp: what a program that only draws them does.
class BareGrid {
 public:
  BareGrid(TerrainRenderer& renderer, const std::vector<TerrainPatch>& patches, CellSize cell, double exaggeration, const Camera& camera) {
    std::map<std::array<float, 3>, std::uint32_t> places;
    std::vector<std::uint32_t> indices;
    std::vector<float> positions;
    for (const std::array<float, 3>& vertex : renderer.evaluate(patches)) {
      const auto [found, fresh] = places.emplace(vertex, static_cast<std::uint32_t>(places.size()));
      if (fresh) {
        positions.push_back(static_cast<float>(vertex[0] * cell.x_m - camera.eye[0]));
        positions.push_back(static_cast<float>(-vertex[1] * cell.y_m - camera.eye[1]));
        positions.push_back(static_cast<float>(vertex[2] * exaggeration - camera.eye[2]));
      }
      indices.push_back(found->second);
    }
    count_ = static_cast<GLsizei>(indices.size());
    glCreateBuffers(2, buffers_);
    glNamedBufferData(buffers_[0], static_cast<GLsizeiptr>(positions.size() * sizeof(float)), positions.data(), GL_STATIC_DRAW);
    glNamedBufferData(buffers_[1], static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint32_t)), indices.data(), GL_STATIC_DRAW);
    glCreateVertexArrays(1, &array_);
    glVertexArrayVertexBuffer(array_, 0, buffers_[0], 0, 3 * sizeof(float));
    glVertexArrayElementBuffer(array_, buffers_[1]);
    glEnableVertexArrayAttrib(array_, 0);
    glVertexArrayAttribFormat(array_, 0, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(array_, 0, 0);
    program_ = glCreateProgram();
    add(GL_VERTEX_SHADER, "#version 450 core\nuniform mat4 projection; layout(location = 0) in vec3 at; out vec3 place;\n"
                          "void main() { place = at; gl_Position = projection * vec4(at, 1.0); }\n");
    add(GL_FRAGMENT_SHADER, "#version 450 core\nin vec3 place; layout(location = 0) out vec4 colour;\n"
                            "void main() { vec3 n = normalize(cross(dFdx(place), dFdy(place)));\n"
                            "  colour = vec4(vec3(0.2 + 0.8 * max(dot(n, vec3(-0.54, 0.54, 0.64)), 0.0)), 1.0); }\n");
    glLinkProgram(program_);
    std::array<float, 16> matrix;
    const auto exact = projection_matrix(camera, picture, {0, 0, picture.width, picture.height}, 1);
    std::copy(exact.begin(), exact.end(), matrix.begin());
    glProgramUniformMatrix4fv(program_, glGetUniformLocation(program_, "projection"), 1, GL_FALSE, matrix.data());
    glCreateRenderbuffers(3, targets_);
    glCreateFramebuffers(2, frames_);
    glNamedRenderbufferStorageMultisample(targets_[0], 4, GL_RGBA8, picture.width, picture.height);
    glNamedRenderbufferStorageMultisample(targets_[1], 4, GL_DEPTH_COMPONENT32F, picture.width, picture.height);
    glNamedRenderbufferStorage(targets_[2], GL_RGBA8, picture.width, picture.height);
    glNamedFramebufferRenderbuffer(frames_[0], GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, targets_[0]);
    glNamedFramebufferRenderbuffer(frames_[0], GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, targets_[1]);
    glNamedFramebufferRenderbuffer(frames_[1], GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, targets_[2]);
  }
  ~BareGrid() {
    glDeleteProgram(program_);
    glDeleteVertexArrays(1, &array_);
    glDeleteBuffers(2, buffers_);
    glDeleteFramebuffers(2, frames_);
    glDeleteRenderbuffers(3, targets_);
  }
  BareGrid(const BareGrid&) = delete;
  BareGrid& operator=(const BareGrid&) = delete;

  void draw() {
    glBindFramebuffer(GL_FRAMEBUFFER, frames_[0]);
    glViewport(0, 0, picture.width, picture.height);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glClearDepth(0);
    glClearColor(0.7f, 0.8f, 0.9f, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glUseProgram(program_);
    glBindVertexArray(array_);
    glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
    glBlitNamedFramebuffer(frames_[0], frames_[1], 0, 0, picture.width, picture.height, 0, 0, picture.width, picture.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, frames_[1]);
    pixels_.resize(static_cast<std::size_t>(4 * picture.cells()));
    glReadPixels(0, 0, picture.width, picture.height, GL_RGBA, GL_UNSIGNED_BYTE, pixels_.data());
  }

 private:
  void add(GLenum kind, const char* text) const {
    const GLuint stage = glCreateShader(kind);
    glShaderSource(stage, 1, &text, nullptr);
    glCompileShader(stage);
    glAttachShader(program_, stage);
    glDeleteShader(stage);
  }

  GLuint program_ = 0, array_ = 0, buffers_[2]{}, targets_[3]{}, frames_[2]{};
  GLsizei count_ = 0;
  std::vector<std::uint8_t> pixels_;
};

std::vector<TerrainPatch> full_grid(Size size) {
  std::vector<TerrainPatch> patches;
  for (std::int32_t y = 0; y < size.height - 1; y += node_cells)
    for (std::int32_t x = 0; x < size.width - 1; x += node_cells)
      patches.push_back({x, y, 0, {node_cells, node_cells, node_cells, node_cells}, {node_cells, node_cells}, 0});
  return patches;
}

void compare(const char* name, TerrainRenderer& renderer, const std::vector<TerrainPatch>& patches, CellSize cell, const Camera& camera, double& seconds) {
  std::int64_t triangles = 0;
  for (const TerrainPatch& patch : patches) triangles += count_triangles(patch);
  BareGrid bare(renderer, patches, cell, renderer.facts().exaggeration, camera);
  seconds = median_seconds([&] { renderer.draw(patches, camera, picture, DrawMode::lit); });
  const double covered = median_seconds([&] { renderer.draw(patches, camera, picture, DrawMode::coverage); });
  const double plain = median_seconds([&] { bare.draw(); });
  std::printf("%-16s %8zu patches %9lld triangles %8.3f s, unlit %8.3f s, bare grid %8.3f s, ratio %.2f\n", name, patches.size(), static_cast<long long>(triangles), seconds,
              covered, plain, seconds / plain);
}

void measure_dem(const char* path, double pixel_error) {
  const DemReader dem(path);
  SceneOptions options;
  options.walls = false;
  options.detail.max_error_px = pixel_error;
  NoProgress silent;
  const CellSize cell = dem.cell_size();
  TerrainRenderer renderer(dem, cell, options, silent);
  const Camera camera = frame_box(renderer.box(), 200, 35, 30, 16.0 / 9);
  std::printf("%s, %lld x %lld samples, %s\n", path, static_cast<long long>(dem.size().width), static_cast<long long>(dem.size().height), renderer.driver().c_str());
  double detail = 0, full = 0;
  compare("level of detail", renderer, renderer.select(camera, picture), cell, camera, detail);
  if (dem.size().cells() <= std::int64_t{1} << 24) {
    compare("full grid", renderer, full_grid(dem.size()), cell, camera, full);
  } else {
    // Once, and without the bare grid: minutes, and gigabytes of plain vertices.
    const double start = processor_seconds();
    const Frame frame = renderer.draw(full_grid(dem.size()), camera, picture, DrawMode::lit);
    full = processor_seconds() - start;
    std::printf("%-16s %8lld patches %9lld triangles %8.3f s, once\n", "full grid", static_cast<long long>(frame.patches), static_cast<long long>(frame.triangles), full);
  }
  std::printf("level of detail takes %.1f %% of the time of the full grid\n", 100 * detail / full);
}

/// One ground, sampled as finely as wanted: hills of many sizes, the same at the same place whatever the number of samples.
class Hills final : public RasterSource {
 public:
  explicit Hills(std::int64_t side) : side_(side), base_(synthesize_mountains({1025, 1025}, {.cell_size_m = 30, .seed = 7})) {}
  Size size() const override { return {side_, side_}; }
  void read(const Window& window, RasterView<float> out) const override {
    const double step = 1024.0 / static_cast<double>(side_ - 1);
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) {
        const double u = static_cast<double>(window.x + x) * step, v = static_cast<double>(window.y + y) * step;
        const auto i = std::min<std::int64_t>(static_cast<std::int64_t>(u), 1023), j = std::min<std::int64_t>(static_cast<std::int64_t>(v), 1023);
        const double s = u - static_cast<double>(i), t = v - static_cast<double>(j);
        const double north = (1 - s) * base_(i, j) + s * base_(i + 1, j), south = (1 - s) * base_(i, j + 1) + s * base_(i + 1, j + 1);
        // Ripples that only fine samples see.
        out(x, y) = static_cast<float>((1 - t) * north + t * south + 3 * std::sin(9 * u) * std::sin(8 * v) + 0.4 * std::sin(61 * u + 3) * std::sin(55 * v));
      }
  }

 private:
  std::int64_t side_;
  Raster<float> base_;
};

void measure_growth() {
  double first = 0;
  for (std::int64_t side = 1024; side <= 32768; side *= 2) {
    const Hills hills(side);
    SceneOptions options;
    options.memory_bytes = std::int64_t{512} << 20;
    NoProgress silent;
    const double start = processor_seconds();
    TerrainRenderer renderer(hills, {30.0 * 1023 / static_cast<double>(side - 1), 30.0 * 1023 / static_cast<double>(side - 1)}, options, silent);
    const double prepared = processor_seconds() - start;
    std::printf("%6lld: prepared in %.1f s;", static_cast<long long>(side), prepared);
    const Camera camera = frame_box(renderer.box(), 200, 35, 30, 16.0 / 9);
    Frame frame;
    const double before = processor_seconds();
    frame = renderer.draw(camera, picture);
    const double cold = processor_seconds() - before;
    const double seconds = median_seconds([&] { frame = renderer.draw(camera, picture); });
    if (first == 0) first = seconds;
    std::printf(" %8lld triangles, first frame %7.3f s, then %7.3f s, ratio %.2f; peak %.0f MB\n", static_cast<long long>(frame.triangles), cold, seconds, seconds / first,
                largest_memory_mb());
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace arete

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: frame_cost DEM [PIXEL_ERROR] | --growth\n");
    return 2;
  }
  if (std::string(argv[1]) == "--growth") arete::measure_growth();
  else arete::measure_dem(argv[1], argc > 2 ? std::atof(argv[2]) : 2);
}
