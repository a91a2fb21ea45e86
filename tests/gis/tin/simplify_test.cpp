#include "gis/tin/simplify.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "gis/tin/greedy_insertion.h"
#include "gis/tin/split_worst.h"
#include "gis/tin/tile_domain.h"
#include "gis/tin/triangle_errors.h"
#include "tests/gis/tin/tile_rasters.h"

namespace arete {
namespace {

/// Elevations that proofs compute with: whole sixteenths.
Raster<float> short_cells() {
  Raster<float> cells = noisy_waves(120, 90, 6);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = std::round(16 * cells.data()[i]) / 16;
  return cells;
}

std::vector<Polyline> side(const TileCells& cells, bool column, std::int64_t index, double bound) {
  std::vector<float> line;
  for (std::int64_t i = 0; i < (column ? cells.height : cells.width); ++i) line.push_back(column ? cells(index, i) : cells(i, index));
  return simplify_line(line, {bound, 1.0 / 1024});
}

TileMesh inserted(const TileCells& cells, const TileBound& bound) {
  const TileBorder border{side(cells, false, 0, bound.error_m), side(cells, false, cells.height - 1, bound.error_m), side(cells, true, 0, bound.error_m),
                          side(cells, true, cells.width - 1, bound.error_m)};
  TileMesh mesh = triangulate_domain(cells, border, bound.height_step_m);
  insert_greedily(mesh, cells, bound);
  link_vertices(mesh);
  return mesh;
}

int triangles_beyond(const TileMesh& mesh, const TileCells& cells, const TileBound& bound) {
  int beyond = 0;
  for (std::int32_t t = 0; t < mesh.triangles(); ++t) {
    if (mesh.removed(t)) continue;
    const auto [a, b, c] = mesh.corners(t);
    beyond += !fit_of(mesh, cells, a, b, c, bound).keeps;
  }
  return beyond;
}

TEST(InsertGreedily, KeepsTheBoundAndStopsThere) {
  const Raster<float> cells = short_cells();
  std::int32_t before = 1 << 30;
  for (const double error : {0.5, 2.0, 8.0, 32.0}) {
    const TileBound bound{error, 1.0 / 1024, {}};
    const TileMesh mesh = inserted(cells.view(), bound);
    EXPECT_EQ(triangles_beyond(mesh, cells.view(), bound), 0);
    EXPECT_LT(mesh.triangles(), before);
    before = mesh.triangles();
  }
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
