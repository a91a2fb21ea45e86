#include "shaders/mesh_border.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

namespace arete {
namespace {

/// A mesh of the unit cells of a grid, two triangles each, but for those left out. y grows to the north.
TriangleMesh mesh_of_cells(std::uint32_t width, std::uint32_t height, const std::set<std::pair<std::uint32_t, std::uint32_t>>& without) {
  TriangleMesh mesh;
  for (std::uint32_t y = 0; y <= height; ++y)
    for (std::uint32_t x = 0; x <= width; ++x) mesh.vertices.push_back({static_cast<double>(x), static_cast<double>(y), 1});
  const auto at = [&](std::uint32_t x, std::uint32_t y) { return y * (width + 1) + x; };
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      if (without.count({x, y})) continue;
      mesh.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  return mesh;
}

std::int64_t count_holes(const std::vector<BorderSide>& border) {
  return std::count_if(border.begin(), border.end(), [](const BorderSide& side) { return side.hole; });
}

TEST(MeshBorder, ATriangleIsItsOwnBorder) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(find_border(mesh), (std::vector<BorderSide>{{0, 1}, {1, 2}, {2, 0}}));
}

TEST(MeshBorder, TheBorderGoesRoundOnceWithTheMeshOnItsLeft) {
  const TriangleMesh mesh = mesh_of_cells(5, 3, {});
  const std::vector<BorderSide> border = find_border(mesh);
  ASSERT_EQ(border.size(), 16u);
  double twice_area = 0;
  for (std::size_t i = 0; i < border.size(); ++i) {
    EXPECT_EQ(border[i].to, border[(i + 1) % border.size()].from);
    EXPECT_FALSE(border[i].hole);
    const Point3 &a = mesh.vertices[border[i].from], &b = mesh.vertices[border[i].to];
    twice_area += a[0] * b[1] - a[1] * b[0];
  }
  EXPECT_EQ(twice_area, 2 * 5 * 3);
}

TEST(MeshBorder, AHoleIsToldFromTheBorderAround) {
  EXPECT_EQ(count_holes(find_border(mesh_of_cells(5, 5, {{2, 2}, {2, 3}}))), 6);
  // Open to the side: a bay.
  EXPECT_EQ(count_holes(find_border(mesh_of_cells(5, 5, {{2, 2}, {2, 3}, {2, 4}}))), 0);
}

TEST(MeshBorder, HolesAreCoveredAndNothingBeyondTheBorder) {
  const TriangleMesh mesh = mesh_of_cells(8, 6, {{2, 2}, {3, 2}, {6, 4}});
  std::vector<BorderSide> border = find_border(mesh);
  // Quarters of cells, row 0 in the north.
  const Raster<std::uint8_t> cells = cells_of_holes(mesh, {{32, 24}, 0, 6, {0.25, 0.25}}, border);
  for (std::int64_t y = 0; y < 24; ++y)
    for (std::int64_t x = 0; x < 32; ++x) {
      const std::int64_t left = x / 4, south = 5 - y / 4;
      const bool hole = (south == 2 && (left == 2 || left == 3)) || (south == 4 && left == 6);
      if (hole) {
        EXPECT_EQ(cells(x, y), 1) << x << ", " << y;
      } else if (left == 4 && south < 4 && x % 4 > 0) {  // between the holes, not beside them
        EXPECT_EQ(cells(x, y), 0) << x << ", " << y;
      }
    }
  for (std::int64_t x = 0; x < 32; ++x) EXPECT_EQ(cells(x, 0) + cells(x, 23), 0);
}

TEST(MeshBorder, AnIslandInAHoleBelongsToIt) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> without;
  for (std::uint32_t y = 2; y < 7; ++y)
    for (std::uint32_t x = 2; x < 7; ++x)
      if (x != 4 || y != 4) without.insert({x, y});
  const TriangleMesh mesh = mesh_of_cells(9, 9, without);
  std::vector<BorderSide> border = find_border(mesh);
  EXPECT_EQ(count_holes(border), 20);
  cells_of_holes(mesh, {{36, 36}, 0, 9, {0.25, 0.25}}, border);
  EXPECT_EQ(count_holes(border), 24);
}

TEST(MeshBorder, AMeshWithoutHolesHasNoCellsOfThem) {
  const TriangleMesh mesh = mesh_of_cells(3, 3, {});
  std::vector<BorderSide> border = find_border(mesh);
  EXPECT_EQ(cells_of_holes(mesh, {{12, 12}, 0, 3, {0.25, 0.25}}, border).size().cells(), 0);
}

}  // namespace
}  // namespace arete
