#include "shaders/mesh_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include <gmock/gmock.h>

#include "core/support/error.h"
#include "core/support/random.h"
#include "gis/tin/make_tin.h"
#include "shaders/mesh_scene.h"
#include "tests/shaders/count_holes.h"
#include "tests/shaders/gl_fixture.h"

namespace arete {
namespace {

class MeshRendererTest : public GlFixture {
 protected:
  static std::unique_ptr<MeshRenderer> draw_with(const TriangleMesh& mesh, const SceneOptions& options) {
    NoProgress progress;
    return std::make_unique<MeshRenderer>(mesh, options, progress);
  }
};

SceneOptions bare() {
  SceneOptions options;
  options.exaggeration = 1;
  options.haze = 0;
  options.walls = false;
  return options;
}

/// Vertices at random up to 25 m beside the corners of a grid of n x n cells of 100 m, so that no triangle is turned over; the border stays straight.
TriangleMesh scattered(std::uint32_t n, double (*height)(double x, double y)) {
  TriangleMesh mesh;
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x) {
      const auto within = [&](std::uint32_t i, std::uint64_t axis) { return 100 * (i + (i == 0 || i == n ? 0 : 0.5 * (uniform_at(5, x, y, axis) - 0.5))); };
      const double east = within(x, 0), north = within(y, 1);
      mesh.vertices.push_back({east, north, height(east, north)});
    }
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

/// The TIN of cells of 30 m, within an error.
TriangleMesh tin_of(const RasterSource& source, double max_error_m) {
  NoProgress progress;
  TinOptions options;
  options.max_error_m = max_error_m;
  const Tin tin = make_tin(source, options, progress);
  std::vector<MeshVertex> vertices(static_cast<std::size_t>(tin.mesh.vertices()));
  std::vector<MeshTriangle> triangles(static_cast<std::size_t>(tin.mesh.triangles()));
  tin.mesh.read_vertices(0, vertices);
  tin.mesh.read_triangles(0, triangles);
  TriangleMesh mesh;
  for (const MeshVertex& v : vertices) mesh.vertices.push_back({30 * v.x, -30 * v.y, v.z});
  for (const MeshTriangle& t : triangles)
    mesh.triangles.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]), static_cast<std::uint32_t>(t[2])});
  return mesh;
}

std::array<int, 3> pixel(const Frame& frame, std::int64_t x, std::int64_t y) {
  const auto i = static_cast<std::size_t>(4 * (y * frame.size.width + x));
  return {frame.rgba[i], frame.rgba[i + 1], frame.rgba[i + 2]};
}

double srgb(double linear) { return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055); }
double linear(double byte) { return byte / 255 <= 0.04045 ? byte / 255 / 12.92 : std::pow((byte / 255 + 0.055) / 1.055, 2.4); }

TEST_F(MeshRendererTest, APlaneHasOneColourWhateverItsTriangles) {
  // Rises by 5 cm per metre to the east: so little that it hides no light from itself that could be seen (1 - cos^2 = 0.25 %).
  const auto renderer = draw_with(scattered(12, [](double x, double) { return 100 + 0.05 * x; }), bare());
  const Frame frame = renderer->draw(orbit_camera({600, 600, 130}, 180, 60, 900, 30), {200, 150});
  const double azimuth = 315 * M_PI / 180, elevation = 40 * M_PI / 180, length = std::hypot(0.05, 1.0);
  const std::array<double, 3> normal = {-0.05 / length, 0, 1 / length},
                              to_sun = {std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation), std::sin(elevation)};
  const double direct = normal[0] * to_sun[0] + normal[2] * to_sun[2], sky = 0.5 + 0.5 * normal[2];
  const double albedo[] = {200, 198, 194}, sun_light[] = {1.12, 1.04, 0.91}, sky_light[] = {0.225, 0.265, 0.345}, bounce[] = {0.05, 0.043, 0.034};
  for (std::size_t c = 0; c < 3; ++c) {
    // light.glsl; highlights begin to roll off at 0.7.
    const double exact = linear(albedo[c]) * (sun_light[c] * direct + sky_light[c] * sky + bounce[c] * (1 - 0.5 * normal[2]));
    ASSERT_LT(exact, 0.7);
    for (std::int64_t y = 0; y < 150; ++y)
      for (std::int64_t x = 0; x < 200; ++x) ASSERT_NEAR(pixel(frame, x, y)[c], srgb(exact), 1.6) << x << ", " << y;
  }
}

