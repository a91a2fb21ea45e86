#include "gis/tin/tile_domain.h"

#include <cmath>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/gis/tin/tile_rasters.h"

namespace arete {
namespace {

constexpr double step = 1.0 / 1024;

TileMesh domain_of(const Raster<float>& cells, double bound = 1000) { return triangulate_domain(cells.view(), border_of(cells.view(), bound), step); }

/// Twice the area of the squares of the valid cells, cut at the centres of the outer ones, in square units of two to a cell.
std::int64_t twice_valid_area(const Raster<float>& cells) {
  std::int64_t sum = 0;
  const auto half = [](std::int64_t i, std::int64_t count) { return i == 0 || i + 1 == count ? 1 : 2; };
  for (std::int64_t y = 0; y < cells.size().height; ++y)
    for (std::int64_t x = 0; x < cells.size().width; ++x)
      if (!is_void(cells(x, y))) sum += 2 * half(x, cells.size().width) * half(y, cells.size().height);
  return sum;
}

/// Twins name each other, no edge is there twice, each vertex has one fan of triangles; the area is that of the valid cells, exactly.
void expect_covers_the_valid_cells(const TileMesh& mesh, const Raster<float>& cells) {
  std::int64_t area = 0;
  std::set<std::pair<std::int32_t, std::int32_t>> edges;
  std::vector<int> borders(mesh.x.size(), 0);
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    const std::int32_t a = mesh.origin[h], b = mesh.origin[next_edge(h)], twin = mesh.twin[h];
    EXPECT_TRUE(edges.insert({a, b}).second);
    if (h % 3 == 0) {
      const std::int64_t turn = orientation(mesh, a, b, mesh.origin[h + 2]);
      EXPECT_GT(turn, 0);
      area += turn;
    }
    if (twin < 0) {
      EXPECT_EQ(++borders[a], 1);
      continue;
    }
    ASSERT_EQ(mesh.twin[twin], h);
    EXPECT_EQ(mesh.origin[twin], b);
  }
  for (const std::uint8_t held : mesh.held) EXPECT_EQ(held, 1);
  EXPECT_EQ(area, twice_valid_area(cells));
}

TEST(TriangulateDomain, AValidTileIsItsBorder) {
  const Raster<float> cells(12, 9, 4.0f);
  const TileMesh mesh = domain_of(cells);
  EXPECT_EQ(mesh.triangles(), 2);
  expect_covers_the_valid_cells(mesh, cells);
}

TEST(TriangulateDomain, CoversTheValidCellsExactly) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const auto side = [&](std::uint64_t i) { return 2 + static_cast<std::int64_t>(uniform_at(seed, i) * 18); };
    Raster<float> cells = noisy_waves(side(0), side(1), 20);
    const double share = uniform_at(seed, 2);
    for (std::int64_t i = 0; i < cells.size().cells(); ++i)
      if (uniform_at(seed, 10 + static_cast<std::uint64_t>(i)) < share) cells.data()[i] = void_value;
    expect_covers_the_valid_cells(domain_of(cells, 5), cells);
  }
}

TEST(TriangulateDomain, ACheckerboardIsAManifold) {
  for (const std::int64_t first : {0, 1}) {
    Raster<float> cells(9, 8, void_value);
    int squares = 0;
    for (std::int64_t y = 0; y < 8; ++y)
      for (std::int64_t x = 0; x < 9; ++x)
        if ((x + y) % 2 == first) cells(x, y) = static_cast<float>(x), ++squares;
    const TileMesh mesh = domain_of(cells);
    EXPECT_GE(mesh.triangles(), 2 * squares);
    EXPECT_GE(mesh.vertices(), 4 * squares);  // none is shared
    expect_covers_the_valid_cells(mesh, cells);
  }
}

TEST(TriangulateDomain, CornersOfVoidsAreAtTheMeanOfTheirCells) {
  Raster<float> cells(9, 9, 10.0f);
  cells(4, 4) = void_value;
  cells(3, 4) = 16;
  const TileMesh mesh = domain_of(cells);
  int corners = 0;
  for (std::int32_t v = 0; v < mesh.vertices(); ++v) {
    if (mesh.x[v] != 7 || (mesh.y[v] != 7 && mesh.y[v] != 9)) continue;
    EXPECT_EQ(mesh.z[v], 12);  // of 10, 10 and 16
    ++corners;
  }
  EXPECT_EQ(corners, 2);
  EXPECT_EQ(corner_height(cells.view(), 3, 3, step), 12);
  EXPECT_EQ(corner_height(cells.view(), 0, 0, step), 10);
}

TEST(TriangulateDomain, AnIslandOfOneCellIsTwoTriangles) {
  Raster<float> cells(9, 9, void_value);
  cells(4, 4) = 7;
  const TileMesh mesh = domain_of(cells);
  EXPECT_EQ(mesh.triangles(), 2);
  expect_covers_the_valid_cells(mesh, cells);
}

TEST(TriangulateDomain, VoidsAloneAreNothing) {
  const TileMesh mesh = domain_of(Raster<float>(9, 9, void_value));
  EXPECT_EQ(mesh.triangles(), 0);
  EXPECT_EQ(mesh.vertices(), 0);
}

TEST(TriangulateDomain, SidesAlongVoidsAreNoLongerThanAllowed) {
  Raster<float> cells(60, 50, 5.0f);
  for (std::int64_t y = 10; y < 40; ++y)
    for (std::int64_t x = 0; x < 45; ++x) cells(x, y) = void_value;
  const double longest = 7.5;
  const TileMesh mesh = triangulate_domain(cells.view(), border_of(cells.view(), 1), step, nullptr, longest);
  expect_covers_the_valid_cells(mesh, cells);
  int sides = 0;
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    const std::int32_t a = mesh.origin[h], b = mesh.origin[next_edge(h)];
    if (mesh.twin[h] >= 0 || (mesh.x[a] % 2 == 0 && mesh.y[a] % 2 == 0) || (mesh.x[b] % 2 == 0 && mesh.y[b] % 2 == 0)) continue;
    EXPECT_LE(std::hypot(mesh.x[a] - mesh.x[b], mesh.y[a] - mesh.y[b]), longest * mesh.units);
    ++sides;
  }
  EXPECT_GE(sides, (45 + 45 + 30) / 8);
}

}  // namespace
}  // namespace arete
