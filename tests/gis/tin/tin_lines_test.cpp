// make_tin with lines and boundaries, checked by what shares no code with it.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/support/random.h"
#include "gis/mesh/check_mesh.h"
#include "gis/tin/make_tin.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Hills with a ridge and noise of a metre.
Raster<float> terrain(std::int64_t width, std::int64_t height) {
  Raster<float> dem(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      const double fx = static_cast<double>(x), fy = static_cast<double>(y);
      dem(x, y) = static_cast<float>(500 + 80 * std::sin(fx / 23) * std::cos(fy / 31) - std::abs(fx - 0.7 * fy) +
                                     uniform_at(3, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
    }
  return dem;
}

void punch(Raster<float>& dem, std::uint64_t seed) {
  for (std::int64_t y = 0; y < dem.height(); ++y)
    for (std::int64_t x = 0; x < dem.width(); ++x)
      if (uniform_at(seed, static_cast<std::uint64_t>(x / 7), static_cast<std::uint64_t>(y / 5)) < 0.15) dem(x, y) = void_value;
}

Tin tin_of(const Raster<float>& dem, const TinLines& lines, double error_m = 5, int threads = 2) {
  TinOptions options;
  options.max_error_m = error_m;
  options.lines = lines;
  options.threads = threads;
  NoProgress silent;
  return make_tin(ViewSource(dem.view()), options, silent);
}

/// Places as a projected DEM of 1 m cells has them, so that the check sees coordinates as files hold them.
struct Placed final : MeshSource {
  explicit Placed(const MeshSource& mesh) : mesh_(mesh) {}
  std::int64_t vertices() const override { return mesh_.vertices(); }
  std::int64_t triangles() const override { return mesh_.triangles(); }
  void read_vertices(std::int64_t first, std::span<MeshVertex> out) const override {
    mesh_.read_vertices(first, out);
    for (MeshVertex& v : out) v.x = 400000 + (v.x + 0.5), v.y = 5000000 - (v.y + 0.5);
  }
  void read_triangles(std::int64_t first, std::span<MeshTriangle> out) const override { mesh_.read_triangles(first, out); }
  const MeshSource& mesh_;
};

MeshErrors check(const Tin& tin, const Raster<float>& dem, double error_m, bool clipped, std::vector<std::string>* faults = nullptr) {
  GeoReference geo;
  geo.transform = std::array<double, 6>{400000, 1, 0, 5000000, 0, -1};
  MeshCheckOptions options;
  options.max_error_m = error_m;
  options.allow_uncovered = clipped;
  NoProgress silent;
  const MeshErrors errors = check_mesh(Placed(tin.mesh), {}, ViewSource(dem.view()), geo, options, silent);
  if (faults != nullptr) *faults = faults_of(errors, options);
  return errors;
}

void expect_sound(const Tin& tin, const Raster<float>& dem, double error_m, bool clipped = false) {
  std::vector<std::string> faults;
  const MeshErrors errors = check(tin, dem, error_m, clipped, &faults);
  EXPECT_THAT(faults, IsEmpty());
  EXPECT_EQ(errors.compared_cells, tin.report.cells);
  EXPECT_NEAR(errors.max_error_m, tin.report.max_error_m, 1e-5);
  EXPECT_NEAR(errors.rmse_m, tin.report.rmse_m, 1e-5);
}

/// Length of a straight line over valid cells that lies along edges of the mesh, within 1e-4 of a cell; in cells.
class EdgeIndex {
 public:
  explicit EdgeIndex(const MeshSource& mesh) : vertices_(vertices_of(mesh)) {
    for (const MeshTriangle& t : triangles_of(mesh))
      for (std::size_t k = 0; k < 3; ++k) edges_.insert(std::minmax(t[k], t[(k + 1) % 3]));
  }
  double covered(const RasterPlace& a, const RasterPlace& b) const {
    const double dx = b[0] - a[0], dy = b[1] - a[1], length = std::hypot(dx, dy);
    std::vector<std::array<double, 2>> parts;
    for (const auto& [from, to] : edges_) {
      const MeshVertex &v = vertices_[static_cast<std::size_t>(from)], &w = vertices_[static_cast<std::size_t>(to)];
      const auto off = [&](const MeshVertex& p) { return std::abs(dx * (p.y - a[1]) - dy * (p.x - a[0])) / length; };
      const auto along = [&](const MeshVertex& p) { return (dx * (p.x - a[0]) + dy * (p.y - a[1])) / length; };
      if (off(v) > 1e-4 || off(w) > 1e-4) continue;
      const double low = std::max(0.0, std::min(along(v), along(w))), high = std::min(length, std::max(along(v), along(w)));
      if (high > low) parts.push_back({low, high});
    }
    std::sort(parts.begin(), parts.end());
    double sum = 0, reached = 0;
    for (const auto& [low, high] : parts) sum += std::max(0.0, high - std::max(low, reached)), reached = std::max(reached, high);
    return sum;
  }

 private:
  std::vector<MeshVertex> vertices_;
  std::set<std::pair<std::int64_t, std::int64_t>> edges_;
};

bool is_over_valid(const Raster<float>& dem, double x, double y) {
  return x >= 0 && y >= 0 && x <= static_cast<double>(dem.width() - 1) && y <= static_cast<double>(dem.height() - 1) &&
         !is_void(dem(static_cast<std::int64_t>(std::floor(x + 0.5)), static_cast<std::int64_t>(std::floor(y + 0.5))));
}

/// By small steps: right to about a thousandth of a cell for each void that is crossed.
double length_over_valid(const Raster<float>& dem, const RasterPlace& a, const RasterPlace& b) {
  const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
  const auto steps = static_cast<std::int64_t>(std::ceil(length * 2000));
  std::int64_t valid = 0;
  for (std::int64_t i = 0; i < steps; ++i) {
    const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(steps);
    valid += is_over_valid(dem, a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]));
  }
  return length * static_cast<double>(valid) / static_cast<double>(steps);
}

