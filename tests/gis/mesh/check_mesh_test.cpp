#include "gis/mesh/check_mesh.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/support/random.h"
#include "gis/crs.h"
#include "gis/dem_file.h"
#include "tests/data.h"
#include "tests/gis/mesh/test_mesh.h"

namespace arete {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

MeshErrors check(const TestMesh& mesh, const Raster<float>& dem, const MeshCheckOptions& options = {}, const GeoReference& geo = {},
                 const MeshFrame& frame = {}) {
  NoProgress silent;
  return check_mesh(mesh.store(), frame, ViewSource(dem.view()), geo, options, silent);
}

MeshCheckOptions within(double bound) {
  MeshCheckOptions options;
  options.max_error_m = bound;
  return options;
}

std::vector<std::string> faults(const TestMesh& mesh, const Raster<float>& dem, const MeshCheckOptions& options, const GeoReference& geo = {}) {
  return faults_of(check(mesh, dem, options, geo), options);
}

GeoReference placed_by(const std::array<double, 6>& transform) {
  GeoReference geo;
  geo.transform = transform;
  return geo;
}

/// Heights of whole metres.
Raster<float> rough(std::int64_t width, std::int64_t height) {
  Raster<float> dem(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) dem(x, y) = static_cast<float>(std::floor(200 * uniform_at(7, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y))));
  return dem;
}

