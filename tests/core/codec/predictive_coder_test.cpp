#include "core/codec/predictive_coder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/codec/predict_fixture.h"

namespace arete {
namespace {

PredictiveStreams encode(const Raster<std::int32_t>& terrain, std::int32_t step, int side = 64, int threads = 1) {
  PredictiveEncoding options;
  options.step = step;
  options.threads = threads;
  return encode_streams(terrain.view(), {}, NodeGrid(terrain.size(), side), options);
}

Window whole(const PredictiveStreams& streams, int level = 0) {
  const Size size = streams.grid.level_size(level);
  return {0, 0, size.width, size.height};
}

double bits_per_cell(const PredictiveStreams& streams) {
  return 8.0 * static_cast<double>(streams.bytes()) / static_cast<double>(streams.grid.size().cells());
}

void expect_exact(const Raster<std::int32_t>& terrain, int side = 32) {
  const PredictiveStreams streams = encode(terrain, 1, side);
  const Raster<std::int32_t> decoded = decode(streams, 0, whole(streams));
  EXPECT_EQ(largest_difference(terrain.view(), decoded.view()), 0)
      << terrain.width() << " x " << terrain.height() << ", nodes of " << side;
}

TEST(PredictiveCoder, StepOneIsExactAtAnySize) {
  for (const Size size : {Size{1, 1}, Size{1, 2}, Size{2, 1}, Size{8, 8}, Size{9, 8}, Size{1, 200}, Size{333, 1}, Size{2, 77}, Size{65, 64},
                          Size{129, 63}, Size{200, 131}})
    expect_exact(fractal_terrain(size.width, size.height, 900));
}

TEST(PredictiveCoder, StepOneIsExactForConstantsAndExtremes) {
  Raster<std::int32_t> terrain(70, 50, 0);
  expect_exact(terrain);
  terrain = Raster<std::int32_t>(70, 50, -(1 << 30));
  expect_exact(terrain);
  for (std::int64_t i = 0; i < terrain.size().cells(); ++i)
    terrain.data()[i] = (hash_position(1, static_cast<std::uint64_t>(i)) & 1U) != 0 ? INT32_MAX : INT32_MIN;
  expect_exact(terrain);
  for (std::int64_t i = 0; i < terrain.size().cells(); ++i)
    terrain.data()[i] = static_cast<std::int32_t>(hash_position(2, static_cast<std::uint64_t>(i)));
  expect_exact(terrain);
}

TEST(PredictiveCoder, EachErrorIsAtMostHalfAStep) {
  const Raster<std::int32_t> terrain = fractal_terrain(300, 211, 20000);
  for (std::int32_t step : {2, 3, 10, 17, 256, 1001, 50000, 1 << 24}) {
    const PredictiveStreams streams = encode(terrain, step);
    const Raster<std::int32_t> decoded = decode(streams, 0, whole(streams));
    EXPECT_LE(largest_difference(terrain.view(), decoded.view()), step / 2) << step;
    for (std::int64_t i = 0; i < terrain.size().cells(); ++i)  // an even step's half is met on one side only
      ASSERT_GE(decoded.data()[i] - terrain.data()[i], -(step - 1 - step / 2)) << step;
  }
}

TEST(PredictiveCoder, TheBoundHoldsOnLidar) {
  const Raster<std::int32_t> terrain = gabilan_centimetres();
  if (terrain.size().cells() == 0) GTEST_SKIP() << "the development data is absent";
  for (std::int32_t bound : {0, 5, 25}) {
    const PredictiveStreams streams = encode(terrain, 2 * bound + 1, 256, 0);
    const Raster<std::int32_t> decoded = decode(streams, 0, whole(streams));
    EXPECT_LE(largest_difference(terrain.view(), decoded.view()), bound);
  }
}

// Bits per cell of the best codec of others at the same bound, codec-study's sections 5 and 6: JPEG XL, then SPERR and SZ3 (whose bound
// of 0.05 m is met by whole centimetres at 5, one of 0.25 m at 25).
TEST(PredictiveCoder, IsSmallerThanTheBestOfOthersOnLidar) {
  const Raster<std::int32_t> terrain = gabilan_centimetres();
  if (terrain.size().cells() == 0) GTEST_SKIP() << "the development data is absent";
  EXPECT_LT(bits_per_cell(encode(terrain, 1, 256, 0)), 3.40);
  EXPECT_LT(bits_per_cell(encode(terrain, 11, 256, 0)), 0.75);
  EXPECT_LT(bits_per_cell(encode(terrain, 51, 256, 0)), 0.12);
}

TEST(PredictiveCoder, AWindowOfALevelIsAPartOfTheWhole) {
  const Raster<std::int32_t> terrain = fractal_terrain(301, 260, 3000);
  for (std::int32_t step : {1, 20}) {
    const PredictiveStreams streams = encode(terrain, step, 32);
    for (int level = 0; level <= streams.grid.levels(); ++level) {
      const Raster<std::int32_t> all = decode(streams, level, whole(streams, level));
      const Size size = streams.grid.level_size(level);
      for (std::uint64_t i = 0; i < 6; ++i) {
        Window w;
        w.x = static_cast<std::int64_t>(uniform_at(3, i, 0) * size.width);
        w.y = static_cast<std::int64_t>(uniform_at(3, i, 1) * size.height);
        w.width = 1 + static_cast<std::int64_t>(uniform_at(3, i, 2) * (size.width - w.x - 1));
        w.height = 1 + static_cast<std::int64_t>(uniform_at(3, i, 3) * (size.height - w.y - 1));
        const Raster<std::int32_t> part = decode(streams, level, w);
        ASSERT_EQ(largest_difference(part.view(), all.view().sub(w)), 0) << "level " << level << ", window " << i;
      }
    }
  }
}

TEST(PredictiveCoder, ALevelHoldsTheDecodedCellsOfTheRasterAtItsMultiples) {
  const Raster<std::int32_t> terrain = fractal_terrain(150, 97, 3000);
  const PredictiveStreams streams = encode(terrain, 1, 32);
  for (int level = 0; level <= streams.grid.levels(); ++level) {
    const Raster<std::int32_t> decoded = decode(streams, level, whole(streams, level));
    for (std::int64_t y = 0; y < decoded.height(); ++y)
      for (std::int64_t x = 0; x < decoded.width(); ++x) ASSERT_EQ(decoded(x, y), terrain(x << level, y << level));
  }
}

TEST(PredictiveCoder, AWindowReadsOnlyTheNodesItDependsOn) {
  const Raster<std::int32_t> terrain = fractal_terrain(1024, 1024, 3000);
  const PredictiveStreams streams = encode(terrain, 8, 64, 0);
  std::int64_t read = 0;
  const auto count = [&](std::int64_t i) {
    ++read;
    return streams.nodes[static_cast<std::size_t>(i)];
  };
  decode_predictive(streams.grid, streams.parameters, streams.root, count, {}, 0, {500, 500, 64, 64}, 1);
  // four nodes of the finest level, nine at most of each level above: a margin of 8 cells crosses a border at most on each side
  EXPECT_LE(read, 4 + 9 * (streams.grid.levels() - 1));
}

TEST(PredictiveCoder, ACacheChangesNothing) {
  const Raster<std::int32_t> terrain = fractal_terrain(300, 260, 3000);
  const PredictiveStreams streams = encode(terrain, 3, 64);
  std::int64_t reads = 0;
  const StreamReader reader = [&](std::int64_t i) {
    ++reads;
    return streams.nodes[static_cast<std::size_t>(i)];
  };
  NumberCache cache(1 << 24);
  const Window window{70, 60, 90, 50};
  const Raster<std::int32_t> plain = decode(streams, 0, window);
  for (int i = 0; i < 2; ++i) {
    reads = 0;
    const Raster<std::int32_t> kept = decode_predictive(streams.grid, streams.parameters, streams.root, reader, {}, 0, window, 1, &cache);
    EXPECT_EQ(largest_difference(plain.view(), kept.view()), 0);
    EXPECT_EQ(reads > 0, i == 0);
  }
}

TEST(PredictiveCoder, TheBoundHoldsBetweenVoids) {
  const Raster<std::int32_t> terrain = fractal_terrain(301, 260, 3000);
  const Raster<std::uint8_t> voids = ragged_mask(301, 260);
  PredictiveEncoding options;
  for (std::int32_t step : {1, 12}) {
    options.step = step;
    const PredictiveStreams streams = encode_streams(terrain.view(), voids.view(), NodeGrid(terrain.size(), 64), options);
    for (int level = 0; level <= streams.grid.levels(); ++level) {
      const Raster<std::int32_t> decoded = decode(streams, level, whole(streams, level), void_reader(voids));
      for (std::int64_t y = 0; y < decoded.height(); ++y)
        for (std::int64_t x = 0; x < decoded.width(); ++x)
          if (!voids(x << level, y << level)) {
            ASSERT_LE(std::abs(decoded(x, y) - terrain(x << level, y << level)), step / 2);
          }
    }
  }
}

TEST(PredictiveCoder, ValuesUnderVoidsDoNotMatter) {
  const Raster<std::int32_t> terrain = fractal_terrain(200, 160, 3000);
  const Raster<std::uint8_t> voids = ragged_mask(200, 160);
  Raster<std::int32_t> other = terrain.clone();
  for (std::int64_t i = 0; i < other.size().cells(); ++i)
    if (voids.data()[i]) other.data()[i] = static_cast<std::int32_t>(hash_position(5, static_cast<std::uint64_t>(i)));
  const NodeGrid grid(terrain.size(), 64);
  const PredictiveStreams a = encode_streams(terrain.view(), voids.view(), grid, {}), b = encode_streams(other.view(), voids.view(), grid, {});
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.root, b.root);
  EXPECT_EQ(encode_parameters(a.parameters), encode_parameters(b.parameters));
}

TEST(PredictiveCoder, VoidCellsCostNothing) {
  const Raster<std::int32_t> terrain = fractal_terrain(100, 90, 3000);
  const Raster<std::uint8_t> voids(100, 90, 1);
  const PredictiveStreams streams = encode_streams(terrain.view(), voids.view(), NodeGrid(terrain.size(), 32), {});
  for (const auto& node : streams.nodes) EXPECT_TRUE(node.empty());
}

}  // namespace
}  // namespace arete