void expect_kept(const Tin& tin, const Raster<float>& dem, const TinLines& lines) {
  const EdgeIndex edges(tin.mesh);
  for (const RasterLine& line : lines.breaklines)
    for (std::size_t i = 1; i < line.size(); ++i) {
      const double wanted = length_over_valid(dem, line[i - 1], line[i]);
      EXPECT_NEAR(edges.covered(line[i - 1], line[i]), wanted, 1e-3 * (2 + wanted)) << line[i - 1][0] << ", " << line[i - 1][1] << " to " << line[i][0] << ", " << line[i][1];
    }
}

double area_of(const MeshSource& mesh) {
  const std::vector<MeshVertex> v = vertices_of(mesh);
  double area = 0;
  for (const MeshTriangle& t : triangles_of(mesh)) {
    const MeshVertex &a = v[static_cast<std::size_t>(t[0])], &b = v[static_cast<std::size_t>(t[1])], &c = v[static_cast<std::size_t>(t[2])];
    area += std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
  }
  return area;
}

double area_of(const RasterLine& ring) {
  double twice = 0;
  for (std::size_t i = 1; i < ring.size(); ++i) twice += ring[i - 1][0] * ring[i][1] - ring[i - 1][1] * ring[i][0];
  return std::abs(twice) / 2;
}

TinLines soup(std::uint64_t seed, int count, double width, double height) {
  TinLines lines;
  std::uint64_t next = 0;
  const auto draw = [&] { return uniform_at(seed, next++, 1); };
  for (int i = 0; i < count; ++i) {
    const double snap = draw();
    RasterLine line;
    for (int k = 0; k < 2 + static_cast<int>(4 * draw()); ++k) {
      RasterPlace p{width * (1.1 * draw() - 0.05), height * (1.1 * draw() - 0.05)};
      if (snap < 0.3) p = {std::round(2 * p[0]) / 2, std::round(2 * p[1]) / 2};
      if (snap > 0.9 && !line.empty()) p = {line.back()[0] + 1e-4 * draw(), p[1]};
      line.push_back(p);
    }
    lines.breaklines.push_back(line);
  }
  return lines;
}

std::vector<MeshVertex> sorted_vertices(const Tin& tin) { return vertices_of(tin.mesh); }

TEST(TinLines, KeepsLinesAsEdgesWithinTheBound) {
  const Raster<float> dem = terrain(120, 90);
  const TinLines lines{{{{3.3, 4.7}, {60.2, 44.1}, {110.9, 20.3}}, {{10.1, 80.2}, {100.7, 5.5}}, {{20, 30}, {20, 60.5}, {90, 60.5}}, {{-30, 50.1}, {150, 51.3}}}, {}};
  const Tin tin = tin_of(dem, lines);
  expect_sound(tin, dem, 5);
  expect_kept(tin, dem, lines);
  EXPECT_LT(tin.report.triangles, 120 * 90) << "few triangles, but for the lines";
}