TEST_F(MeshRendererTest, WhatIsNearerHidesWhatIsFarther) {
  // A white roof over half of the black ground.
  TriangleMesh mesh{{{0, 0, 50}, {1000, 0, 50}, {1000, 1000, 50}, {0, 1000, 50}, {500, 0, 200}, {1000, 0, 200}, {1000, 1000, 200}, {500, 1000, 200}},
                    {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}}};
  SceneOptions options = bare();
  options.ramp = {{0, 0, 0}, {255, 255, 255}};
  for (int turned = 0; turned < 2; ++turned) {
    const auto renderer = draw_with(mesh, options);
    const Frame frame = renderer->draw(orbit_camera({500, 500, 0}, 180, 89.9, 6000, 10), {100, 100});
    EXPECT_LT(pixel(frame, 30, 50)[1], 10);
    EXPECT_GT(pixel(frame, 70, 50)[1], 150);
    std::reverse(mesh.triangles.begin(), mesh.triangles.end());
  }
}

TEST_F(MeshRendererTest, NoPixelShowsThroughFromFiftyCameras) {
  const Raster<float> cells = synthesize_mountains({240, 190}, {.seed = 6});
  TriangleMesh mesh = tin_of(ViewSource(cells.view()), 8);
  const auto closed = draw_with(mesh, bare()), block = draw_with(mesh, {});
  // The same without the triangles that the cameras look at.
  const Box box = closed->box();
  for (int i = 0; i < 25; ++i) {
    const Point3 target = camera(*closed, i).target;
    std::erase_if(mesh.triangles, [&](const auto& t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Point3 &a = mesh.vertices[t[k]], &b = mesh.vertices[t[(k + 1) % 3]];
        if ((b[0] - a[0]) * (target[1] - a[1]) < (b[1] - a[1]) * (target[0] - a[0])) return false;
      }
      return true;
    });
  }
  const auto open = draw_with(mesh, bare());
  EXPECT_EQ(open->box().high[2], box.high[2]);
  int seen = 0;
  for (int i = 0; i < 50; ++i) {
    const Camera from = camera(*closed, i);
    const Frame frame = closed->draw(from, {320, 240}, DrawMode::coverage);
    EXPECT_EQ(count_holes(frame), 0) << "camera " << i;
    if (i % 5 == 0) {
      EXPECT_EQ(count_holes(block->draw(camera(*block, i), {320, 240}, DrawMode::coverage)), 0) << "with walls, camera " << i;
    }
    seen += count_holes(open->draw(from, {320, 240}, DrawMode::coverage)) > 0;
  }
  EXPECT_GE(seen, 40);  // the detector sees what it is to see
}

TEST_F(MeshRendererTest, TheSameBytesWhateverTheThreadsAndWhatWasDrawnBefore) {
  const Raster<float> cells = synthesize_mountains({240, 240}, {.seed = 7});
  const TriangleMesh mesh = tin_of(ViewSource(cells.view()), 5);
  SceneOptions options;
  options.threads = 1;
  const auto one = draw_with(mesh, options);
  options.threads = 3;
  const auto three = draw_with(mesh, options);
  const Size picture{320, 200};
  for (const DrawMode mode : {DrawMode::lit, DrawMode::wireframe}) {
    const Frame first = one->draw(camera(*one, 3), picture, mode);
    for (int i = 0; i < 5; ++i) one->draw(camera(*one, i), {100 + 30 * i, 90});
    EXPECT_TRUE(one->draw(camera(*one, 3), picture, mode).rgba == first.rgba);
    EXPECT_TRUE(three->draw(camera(*one, 3), picture, mode).rgba == first.rgba);
  }
}

TEST_F(MeshRendererTest, LightAndOrientationMakeNoDifferenceInHowTheyCome) {
  const Raster<float> cells = synthesize_mountains({120, 120}, {.seed = 8});
  TriangleMesh mesh = tin_of(ViewSource(cells.view()), 5);
  SceneOptions options;
  options.exaggeration = 2;
  options.sun_azimuth_deg = 100;
  options.sun_elevation_deg = 20;
  const auto at_once = draw_with(mesh, options);
  const Frame frame = at_once->draw(camera(*at_once, 4), {200, 150});
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  const auto later = draw_with(mesh, {});
  EXPECT_FALSE(later->draw(camera(*at_once, 4), {200, 150}).rgba == frame.rgba);
  later->relight(2, 100, 20);
  EXPECT_EQ(later->box().low, at_once->box().low);
  EXPECT_TRUE(later->draw(camera(*at_once, 4), {200, 150}).rgba == frame.rgba);
}

