#include "shaders/terrain_quadtree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/synthesis/mountains.h"
#include "core/terrain/fill_voids.h"
#include "tests/shaders/source_with_levels.h"

namespace arete {
namespace {

struct Terrain {
  explicit Terrain(Raster<float> from, std::int64_t memory_bytes = 1 << 30) : cells(std::move(from)), source(cells.view()) {
    NoProgress progress;
    overview = make_overview(source, 2, 2, 1, progress);
    fill_voids(overview.cells.view());
    pyramid = std::make_unique<SamplePyramid>(source, overview, memory_bytes, 0, 2, progress);
    tree = build_quadtree(*pyramid, 2, progress);
  }
  Raster<float> cells;
  ViewSource source;
  Overview overview;
  std::unique_ptr<SamplePyramid> pyramid;
  TerrainQuadtree tree;
};

Raster<float> plane(Size size) {
  Raster<float> cells(size.width, size.height);
  for (std::int64_t y = 0; y < size.height; ++y)
    for (std::int64_t x = 0; x < size.width; ++x) cells(x, y) = static_cast<float>(100 + 2 * x - y);
  return cells;
}

TEST(SamplePyramid, SamplesOfAllLevelsAreThoseOfTheDem) {
  const Terrain terrain(synthesize_mountains({203, 150}, {.seed = 1}));
  for (int level = 0; level < terrain.pyramid->levels(); ++level) {
    const Size size = terrain.pyramid->size(level);
    Raster<TerrainSample> samples(size.width + 2, size.height + 2);
    terrain.pyramid->read(level, {-1, -1, size.width + 2, size.height + 2}, samples.view());
    for (std::int64_t y = -1; y <= size.height; ++y)
      for (std::int64_t x = -1; x <= size.width; ++x) {
        const std::int64_t column = std::clamp<std::int64_t>(x, 0, size.width - 1) << level, row = std::clamp<std::int64_t>(y, 0, size.height - 1) << level;
        ASSERT_EQ(samples(x + 1, y + 1).height, terrain.cells(std::min<std::int64_t>(column, 202), std::min<std::int64_t>(row, 149)));
      }
  }
}

TEST(SamplePyramid, IsTheSameWhateverStaysInMemory) {
  Raster<float> cells = synthesize_mountains({300, 200}, {.seed = 2});
  for (std::int64_t x = 20; x < 90; ++x) cells(x, x) = void_value;
  for (std::int64_t y = 100; y < 140; ++y)
    for (std::int64_t x = 200; x < 260; ++x) cells(x, y) = 0;
  const Terrain kept(cells.clone()), read(cells.clone(), 0);
  for (int level = 0; level < kept.pyramid->levels(); ++level) {
    const Window window{-3, 5, 40, 30};
    Raster<TerrainSample> a(40, 30), b(40, 30);
    kept.pyramid->read(level, window, a.view());
    read.pyramid->read(level, window, b.view());
    for (std::int64_t i = 0; i < 1200; ++i) {
      ASSERT_EQ(a.data()[i].height, b.data()[i].height);
      ASSERT_EQ(a.data()[i].smooth, b.data()[i].smooth);
      ASSERT_EQ(a.data()[i].valid, b.data()[i].valid);
      ASSERT_EQ(a.data()[i].water, b.data()[i].water);
    }
  }
}

TEST(SamplePyramid, KnowsWaterAndVoids) {
  Raster<float> cells(30, 30, 5.0f);
  for (std::int64_t y = 10; y < 20; ++y)
    for (std::int64_t x = 10; x < 20; ++x) cells(x, y) = 0;
  cells(3, 3) = void_value;
  cells(25, 25) = 0;  // a single cell is no water
  const Terrain terrain(std::move(cells));
  Raster<TerrainSample> samples(30, 30);
  terrain.pyramid->read(0, {0, 0, 30, 30}, samples.view());
  for (std::int64_t y = 0; y < 30; ++y)
    for (std::int64_t x = 0; x < 30; ++x) {
      EXPECT_EQ(samples(x, y).water, x >= 10 && x < 20 && y >= 10 && y < 20 ? 1 : 0);
      EXPECT_EQ(samples(x, y).valid, x == 3 && y == 3 ? 0 : 1);
    }
  EXPECT_EQ(samples(3, 3).height, 5);
}

TEST(SamplePyramid, TakesLevelsOfTheSourceThatHasThem) {
  const SourceWithLevels source(synthesize_mountains({501, 333}, {.seed = 6}), 5);
  NoProgress progress;
  Overview overview = make_overview(source, 2, 2, 1, progress);
  fill_voids(overview.cells.view());
  source.reads.fill(0);
  const SamplePyramid pyramid(source, overview, 1 << 30, 12000, 2, progress);
  ASSERT_EQ(pyramid.base(), 2);  // 126 x 84 cells
  EXPECT_EQ(source.reads[0] + source.reads[1], 0);
  for (const int level : {0, 1, 2, 4}) {
    Raster<TerrainSample> samples(9, 7);
    pyramid.read(level, {3, 2, 9, 7}, samples.view());
    for (std::int64_t y = 0; y < 7; ++y)
      for (std::int64_t x = 0; x < 9; ++x) {
        // Above the base, samples of the base.
        const int from = std::min(level, 2);
        const std::int64_t column = std::min<std::int64_t>((3 + x) << (level - from), source.level_size(from).width - 1);
        const std::int64_t row = std::min<std::int64_t>((2 + y) << (level - from), source.level_size(from).height - 1);
        ASSERT_EQ(samples(x, y).height, source.height(from, column, row)) << level;
        if (level <= 2) { ASSERT_EQ(samples(x, y).smooth, samples(x, y).height); }
      }
  }
}

TEST(TerrainQuadtree, APlaneHasNoError) {
  const Terrain terrain(plane({500, 333}));
  for (const Raster<QuadtreeNode>& level : terrain.tree.levels)
    for (std::int64_t i = 0; i < level.size().cells(); ++i)
      for (int k = 0; k < node_steps; ++k) EXPECT_LE(error_m(level.data()[i], k), 1e-3);
  const QuadtreeNode& root = terrain.tree.levels.back()(0, 0);
  EXPECT_EQ(root.low, 100 - 332);
  EXPECT_EQ(root.high, 100 + 2 * 499);
}

TEST(TerrainQuadtree, ErrorsBoundWhatCoarseSamplesMiss) {
  const Terrain terrain(synthesize_mountains({257, 257}, {.seed = 3}));
  int exact = 0, all = 0;
  for (int level = 0; level < 3; ++level)
    for (int k = 0; k < node_steps; ++k) {
      const std::int64_t step = std::int64_t{1} << (level + k), side = std::int64_t{node_cells} << level;
      for (std::int64_t y0 = 0; y0 < 256; y0 += side)
        for (std::int64_t x0 = 0; x0 < 256; x0 += side) {
          const QuadtreeNode& node = terrain.tree.levels[static_cast<std::size_t>(level)](x0 / side, y0 / side);
          double worst = 0;
          for (std::int64_t y = y0; y < y0 + side; ++y)
            for (std::int64_t x = x0; x < x0 + side; ++x) {
              const std::int64_t i = x / step * step, j = y / step * step;
              const double s = static_cast<double>(x - i) / static_cast<double>(step), t = static_cast<double>(y - j) / static_cast<double>(step);
              const double a = terrain.cells(i, j), b = terrain.cells(i + step, j), c = terrain.cells(i, j + step), d = terrain.cells(i + step, j + step);
              const double mesh = s >= t ? a + s * (b - a) + t * (d - b) : a + t * (c - a) + s * (d - c);
              worst = std::max(worst, std::abs(terrain.cells(x, y) - mesh));
            }
          EXPECT_GE(error_m(node, k) + 1e-3, worst) << level << ' ' << k;
          if (level == 0 && k > 0) exact += error_m(node, k) < 1.5 * worst + 1e-3, ++all;
        }
    }
  // And not much more: the other diagonal, and rounding.
  EXPECT_GT(exact, 0.8 * all);
}

TEST(TerrainQuadtree, IsTheSameByBlocksOfAnySize) {
  // Nodes above those of a block of 1024 cells come from samples kept apart; of a part of the terrain that fits in one block they do not.
  const Terrain large(synthesize_mountains({1100, 700}, {.seed = 8}));
  Raster<float> corner(513, 513);
  for (std::int64_t y = 0; y < 513; ++y)
    for (std::int64_t x = 0; x < 513; ++x) corner(x, y) = large.cells(x, y);
  const Terrain small(std::move(corner));
  ASSERT_EQ(small.tree.levels.size(), 6u);
  for (std::size_t level = 0; level < 6; ++level)
    for (std::int64_t y = 0; y < 512 >> (level + 4); ++y)
      for (std::int64_t x = 0; x < 512 >> (level + 4); ++x) {
        const QuadtreeNode &a = large.tree.levels[level](x, y), &b = small.tree.levels[level](x, y);
        ASSERT_EQ(a.error, b.error);
        ASSERT_TRUE(a.low == b.low && a.high == b.high);
      }
  // The root of the large one against all its samples, drawn with 16 segments of 128 cells.
  const QuadtreeNode& root = large.tree.levels.back()(0, 0);
  ASSERT_EQ(large.tree.levels.size(), 8u);
  double worst = 0;
  for (std::int64_t y = 0; y < 640; ++y)
    for (std::int64_t x = 0; x < 1024; ++x) {
      const std::int64_t i = x / 128 * 128, j = y / 128 * 128;
      const double s = static_cast<double>(x - i) / 128, t = static_cast<double>(y - j) / 128;
      const double a = large.cells(i, j), b = large.cells(i + 128, j), c = large.cells(i, j + 128), d = large.cells(i + 128, j + 128);
      worst = std::max(worst, std::abs(large.cells(x, y) - (s >= t ? a + s * (b - a) + t * (d - b) : a + t * (c - a) + s * (d - c))));
    }
  EXPECT_GE(error_m(root, 0) + 1e-3, worst);
  EXPECT_LE(error_m(root, 0), 2.5 * worst);
}

TEST(TerrainQuadtree, PatchesTileTheTerrainAndNeighboursDifferByOneLevel) {
  const Size size{1500, 1100};
  const Terrain terrain(synthesize_mountains(size, {.seed = 4}));
  const TerrainPlacement placement{{30, 30}, 1, -500, true, false};
  const Camera camera = orbit_camera({3000, -3000, 2500}, 100, 89.9, 1500, 175);
  const auto patches = select_patches(terrain.tree, placement, camera, {400, 400}, {});
  Raster<int> level(94, 69, -1);
  for (const TerrainPatch& patch : patches) {
    for (const int segments : patch.outer) EXPECT_TRUE(segments >= 1 && segments <= 16 && (segments & (segments - 1)) == 0);
    if (patch.side != 0) continue;
    const std::int64_t leaves = std::int64_t{1} << patch.level;
    for (std::int64_t y = patch.y / node_cells; y < std::min<std::int64_t>(69, patch.y / node_cells + leaves); ++y)
      for (std::int64_t x = patch.x / node_cells; x < std::min<std::int64_t>(94, patch.x / node_cells + leaves); ++x) {
        EXPECT_EQ(level(x, y), -1);
        level(x, y) = patch.level;
      }
  }
  std::set<int> levels;
  for (std::int64_t y = 0; y < 69; ++y)
    for (std::int64_t x = 0; x < 94; ++x) {
      levels.insert(level(x, y));
      EXPECT_GE(level(x, y), 0);
      EXPECT_LE(std::abs(level(x, y) - level(std::max<std::int64_t>(0, x - 1), y)), 1);
      EXPECT_LE(std::abs(level(x, y) - level(x, std::max<std::int64_t>(0, y - 1))), 1);
    }
  EXPECT_GE(levels.size(), 3u);
}

TEST(TerrainQuadtree, TrianglesFallAsTheCameraRecedes) {
  const Terrain terrain(synthesize_mountains({1000, 1000}, {.seed = 5}));
  const TerrainPlacement placement{{30, 30}, 1, -500, false, false};
  std::int64_t before = INT64_MAX;
  for (const double distance : {50e3, 100e3, 200e3, 400e3, 800e3}) {
    std::int64_t triangles = 0;
    for (const TerrainPatch& patch : select_patches(terrain.tree, placement, orbit_camera({15000, -15000, 1000}, 180, 50, distance, 40), {1000, 1000}, {}))
      triangles += count_triangles(patch);
    EXPECT_LT(triangles, before);
    before = triangles;
  }
}

TEST(FrameBox, ShowsTheWholeBoxInTheMiddle) {
  const Box box{{0, -20000, 500}, {30000, 0, 3500}};
  for (const double pitch : {5.0, 35.0, 90.0})
    for (const double azimuth : {0.0, 200.0, 300.0}) {
      const Camera camera = frame_box(box, azimuth, pitch, 30, 1.6);
      const auto m = projection_matrix(camera, {1600, 1000}, {0, 0, 1600, 1000}, 1);
      double extreme[4] = {9, -9, 9, -9};
      for (int i = 0; i < 8; ++i) {
        const Point3 p = subtract({box.low[0] + (i & 1) * 30000, box.low[1] + (i >> 1 & 1) * 20000, box.low[2] + (i >> 2) * 3000}, camera.eye);
        const auto row = [&](std::size_t r) { return m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]; };
        extreme[0] = std::min(extreme[0], row(0) / row(3)), extreme[1] = std::max(extreme[1], row(0) / row(3));
        extreme[2] = std::min(extreme[2], row(1) / row(3)), extreme[3] = std::max(extreme[3], row(1) / row(3));
      }
      EXPECT_NEAR(extreme[0] + extreme[1], 0, 0.02);
      EXPECT_NEAR(extreme[2] + extreme[3], 0, 0.02);
      EXPECT_NEAR(std::max(extreme[1], extreme[3]), 0.96, 0.02);
    }
}

}  // namespace
}  // namespace arete