TEST(TinLines, KeepsLinesThroughVoids) {
  Raster<float> dem = terrain(120, 90);
  punch(dem, 5);
  const TinLines lines{{{{3.3, 4.7}, {60.2, 44.1}, {110.9, 20.3}}, {{10.1, 80.2}, {100.7, 5.5}}, {{20.5, 0}, {20.5, 89}}, {{0, 30.5}, {119, 30.5}}}, {}};
  const Tin tin = tin_of(dem, lines);
  expect_sound(tin, dem, 5);
  const EdgeIndex edges(tin.mesh);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 1; k < lines.breaklines[i].size(); ++k) {
      const double wanted = length_over_valid(dem, lines.breaklines[i][k - 1], lines.breaklines[i][k]);
      EXPECT_NEAR(edges.covered(lines.breaklines[i][k - 1], lines.breaklines[i][k]), wanted, 0.03);
    }
}

TEST(TinLines, KeepsLinesAcrossTiles) {
  Raster<float> dem = terrain(2100, 60);
  punch(dem, 11);
  const TinLines lines{{{{5.5, 3.2}, {2090.3, 55.9}}, {{2090.1, 2.2}, {7.7, 57.3}}, {{1049, 10.25}, {1049, 50.75}}, {{1000, 30}, {1100, 30}}, {{1048.99999, 3}, {1049.00001, 9}}}, {}};
  const Tin tin = tin_of(dem, lines);
  expect_sound(tin, dem, 5);
  const EdgeIndex edges(tin.mesh);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(edges.covered(lines.breaklines[i][0], lines.breaklines[i][1]), length_over_valid(dem, lines.breaklines[i][0], lines.breaklines[i][1]), 0.5);
}

TEST(TinLines, AreTheSameForAnyNumberOfThreads) {
  Raster<float> dem = terrain(2100, 60);
  punch(dem, 11);
  TinLines lines = soup(4, 30, 2100, 60);
  lines.boundary = {{{5.5, 3.3}, {2080.2, 10.1}, {1500.3, 57.7}, {5.5, 3.3}}};
  const Tin one = tin_of(dem, lines, 5, 1), three = tin_of(dem, lines, 5, 3);
  EXPECT_EQ(triangles_of(one.mesh), triangles_of(three.mesh));
  const auto a = sorted_vertices(one), b = sorted_vertices(three);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_TRUE(a[i].x == b[i].x && a[i].y == b[i].y && a[i].z == b[i].z);
}

TEST(TinLines, MeshesSoupsOfLines) {
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    SCOPED_TRACE(seed);
    Raster<float> dem = terrain(70, 50);
    if (seed % 2 == 0) punch(dem, seed);
    const TinLines lines = soup(seed, 40, 70, 50);
    const Tin tin = tin_of(dem, lines, seed % 3 == 0 ? 0.5 : 5);
    expect_sound(tin, dem, seed % 3 == 0 ? 0.5 : 5);
    if (seed % 2 == 1) expect_kept(tin, dem, lines);
  }
}

TEST(TinLines, MeshesSoupsAcrossTiles) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    Raster<float> dem = terrain(1600, 40);
    if (seed % 2 == 0) punch(dem, seed);
    TinLines lines = soup(seed, 25, 1600, 40);
    for (RasterLine& line : soup(seed + 100, 20, 20, 40).breaklines) {
      for (RasterPlace& p : line) p[0] += 789;  // about the border between the tiles, column 799
      lines.breaklines.push_back(line);
    }
    expect_sound(tin_of(dem, lines), dem, 5);
  }
}