TEST_F(MeshRendererTest, FarFromTheOriginNothingTrembles) {
  const Raster<float> cells = synthesize_mountains({120, 120}, {.seed = 9});
  const TriangleMesh mesh = tin_of(ViewSource(cells.view()), 2);
  TriangleMesh far = mesh;
  const Point3 away = {0x1p19, 0x1p22, 0};  // as UTM coordinates are
  for (Point3& p : far.vertices) p = {p[0] + away[0], p[1] + away[1], p[2]};
  const auto here = draw_with(mesh, {}), there = draw_with(far, {});
  for (int i = 0; i < 3; ++i) {
    Camera from = camera(*here, i);
    // 10 m above the ground, at places that both can name exactly.
    for (std::size_t c = 0; c < 2; ++c) from.eye[c] = std::round(from.target[c]), from.target[c] = from.eye[c] + 50;
    from.eye[2] = std::round(here->ground_height(from.eye[0], from.eye[1])) + 10;
    from.target[2] = from.eye[2] - 20;
    Camera moved = from;
    for (std::size_t c = 0; c < 3; ++c) moved.eye[c] += away[c], moved.target[c] += away[c];
    EXPECT_TRUE(there->draw(moved, {200, 150}).rgba == here->draw(from, {200, 150}).rgba) << i;
  }
}

TEST_F(MeshRendererTest, TheTinOfADemLooksLikeTheDem) {
  const Raster<float> cells = synthesize_mountains({300, 240}, {.seed = 10});
  const ViewSource source(cells.view());
  SceneOptions options;
  options.exaggeration = 1;
  options.supersampling = 2;
  options.ramp = {{90, 150, 110}, {220, 210, 160}, {250, 250, 250}};
  const auto dem = render(source, options);
  options.ramp_range_m = {dem->facts().ramp_low_m, dem->facts().ramp_high_m};
  const auto fine = draw_with(tin_of(source, 0.5), options), coarse = draw_with(tin_of(source, 60), options);
  // Steps of 255, in the mean, and where they differ most but for one pixel in a hundred.
  const auto difference = [&](MeshRenderer& mesh) {
    std::vector<int> steps;
    for (const double azimuth : {200.0, 320.0}) {
      const Camera from = frame_box(dem->box(), azimuth, 40, 30, 4.0 / 3);
      const Frame a = dem->draw(from, {320, 240}), b = mesh.draw(from, {320, 240});
      for (std::size_t i = 0; i < a.rgba.size(); ++i)
        if (i % 4 < 3) steps.push_back(std::abs(a.rgba[i] - b.rgba[i]));
    }
    std::sort(steps.begin(), steps.end());
    double sum = 0;
    for (const int step : steps) sum += step;
    return std::pair(sum / static_cast<double>(steps.size()), steps[steps.size() * 99 / 100]);
  };
  // Measured: 1.2 and 20, along ridges, whose samples the terrain smooths; of 60 m, 4.5.
  const auto [mean, most] = difference(*fine);
  EXPECT_LT(mean, 2);
  EXPECT_LT(most, 26);
  EXPECT_GT(difference(*coarse).first, 2 * mean);
}

TEST_F(MeshRendererTest, LinesAreAsWideInAnyDistance) {
  // Strips of 100 m, whose long sides lie across the view.
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= 100; ++i)
    for (const double x : {-1e5, 1e5}) mesh.vertices.push_back({x, 100.0 * i, 0});
  for (std::uint32_t i = 0; i < 100; ++i) {
    mesh.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 3});
    mesh.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 2});
  }
  SceneOptions options = bare();
  options.supersampling = 2;
  const auto renderer = draw_with(mesh, options);
  // 1/8 m of the ground to a pixel, then 1/2 m. In the middle, diagonals are 50 m away from the sides.
  std::vector<double> widths;
  for (const double distance : {100.0, 400.0}) {
    const Camera from = orbit_camera({0, 1000, 0}, 180, 89.999, distance, 2 * std::atan(0.125) * 180 / M_PI);
    const Frame lines = renderer->draw(from, {60, 200}, DrawMode::wireframe), plain = renderer->draw(from, {60, 200});
    // How much of a column is line, in pixels.
    double cover = 0;
    for (std::int64_t x = 0; x < 60; ++x)
      for (std::int64_t y = 80; y < 120; ++y) {
        const double whole = linear(pixel(plain, x, y)[1]), dark = 0.03;
        cover += (whole - linear(pixel(lines, x, y)[1])) / (whole - dark) / 60;
      }
    widths.push_back(cover);
  }
  EXPECT_NEAR(widths[0], 1.0, 0.25);
  EXPECT_NEAR(widths[1], widths[0], 0.1 * widths[0]);
}

