#include "gis/mesh/gltf_grid.h"

#include <cmath>

#include <gtest/gtest.h>

namespace arete {
namespace {

MeshBounds box(double x, double y, double z, double width, double relief) { return {{x, y, z}, {x + width, y + width, z + relief}}; }

// A float32 has 24 bits: steps and reach are powers of two with 2^24 between them, or fewer.
TEST(GltfGrid, StepsAreExactInFloat32) {
  for (const double width : {0.0, 0.5, 10.0, 1000.0, 16000.0, 17000.0, 400000.0, 4e7})
    for (const bool draco : {false, true}) {
      const GltfGrid grid = gltf_grid(box(-2e7 + 0.1, 5212345.678, -400, width, 4000), draco);
      for (const GltfAxis& axis : grid.axes) {
        EXPECT_EQ(std::exp2(std::round(std::log2(axis.step))), axis.step);
        EXPECT_LE(axis.reach / axis.step, 1 << 24);
        EXPECT_EQ(std::fmod(axis.offset, 16), 0);
        EXPECT_EQ(static_cast<double>(static_cast<float>(axis.offset)), axis.offset);
        EXPECT_LE(axis.step, draco ? std::ldexp(1, -10) : std::ldexp(1, -11));
      }
    }
}

TEST(GltfGrid, ASmallMeshLiesInOneNodeOnAFinerGrid) {
  const GltfGrid grid = gltf_grid(box(412345.678, 5212345.678, 500, 3000, 200), false);
  for (const GltfAxis& axis : grid.axes) EXPECT_FALSE(axis.in_cells);
  EXPECT_EQ(grid.axes[0].reach, 2048);
  EXPECT_EQ(grid.axes[0].step, std::ldexp(1, -13));
  EXPECT_EQ(grid.axes[2].reach, 128);
  EXPECT_EQ(grid.axes[2].step, std::ldexp(1, -17));
}

TEST(GltfGrid, ALargeMeshLiesInCells) {
  const GltfGrid grid = gltf_grid(box(412345.678, 5212345.678, 500, 17000, 200), false);
  EXPECT_TRUE(grid.axes[0].in_cells);
  EXPECT_TRUE(grid.axes[1].in_cells);
  EXPECT_FALSE(grid.axes[2].in_cells);
  EXPECT_EQ(grid.axes[0].reach, 8192);
}

TEST(GltfGrid, DracoHasOneStepForAllAxes) {
  const GltfGrid grid = gltf_grid(box(412345.678, 5212345.678, 500, 17000, 200), true);
  for (const GltfAxis& axis : grid.axes) {
    EXPECT_EQ(axis.reach, 4096);
    EXPECT_EQ(axis.step, std::ldexp(1, -10));
  }
}

}  // namespace
}  // namespace arete
