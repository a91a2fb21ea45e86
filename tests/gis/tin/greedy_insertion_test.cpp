#include "gis/tin/greedy_insertion.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/gis/tin/tile_rasters.h"

namespace arete {
namespace {

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

TEST(InsertGreedily, VerticesInsideAreCellsAtTheirElevation) {
  const Raster<float> cells = short_cells();
  const TileMesh mesh = inserted(cells.view(), {2, 1.0 / 1024, {}});
  int inside = 0;
  for (std::int32_t v = 0; v < mesh.vertices(); ++v) {
    if (mesh.held[v]) continue;
    ++inside;
    ASSERT_EQ(mesh.x[v] % mesh.units, 0);
    ASSERT_EQ(mesh.y[v] % mesh.units, 0);
    EXPECT_EQ(mesh.z[v], cells(mesh.x[v] / mesh.units, mesh.y[v] / mesh.units));
  }
  EXPECT_GT(inside, 100);
}

TEST(InsertGreedily, StaysDelaunay) {
  const Raster<float> cells = short_cells();
  const TileMesh mesh = inserted(cells.view(), {8, 1.0 / 1024, {}});
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    const std::int32_t twin = mesh.twin[h];
    if (twin < 0) continue;
    EXPECT_FALSE(in_circle(mesh, mesh.origin[h], mesh.origin[next_edge(h)], mesh.origin[previous_edge(h)], mesh.origin[previous_edge(twin)]));
  }
}

TEST(InsertGreedily, AnErrorThatIsTheBoundIsWithinIt) {
  Raster<float> cells(9, 7, 100.0f);
  cells(5, 3) = 103;
  EXPECT_EQ(inserted(cells.view(), {3, 1.0 / 1024, {}}).triangles(), 2);
  EXPECT_EQ(inserted(cells.view(), {std::nextafter(3.0f, 0.0f), 1.0 / 1024, {}}).vertices(), 5);  // the spike lifts no other by 3
}

TEST(InsertGreedily, SplitsEdgesThatAreTooLong) {
  const Raster<float> cells(200, 150, 5.0f);
  TileBound bound{1, 1.0 / 1024, {}};
  bound.displacement.longest_cells = 20;
  const TileMesh mesh = inserted(cells.view(), bound);
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    const std::int32_t a = mesh.origin[h], b = mesh.origin[next_edge(h)];
    if (mesh.held[a] || mesh.held[b]) continue;
    EXPECT_LE(std::hypot(mesh.x[a] - mesh.x[b], mesh.y[a] - mesh.y[b]), 20 * mesh.units);
  }
  EXPECT_GT(mesh.triangles(), 200 * 150 / (20 * 20));
}

TEST(InsertGreedily, SaysThatTerrainIsTooSteep) {
  Raster<float> cells(9, 7, 100.0f);
  cells(5, 3) = 300;
  TileBound bound{1, 1.0 / 1024, {}};
  bound.displacement.rounding_cells = 0.1;  // 20 m beside the spike
  EXPECT_THROW(inserted(cells.view(), bound), TooSteep);
  bound.displacement.rounding_cells = 0.001;  // 0.4 m along its steepest triangles
  EXPECT_EQ(triangles_beyond(inserted(cells.view(), bound), cells.view(), bound), 0);
}

}  // namespace
}  // namespace arete