TEST_F(MeshRendererTest, AHoleShowsTheFloorOfTheBlock) {
  TriangleMesh mesh = scattered(10, [](double, double) { return 500.0; });
  std::erase_if(mesh.triangles, [&](const auto& t) { return std::abs(mesh.vertices[t[0]][0] - 500) < 180 && std::abs(mesh.vertices[t[0]][1] - 500) < 180; });
  SceneOptions options;
  options.haze = 0;
  const auto renderer = draw_with(mesh, options);
  EXPECT_TRUE(renderer->facts().has_voids);
  EXPECT_LT(renderer->box().low[2], 500 - 0.01 * 1000);
  const Camera above = orbit_camera({500, 500, 500}, 180, 89.9, 10000, 6.5);
  const Frame frame = renderer->draw(above, {120, 120});
  EXPECT_NEAR(pixel(frame, 64, 54)[0], srgb(0.115), 2);
  EXPECT_GT(pixel(frame, 20, 20)[0], 150);
  const Frame covered = renderer->draw(above, {120, 120}, DrawMode::coverage);
  EXPECT_EQ(pixel(covered, 64, 54)[0], 0);
  EXPECT_EQ(pixel(covered, 20, 20)[0], 255);
  EXPECT_FALSE(draw_with(scattered(3, [](double, double) { return 1.0; }), options)->facts().has_voids);
}

TEST_F(MeshRendererTest, FlatGroundAtTheSeaIsWater) {
  const auto shore = [](double x, double) { return x <= 550 ? 0.0 : 0.2 * (x - 550); };
  const auto renderer = draw_with(scattered(10, shore), bare());
  const Frame frame = renderer->draw(orbit_camera({500, 500, 0}, 180, 60, 3000, 20), {120, 120});
  EXPECT_TRUE(renderer->facts().has_water);
  EXPECT_GT(pixel(frame, 35, 60)[2], pixel(frame, 35, 60)[0] + 20);
  EXPECT_LT(pixel(frame, 85, 60)[2], pixel(frame, 85, 60)[0] + 20);
}

TEST_F(MeshRendererTest, RefusesWhatItCannotDraw) {
  const TriangleMesh good{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const auto error_of = [](const TriangleMesh& mesh, const SceneOptions& options, ErrorKind kind) -> std::string {
    try {
      draw_with(mesh, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), kind);
      return error.what();
    }
    return "nothing";
  };
  EXPECT_EQ(error_of(good, {}, ErrorKind::input), "nothing");
  TriangleMesh bad = good;
  bad.triangles.clear();
  EXPECT_THAT(error_of(bad, {}, ErrorKind::input), testing::HasSubstr("no extent"));
  bad = good;
  bad.vertices[2] = {0.5, 0, 1};  // upright
  EXPECT_THAT(error_of(bad, {}, ErrorKind::input), testing::HasSubstr("no extent"));
  bad = good;
  bad.vertices[1][2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of(bad, {}, ErrorKind::input), testing::HasSubstr("vertex 1 is not finite"));
  bad = good;
  bad.triangles.push_back({0, 1, 3});
  EXPECT_THAT(error_of(bad, {}, ErrorKind::input), testing::HasSubstr("triangle 1 names vertex 3, but there are only 3"));
  SceneOptions tight;
  tight.memory_bytes = mesh_bytes(3, 1) - 1;
  EXPECT_THAT(error_of(good, tight, ErrorKind::memory), testing::HasSubstr("1 triangles and 3 vertices"));
  tight.memory_bytes = mesh_bytes(3 + 4 * 3, 1 + 2 * 3) - 1;
  EXPECT_THAT(error_of(good, tight, ErrorKind::memory), testing::HasSubstr("7 triangles and 15 vertices"));  // with its walls
  ++tight.memory_bytes;
  EXPECT_EQ(error_of(good, tight, ErrorKind::memory), "nothing");
  EXPECT_THROW(draw_with(good, {})->draw({}, {0, 5}), Error);
}

}  // namespace
}  // namespace arete