TEST(TinLines, MeshesTerrainThatIsSteepBesideLines) {
  Raster<float> dem(80, 80);
  for (std::int64_t y = 0; y < 80; ++y)
    for (std::int64_t x = 0; x < 80; ++x) dem(x, y) = static_cast<float>(9000 * uniform_at(9, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
  const TinLines lines = soup(77, 60, 80, 80);
  for (const double error : {0.01, 1.0, 500.0}) expect_sound(tin_of(dem, lines, error), dem, error);
}

TEST(TinBoundary, HasTheAreaOfThePolygon) {
  const Raster<float> dem = terrain(120, 90);
  const RasterLine outer{{5.3, 4.1}, {110.7, 9.9}, {90.1, 80.3}, {40.4, 50.6}, {8.8, 85.2}, {5.3, 4.1}};
  const RasterLine hole{{30.2, 20.2}, {60.7, 25.1}, {45.5, 40.9}, {30.2, 20.2}}, island{{40.1, 25.2}, {50.3, 27.4}, {44.4, 33.3}, {40.1, 25.2}};
  const Tin tin = tin_of(dem, {{}, {outer, hole, island}});
  expect_sound(tin, dem, 5, true);
  const double wanted = area_of(outer) - area_of(hole) + area_of(island);
  EXPECT_NEAR(area_of(tin.mesh) / wanted, 1, 1e-6);
}

TEST(TinBoundary, HasTheAreaOfThePolygonAcrossTiles) {
  const Raster<float> dem = terrain(2100, 60);
  const RasterLine outer{{5.3, 4.1}, {2090.7, 9.9}, {1700.1, 58.3}, {1400.4, 20.6}, {8.8, 55.2}, {5.3, 4.1}};
  const RasterLine hole{{1030.2, 10.2}, {1060.7, 20.1}, {1045.5, 22.9}, {1030.2, 10.2}};
  const Tin tin = tin_of(dem, {{}, {outer, hole}});
  expect_sound(tin, dem, 5, true);
  EXPECT_NEAR(area_of(tin.mesh) / (area_of(outer) - area_of(hole)), 1, 1e-6);
}

TEST(TinBoundary, IsCutAtTheOutermostCentres) {
  const Raster<float> dem = terrain(40, 30);
  const Tin all = tin_of(dem, {{}, {{{-100, -100}, {200, -100}, {200, 200}, {-100, 200}, {-100, -100}}}});
  expect_sound(all, dem, 5);
  EXPECT_EQ(area_of(all.mesh), 39.0 * 29.0);
  const Tin right = tin_of(dem, {{}, {{{20.25, -100}, {200, -100}, {200, 200}, {20.25, 200}, {20.25, -100}}}});
  expect_sound(right, dem, 5, true);
  EXPECT_NEAR(area_of(right.mesh), 18.75 * 29, 1e-3);
}

TEST(TinBoundary, MayTouchABorderOfTilesInAPointOrAlongIt) {
  const Raster<float> dem = terrain(2100, 60);  // tiles meet in column 1049
  const Tin point = tin_of(dem, {{}, {{{1049, 20}, {1100.3, 5.2}, {1100.3, 40.2}, {1049, 20}}, {{1049, 20}, {990.2, 10.2}, {992.3, 33.3}, {1049, 20}}}});
  expect_sound(point, dem, 5, true);
  const Tin fans = tin_of(dem, {{}, {{{1049, 20}, {1100.3, 5.2}, {1100.3, 15.2}, {1049, 20}}, {{1049, 20}, {1100.3, 25.2}, {1100.3, 40.2}, {1049, 20}}, {{1049, 10}, {1000, 20}, {1049, 30}, {1049, 10}}}});
  expect_sound(fans, dem, 5, true);
  const RasterLine right{{1049, 10}, {1080, 10}, {1080, 40}, {1049, 40}, {1049, 10}};
  const Tin along = tin_of(dem, {{}, {right}});
  expect_sound(along, dem, 5, true);
  EXPECT_EQ(along.report.cells, 32 * 31);
  const RasterLine left{{1049, 10}, {1000, 10}, {1000, 40}, {1049, 40}, {1049, 10}};
  const Tin before = tin_of(dem, {{}, {left}});
  std::vector<std::string> faults;
  check(before, dem, 5, true, &faults);
  EXPECT_THAT(faults, IsEmpty());
  EXPECT_EQ(area_of(before.mesh), 49.0 * 30);
}

TEST(TinBoundary, MeetsVoidsAndLines) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Raster<float> dem = terrain(70, 50);
    punch(dem, seed);
    TinLines lines = soup(seed, 15, 70, 50);
    RasterLine ring;
    for (int k = 0; k < 40; ++k) {
      const double turn = 2 * M_PI * k / 40, radius = 12 + 12 * uniform_at(seed, static_cast<std::uint64_t>(k), 2);
      ring.push_back({35 + 1.4 * radius * std::cos(turn), 25 + radius * std::sin(turn)});
    }
    ring.push_back(ring.front());
    lines.boundary = {ring, {{30.5, 20}, {36, 20}, {36, 24.5}, {30.5, 24.5}, {30.5, 20}}};
    expect_sound(tin_of(dem, lines, 2), dem, 2, true);
  }
}

TEST(TinBoundary, NeedsCellsInside) {
  const Raster<float> dem = terrain(40, 30);
  EXPECT_THROW(tin_of(dem, {{}, {{{100, 100}, {110, 100}, {100, 110}, {100, 100}}}}), Error);
}

}  // namespace
}  // namespace arete
