#include "core/codec/predict_training.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/core/codec/predict_fixture.h"

namespace arete {
namespace {

struct Scene {
  Raster<std::int32_t> fine;
  Raster<std::int32_t> coarse;
  PredictParameters file;

  explicit Scene(Raster<std::int32_t> terrain) : fine(std::move(terrain)), coarse((fine.width() + 1) / 2, (fine.height() + 1) / 2) {
    for (std::int64_t y = 0; y < coarse.height(); ++y)
      for (std::int64_t x = 0; x < coarse.width(); ++x) coarse(x, y) = fine(2 * x, 2 * y);
    file.lowest = -60000;
    file.highest = 60000;
  }
  std::vector<TrainingBlock> blocks(const NodeGrid& grid) {
    std::vector<TrainingBlock> list;
    const LevelView view{coarse.view(), {}, 0, 0, coarse.size()};
    for (std::int64_t y = 0; y < grid.nodes(1).height; ++y)
      for (std::int64_t x = 0; x < grid.nodes(1).width; ++x) {
        const Window cells = grid.cells({1, x, y});
        list.push_back({view, cells, {fine.view().sub(cells), {}}});
      }
    return list;
  }
  std::size_t bytes(const NodeGrid& grid, const LevelParameters& level) {
    std::size_t sum = 0;
    for (const TrainingBlock& block : blocks(grid)) {
      Raster<std::int32_t> out(block.cells.width, block.cells.height);
      sum += encode_node(block.coarse, block.cells, file, level, block.truth, out.view()).size();
    }
    return sum;
  }
};

// Terrain that a known filter makes: phases are the mean of their four nearest, level 1 is noise.
TEST(PredictTraining, FindsTheFilterThatMadeTheTerrain) {
  Raster<std::int32_t> fine(256, 256);
  for (std::int64_t y = 0; y < 256; y += 2)
    for (std::int64_t x = 0; x < 256; x += 2) fine(x, y) = static_cast<std::int32_t>(256 * uniform_at(1, x, y));
  const auto at = [&](std::int64_t x, std::int64_t y) {
    return fine(std::min<std::int64_t>(x, 254), std::min<std::int64_t>(y, 254));
  };
  for (std::int64_t y = 1; y < 256; y += 2)
    for (std::int64_t x = 1; x < 256; x += 2) fine(x, y) = (at(x - 1, y - 1) + at(x + 1, y - 1) + at(x - 1, y + 1) + at(x + 1, y + 1) + 2) / 4;
  for (std::int64_t y = 0; y < 256; ++y)
    for (std::int64_t x = 1 - y % 2; x < 256; x += 2) fine(x, y) = (at(std::max<std::int64_t>(x - 1, 0), y) + at(x + 1, y) + 1) / 2;
  Scene scene(std::move(fine));
  // away from the border, where the terrain was made otherwise
  std::vector<TrainingBlock> inner = scene.blocks(NodeGrid({256, 256}, 128));
  inner.resize(1);
  inner[0].cells = {64, 64, 128, 128};
  inner[0].truth = {scene.fine.view().sub(inner[0].cells), {}};
  const LevelParameters level = estimate_level(inner, scene.file, 1, default_level_parameters(), 1);
  EXPECT_NEAR(level.phases[0].taps[0], 1024, 20);
  EXPECT_NEAR(level.phases[0].taps[1], 1024, 20);
  for (std::size_t i = 2; i < 12; ++i) EXPECT_NEAR(level.phases[0].taps[i], 0, 20) << i;
  // the other phases follow from cells that depend on each other: many filters are right, and leave hardly a residual
  Raster<std::int32_t> out(128, 128);
  EXPECT_LT(encode_node(inner[0].coarse, inner[0].cells, scene.file, level, inner[0].truth, out.view()).size(), 1500u);
}

TEST(PredictTraining, BeatsTheDefaultsOnOtherTerrain) {
  Raster<std::int32_t> rough(300, 300);
  const Raster<std::int32_t> smooth = fractal_terrain(300, 300, 3000);
  for (std::int64_t i = 0; i < 90000; ++i)
    rough.data()[i] = smooth.data()[i] + static_cast<std::int32_t>(200 * uniform_at(1, static_cast<std::uint64_t>(i)));
  Scene scene(std::move(rough));
  const NodeGrid grid({300, 300}, 128);
  const LevelParameters level = estimate_level(scene.blocks(grid), scene.file, 1, default_level_parameters(), 1);
  LevelParameters plain = default_level_parameters();
  EXPECT_LT(static_cast<double>(scene.bytes(grid, level)), 0.97 * static_cast<double>(scene.bytes(grid, plain)));
}

TEST(PredictTraining, ThreadsDoNotChangeTheResult) {
  Scene scene(fractal_terrain(300, 280, 4000));
  const NodeGrid grid({300, 280}, 64);
  PredictParameters one = scene.file, many = scene.file;
  one.levels = {estimate_level(scene.blocks(grid), scene.file, 5, default_level_parameters(), 1)};
  many.levels = {estimate_level(scene.blocks(grid), scene.file, 5, default_level_parameters(), 7)};
  EXPECT_EQ(encode_parameters(one), encode_parameters(many));
}

TEST(PredictTraining, WhatItFindsIsAllowed) {
  std::uint64_t seed = 0;
  for (const Size size : {Size{2, 2}, Size{9, 9}, Size{64, 3}, Size{100, 100}})
    for (double relief : {0.0, 3.0, 50000.0}) {
      Scene scene(fractal_terrain(size.width, size.height, relief, ++seed));
      PredictParameters file = scene.file;
      file.levels = {estimate_level(scene.blocks(NodeGrid(size, 64)), scene.file, 3, default_level_parameters(), 1)};
      const PredictParameters read = decode_parameters(encode_parameters(file), 1, "x.sct");
      for (std::size_t p = 0; p < coded_phases; ++p) EXPECT_EQ(read.levels[0].phases[p].taps, file.levels[0].phases[p].taps);
    }
}

}  // namespace
}  // namespace arete