Raster<float> holed(std::int64_t width, std::int64_t height) {
  Raster<float> dem = rough(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      if (uniform_at(8, static_cast<std::uint64_t>(x / 3), static_cast<std::uint64_t>(y / 2)) < 0.2) dem(x, y) = void_value;
  return dem;
}

/// What a grid mesh of that step is off, cell by cell: its squares are cut from the lower left to the upper right.
struct Expected {
  double largest = 0, squares = 0;
};
Expected expected_of_grid(const Raster<float>& dem, std::int64_t step) {
  Expected expected;
  for (std::int64_t y = 0; y < dem.height(); ++y)
    for (std::int64_t x = 0; x < dem.width(); ++x) {
      const std::int64_t left = std::min(x, dem.width() - 2) / step * step, top = std::min(y, dem.height() - 2) / step * step;
      const std::int64_t right = std::min(left + step, dem.width() - 1), bottom = std::min(top + step, dem.height() - 1);
      const double u = static_cast<double>(x - left) / static_cast<double>(right - left), v = static_cast<double>(y - top) / static_cast<double>(bottom - top);
      const double a = static_cast<double>(dem(left, top)), b = static_cast<double>(dem(right, top)), c = static_cast<double>(dem(left, bottom)),
                   d = static_cast<double>(dem(right, bottom));
      const double z = u + v <= 1 ? a + u * (b - a) + v * (c - a) : d + (1 - u) * (c - d) + (1 - v) * (b - d);
      const double error = std::fabs(z - static_cast<double>(dem(x, y)));
      expected.largest = std::max(expected.largest, error);
      expected.squares += error * error;
    }
  return expected;
}

TEST(CheckMesh, MeasuresAGridAsInterpolationByHandDoes) {
  const Raster<float> dem = rough(601, 333);
  for (const std::int64_t step : {1, 3, 8, 250}) {
    const MeshErrors errors = check(grid_mesh(dem.view(), step), dem);
    const Expected expected = expected_of_grid(dem, step);
    EXPECT_NEAR(errors.max_error_m, expected.largest, 1e-10) << step;
    EXPECT_NEAR(errors.rmse_m, std::sqrt(expected.squares / (601 * 333)), 1e-10) << step;
    EXPECT_EQ(errors.compared_cells, 601 * 333);
    EXPECT_EQ(errors.valid_cells, 601 * 333);
    EXPECT_EQ(errors.domain_cells, 600 * 332);
    EXPECT_EQ(errors.area_sign, 0);
    EXPECT_THAT(faults_of(errors, {}), IsEmpty());
  }
}

TEST(CheckMesh, SaysWhereTheLargestErrorIs) {
  Raster<float> dem(40, 30, 5.0f);
  const GeoReference geo = placed_by({1000, 10, 0, 2000, 0, -10});
  const TestMesh mesh = grid_mesh(dem.view(), 6, geo);
  dem(17, 22) = 9;
  dem(18, 22) = 1;
  dem(16, 23) = 9;
  const MeshErrors errors = check(mesh, dem, within(3), geo);
  EXPECT_EQ(errors.max_error_m, 4);
  EXPECT_EQ(errors.max_column, 17);
  EXPECT_EQ(errors.max_row, 22);
  EXPECT_EQ(errors.max_x, 1175);
  EXPECT_EQ(errors.max_y, 1775);
  EXPECT_EQ(errors.violations.count, 3);
  EXPECT_THAT(faults_of(errors, within(3)), ElementsAre("3 cells are further off than 3 m, first column 17, row 22"));
  EXPECT_DOUBLE_EQ(errors.rmse_m, std::sqrt(48.0 / 1200));
  EXPECT_DOUBLE_EQ(errors.psnr_db(), 20 * std::log10(8 / std::sqrt(48.0 / 1200)));
}

// Guarantee 2: thirds have no double, and yet an error of the bound is kept and one of a hair more is not.
TEST(CheckMesh, AnErrorOfExactlyTheBoundIsKept) {
  Raster<float> dem(4, 2, 0.0f);
  TestMesh mesh = grid_mesh(Raster<float>(4, 2, 0.0f).view(), 3);
  mesh.vertices[1].z = mesh.vertices[3].z = 0.1;  // at columns 1 and 2 the mesh is at 1/3 and 2/3 of it
  const double third = 0.1 / 3, two_thirds = 0.1 * 2 / 3;
  dem(3, 0) = dem(3, 1) = 0.1f;
  for (double bound = std::nextafter(two_thirds, 0), i = 0; i < 3; ++i, bound = std::nextafter(bound, 1)) {
    // The height is 2 x z / 3 exactly where the doubles are integers: long double has room for 3 x bound.
    const bool kept = 2 * static_cast<long double>(0.1) <= 3 * static_cast<long double>(bound);
    const MeshErrors errors = check(mesh, dem, within(bound));
    EXPECT_EQ(errors.violations.count, kept ? 0 : 2) << i;
    EXPECT_EQ(errors.max_error_m <= bound, kept) << i;
  }
  EXPECT_EQ(check(mesh, dem, within(third)).violations.count, 2 + 2 * (static_cast<long double>(0.1) > 3 * static_cast<long double>(third)));
}

TEST(CheckMesh, AWholeNumberOfMetresIsKeptAndAHairMoreIsNot) {
  Raster<float> dem = rough(50, 40);
  TestMesh mesh = grid_mesh(dem.view(), 1);
  const auto v = static_cast<std::size_t>(mesh.at(20.5, -10.5));
  mesh.vertices[v].z += 10;
  EXPECT_THAT(faults(mesh, dem, within(10)), IsEmpty());
  mesh.vertices[v].z = std::nextafter(mesh.vertices[v].z, 1e9);
  EXPECT_THAT(faults(mesh, dem, within(10)), ElementsAre("1 cells are further off than 10 m, first column 20, row 10"));
  mesh.vertices[v].z = static_cast<double>(dem(20, 10)) - 10;
  EXPECT_THAT(faults(mesh, dem, within(10)), IsEmpty());
  mesh.vertices[v].z = std::nextafter(mesh.vertices[v].z, -1e9);
  EXPECT_THAT(faults(mesh, dem, within(10)), ElementsAre("1 cells are further off than 10 m, first column 20, row 10"));
}

TEST(CheckMesh, ABoundOf0IsKeptByEveryCellExactly) {
  const Raster<float> dem = rough(300, 280);
  EXPECT_THAT(faults(grid_mesh(dem.view(), 1), dem, within(0)), IsEmpty());
  TestMesh mesh = grid_mesh(dem.view(), 1);
  mesh.vertices[777].z = std::nextafter(mesh.vertices[777].z, 1e9);
  EXPECT_EQ(check(mesh, dem, within(0)).violations.count, 1);
}

TEST(CheckMesh, TheDomainIsThatOfTheValidCells) {
  for (const auto& [width, height] : {std::pair<std::int64_t, std::int64_t>{40, 30}, {300, 270}, {2, 2}}) {
    const Raster<float> dem = holed(width, height);
    const MeshErrors errors = check(quarter_mesh(dem.view()), dem, within(0));
    EXPECT_THAT(faults_of(errors, within(0)), IsEmpty()) << width;
    EXPECT_EQ(errors.compared_cells, errors.valid_cells);
    EXPECT_EQ(errors.max_error_m, errors.valid_cells > 0 ? 0 : errors.max_error_m);
  }
}

TEST(CheckMesh, FindsAMissingTriangle) {
  const Raster<float> dem = rough(50, 40);
  TestMesh mesh = grid_mesh(dem.view(), 7);
  mesh.triangles.erase(mesh.triangles.begin() + 21);
  const MeshErrors errors = check(mesh, dem);
  EXPECT_EQ(errors.uncovered.count, 15);  // strictly inside a triangle of 7 x 7 / 2
  EXPECT_EQ(errors.area_sign, -1);
  EXPECT_EQ(errors.domain_cells - errors.area_cells, 24.5);
  EXPECT_THAT(faults_of(errors, {}), ElementsAre(HasSubstr("15 cells are valid and in no triangle"), HasSubstr("the triangles cover 1886.5 cells, the valid cells of the DEM 1911")));
  MeshCheckOptions clipped;
  clipped.allow_uncovered = true;
  EXPECT_THAT(faults_of(errors, clipped), IsEmpty());
}

TEST(CheckMesh, FindsATriangleOverAVoid) {
  Raster<float> dem = rough(50, 40);
  const TestMesh mesh = grid_mesh(dem.view(), 7);
  dem(10, 10) = void_value;
  const MeshErrors errors = check(mesh, dem);
  EXPECT_EQ(errors.covered_voids.count, 1);
  EXPECT_EQ(errors.covered_voids.column, 10);
  EXPECT_THAT(faults_of(errors, {}), ElementsAre("1 cells are void and in a triangle, first column 10, row 10",
                                                 "the triangles cover 1911 cells, the valid cells of the DEM 1910"));
}

TEST(CheckMesh, FindsATriangleThatReachesIntoAVoidBesideItsCentre) {
  Raster<float> dem = rough(20, 20);
  dem(10, 10) = void_value;
  TestMesh mesh = quarter_mesh(dem.view());
  const std::int64_t a = mesh.at(10, -10), b = mesh.at(11, -10);
  mesh.vertices.push_back({10.5, -10.25, 0});
  mesh.triangles.push_back({a, static_cast<std::int64_t>(mesh.vertices.size()) - 1, b});
  const MeshErrors errors = check(mesh, dem);
  EXPECT_EQ(errors.covered_voids.count, 0);
  EXPECT_EQ(errors.area_cells - errors.domain_cells, 0.125);
  MeshCheckOptions clipped;
  clipped.allow_uncovered = true;
  EXPECT_THAT(faults_of(errors, clipped), testing::Contains(HasSubstr("the triangles cover 360.125 cells")));
}

TEST(CheckMesh, FindsAFold) {
  const Raster<float> dem = rough(50, 40);
  TestMesh mesh = grid_mesh(dem.view(), 7);
  // A vertex pulled over its neighbours.
  mesh.vertices[static_cast<std::size_t>(mesh.at(14.5, -14.5))].x += 9;
  const MeshErrors errors = check(mesh, dem);
  EXPECT_GT(errors.folds.count, 5);
  EXPECT_GT(errors.clockwise.count, 0);
  EXPECT_EQ(errors.area_sign, 1);
  EXPECT_EQ(errors.uncovered.count, 0);
  EXPECT_THAT(faults_of(errors, {}), testing::Contains(HasSubstr("cells lie inside two triangles")));
}

TEST(CheckMesh, FindsADuplicatedTriangle) {
  const Raster<float> dem = rough(50, 40);
  TestMesh mesh = grid_mesh(dem.view(), 7);
  mesh.triangles.push_back(mesh.triangles[20]);
  const MeshErrors errors = check(mesh, dem);
  EXPECT_EQ(errors.folds.count, 15);
  EXPECT_EQ(errors.topology.non_manifold_edges, 3);
  EXPECT_EQ(errors.compared_cells, 2000);
  EXPECT_THAT(faults_of(errors, {}), ElementsAre(HasSubstr("15 cells lie inside two triangles"), HasSubstr("1935.5 cells"), "3 edges are not manifold"));
}

TEST(CheckMesh, FindsAFlippedTriangle) {
  const Raster<float> dem = rough(50, 40);
  TestMesh mesh = grid_mesh(dem.view(), 7);
  std::swap(mesh.triangles[20][0], mesh.triangles[20][1]);
  EXPECT_THAT(faults(mesh, dem, {}), ElementsAre("1 triangles are clockwise, first 20", "3 edges are not manifold"));
}

TEST(CheckMesh, FindsADegenerateTriangle) {
  const Raster<float> dem = rough(50, 40);
  TestMesh mesh = grid_mesh(dem.view(), 7);
  mesh.triangles.push_back({0, 1, 2});
  EXPECT_THAT(faults(mesh, dem, {}), testing::Contains("1 triangles have no area, first 84"));
}

TEST(CheckMesh, FindsATJunction) {
  const Raster<float> dem(50, 40, 3.0f);
  TestMesh mesh = grid_mesh(dem.view(), 7);
  // Triangle 21 is cut in two through the middle of its first side; the neighbour is not.
  const MeshTriangle t = mesh.triangles[21];
  const MeshVertex &a = mesh.vertices[static_cast<std::size_t>(t[0])], &b = mesh.vertices[static_cast<std::size_t>(t[1])];
  mesh.vertices.push_back({(a.x + b.x) / 2, (a.y + b.y) / 2, 3});
  const auto middle = static_cast<std::int64_t>(mesh.vertices.size()) - 1;
  mesh.triangles[21] = {t[0], middle, t[2]};
  mesh.triangles.push_back({middle, t[1], t[2]});
  const MeshErrors errors = check(mesh, dem, within(0));
  EXPECT_EQ(errors.t_junctions.count, 1);
  EXPECT_EQ(errors.t_junctions.first, middle);
  EXPECT_THAT(faults_of(errors, within(0)), ElementsAre(HasSubstr("1 vertices lie inside an edge of the border")));
}

TEST(CheckMesh, FindsATriangleCutLoose) {
  const Raster<float> dem = rough(50, 40);
  TestMesh mesh = grid_mesh(dem.view(), 7);
  mesh.vertices.push_back(mesh.vertices[18]);
  const auto loose = std::find_if(mesh.triangles.begin(), mesh.triangles.end(), [](const MeshTriangle& t) { return std::count(t.begin(), t.end(), 18) > 0; });
  for (std::int64_t& vertex : *loose)
    if (vertex == 18) vertex = static_cast<std::int64_t>(mesh.vertices.size()) - 1;
  EXPECT_THAT(faults(mesh, dem, {}), ElementsAre(HasSubstr("2 edges of the border lie on another's place")));
}

TEST(CheckMesh, FindsAVertexOutside) {
  const Raster<float> dem = rough(50, 40);
  TestMesh mesh = grid_mesh(dem.view(), 7);
  mesh.vertices[8].x += 0.5;
  MeshCheckOptions clipped;
  clipped.allow_uncovered = true;
  EXPECT_THAT(faults(mesh, dem, clipped), IsEmpty());
  mesh.vertices[7].x += 0.01;  // the last of the upper side
  EXPECT_THAT(faults(mesh, dem, clipped), ElementsAre("1 vertices lie outside the DEM, first 7"));
}

TEST(CheckMesh, RefusesVerticesThatAreNotThere) {
  const Raster<float> dem = rough(8, 8);
  TestMesh mesh = grid_mesh(dem.view(), 7);
  mesh.triangles[1][2] = 4;
  EXPECT_THROW(check(mesh, dem), Error);
}

/// Fans about vertices anywhere: no cell on their edges may fall between two triangles, and none lie in both.
TEST(CheckMesh, CellsOnEdgesOfAnyDirectionAreMissedByNone) {
  const Raster<float> dem = rough(64, 64);
  for (std::uint64_t i = 0; i < 60; ++i) {
    TestMesh mesh;
    const double x = 1 + 61 * uniform_at(1, i), y = 1 + 61 * uniform_at(2, i);
    mesh.vertices.push_back({x, -y, 0});
    // A ring along the border, every step-th cell.
    const std::int64_t step = i % 3 == 0 ? 63 : i % 3 == 1 ? 7 : 1;
    for (std::int64_t k = 0; k < 63; k += step) mesh.vertices.push_back(place({}, 0, static_cast<double>(k), 5));
    for (std::int64_t k = 0; k < 63; k += step) mesh.vertices.push_back(place({}, static_cast<double>(k), 63, 5));
    for (std::int64_t k = 63; k > 0; k -= step) mesh.vertices.push_back(place({}, 63, static_cast<double>(k), 5));
    for (std::int64_t k = 63; k > 0; k -= step) mesh.vertices.push_back(place({}, static_cast<double>(k), 0, 5));
    const auto ring = static_cast<std::int64_t>(mesh.vertices.size()) - 1;
    for (std::int64_t k = 0; k < ring; ++k) mesh.triangles.push_back({0, 1 + k, 1 + (k + 1) % ring});
    if (i % 2 == 0) mesh.vertices[0] = place({}, std::round(x), std::round(y), 5);
    const MeshErrors errors = check(mesh, dem);
    EXPECT_THAT(faults_of(errors, {}), IsEmpty()) << i;
    EXPECT_EQ(errors.compared_cells, 64 * 64);
  }
}

TEST(CheckMesh, IsTheSameForAnyMemory) {
  const Raster<float> dem = rough(900, 700);
  TestMesh mesh = grid_mesh(dem.view(), 5);
  mesh.vertices[3000].x += 7;
  mesh.triangles.erase(mesh.triangles.begin() + 40000, mesh.triangles.begin() + 40100);
  MeshCheckOptions small = within(90);
  small.scratch.memory_bytes = 1 << 18;
  small.scratch.folder = testing::TempDir();
  const MeshErrors one = check(mesh, dem, within(90)), other = check(mesh, dem, small);
  EXPECT_FALSE(faults_of(one, small).empty());
  EXPECT_EQ(faults_of(one, small), faults_of(other, small));
  EXPECT_EQ(one.max_error_m, other.max_error_m);
  EXPECT_EQ(one.max_column, other.max_column);
  EXPECT_EQ(one.rmse_m, other.rmse_m);
  EXPECT_EQ(one.topology.border_edges, other.topology.border_edges);
  EXPECT_EQ(one.topology.edges, other.topology.edges);
}

TEST(CheckMesh, AMeshWithoutTrianglesCoversNothing) {
  const Raster<float> dem = rough(5, 5);
  const MeshErrors errors = check({}, dem, within(1));
  EXPECT_TRUE(std::isnan(errors.max_error_m));
  EXPECT_THAT(faults_of(errors, within(1)), ElementsAre(HasSubstr("25 cells are valid"), "the triangles cover 0 cells, the valid cells of the DEM 16"));
}

TEST(CheckMesh, AMirroredRasterTurnsNoTriangle) {
  const Raster<float> dem = rough(30, 20);
  const GeoReference geo = placed_by({1000, -10, 0, 2000, 0, -10});
  TestMesh mesh = grid_mesh(dem.view(), 3, geo);
  EXPECT_EQ(check(mesh, dem, {}, geo).clockwise.count, static_cast<std::int64_t>(mesh.triangles.size()));
  for (MeshTriangle& t : mesh.triangles) std::swap(t[0], t[1]);
  EXPECT_THAT(faults(mesh, dem, {}, geo), IsEmpty());
}

TEST(CheckMesh, MeasuresRealDems) {
  for (const char* name : {"davosdorf_dtm_10m.tif", "davos_srtm1_1arcsec.tif", "greenriver_lidar_1m.tif"}) {
    const std::string path = test_data(name);
    if (path.empty()) GTEST_SKIP() << "no development data: set ARETE_TEST_DATA";
    const DemReader reader(path);
    const Raster<float> dem = read_all(reader);
    const Expected expected = expected_of_grid(dem, 8);
    const MeshErrors errors = check(grid_mesh(dem.view(), 8, reader.georeference()), dem, {}, reader.georeference());
    EXPECT_THAT(faults_of(errors, {}), IsEmpty()) << name;
    EXPECT_NEAR(errors.max_error_m, expected.largest, 1e-9);
    EXPECT_NEAR(errors.rmse_m, std::sqrt(expected.squares / static_cast<double>(dem.size().cells())), 1e-9);
  }
}

TEST(CheckMesh, TheDomainOfRealVoidsIsExact) {
  const std::string path = test_data("inyo_srtm_30m_utm11_nan.tif");
  if (path.empty()) GTEST_SKIP() << "no development data: set ARETE_TEST_DATA";
  const DemReader reader(path);
  const Raster<float> dem = read_all(reader);
  const MeshErrors errors = check(quarter_mesh(dem.view(), reader.georeference()), dem, within(0), reader.georeference());
  EXPECT_THAT(faults_of(errors, within(0)), IsEmpty());
  EXPECT_LT(errors.valid_cells, errors.cells / 2);
}

}  // namespace
}  // namespace arete
