#include "gis/tin/simplify.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "gis/tin/split_worst.h"
#include "tests/gis/tin/tile_rasters.h"

namespace arete {
namespace {

/// How many triangles have a height below a tenth of their longest edge.
int slivers(const TileMesh& mesh) {
  int count = 0;
  for (std::int32_t t = 0; t < mesh.triangles(); ++t) {
    if (mesh.removed(t)) continue;
    const auto [a, b, c] = mesh.corners(t);
    count += static_cast<double>(orientation(mesh, a, b, c)) < 0.1 * longest_squared(mesh, a, b, c);
  }
  return count;
}

TEST(Simplify, KeepsTheBoundWithFarFewerTriangles) {
  const Raster<float> cells = short_cells();
  for (const double error : {2.0, 8.0, 32.0}) {
    const TileBound bound{error, 1.0 / 1024, {}};
    TileMesh mesh = inserted(cells.view(), bound);
    const std::int32_t before = mesh.triangles();
    simplify(mesh, cells.view(), bound, 3);
    EXPECT_EQ(triangles_beyond(mesh, cells.view(), bound), 0);
    EXPECT_LT(mesh.triangles(), 0.75 * before) << error;
  }
}

TEST(Simplify, MakesNoSlivers) {
  const Raster<float> cells = short_cells();
  for (const double error : {2.0, 8.0, 32.0}) {
    const TileBound bound{error, 1.0 / 1024, {}};
    TileMesh mesh = inserted(cells.view(), bound);
    const int before = slivers(mesh);
    simplify(mesh, cells.view(), bound, 3);
    EXPECT_LE(slivers(mesh), before) << error;
  }
}

TEST(Simplify, MakesNoEdgeThatIsTooLong) {
  const Raster<float> cells = short_cells();
  TileBound bound{32, 1.0 / 1024, {}};
  bound.displacement.longest_cells = 15;
  // The sides are as long as the bound lets them be: they are none of its business.
  TileMesh mesh = inserted(cells.view(), bound);
  const std::int32_t before = mesh.triangles();
  simplify(mesh, cells.view(), bound, 3);
  EXPECT_LT(mesh.triangles(), before);
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    if (mesh.origin[h] < 0 || mesh.twin[h] < 0) continue;
    const std::int32_t a = mesh.origin[h], b = mesh.origin[next_edge(h)];
    if (mesh.held[a] || mesh.held[b]) continue;
    EXPECT_LE(std::hypot(mesh.x[a] - mesh.x[b], mesh.y[a] - mesh.y[b]), 15 * mesh.units);
  }
}

TEST(Simplify, LeavesWhatIsHeld) {
  const Raster<float> cells = short_cells();
  const TileBound bound{8, 1.0 / 1024, {}};
  TileMesh mesh = inserted(cells.view(), bound);
  std::vector<std::array<double, 3>> held, after;
  for (std::int32_t v = 0; v < mesh.vertices(); ++v) {
    if (v % 10 == 0) mesh.held[v] = 1;
    if (mesh.held[v]) held.push_back({double(mesh.x[v]), double(mesh.y[v]), mesh.z[v]});
  }
  simplify(mesh, cells.view(), bound, 3);
  for (std::int32_t v = 0; v < mesh.vertices(); ++v)
    if (mesh.held[v]) after.push_back({double(mesh.x[v]), double(mesh.y[v]), mesh.z[v]});
  std::sort(held.begin(), held.end());
  std::sort(after.begin(), after.end());
  EXPECT_EQ(held, after);
}

TEST(SplitWorst, MakesTwoTrianglesMoreEachAndKeepsTheBound) {
  const Raster<float> cells = short_cells();
  const TileBound bound{8, 1.0 / 1024, {}};
  TileMesh mesh = inserted(cells.view(), bound);
  simplify(mesh, cells.view(), bound, 3);
  const auto squares = [&] {
    double sum = 0;
    for (std::int32_t t = 0; t < mesh.triangles(); ++t) {
      const auto [a, b, c] = mesh.corners(t);
      sum += fit_of(mesh, cells.view(), a, b, c, bound).squares;
    }
    return sum;
  };
  const std::int32_t before = mesh.triangles();
  const double squares_before = squares();
  split_worst(mesh, cells.view(), bound, 5);
  EXPECT_EQ(mesh.triangles(), before + 10);
  EXPECT_EQ(triangles_beyond(mesh, cells.view(), bound), 0);
  EXPECT_LT(squares(), squares_before);
}

}  // namespace
}  // namespace arete
