#include "core/codec/wavelet_coder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/support/random.h"
#include "tests/core/codec/codec_terrain.h"
#include "tests/core/codec/wavelet_fixture.h"

namespace arete {
namespace {

Raster<float> decode(const WaveletStreams& streams, int level, const Window& window, int threads = 1) {
  return decode_wavelet(streams.parameters, streams.root, [&](std::int64_t i) { return streams.nodes[static_cast<std::size_t>(i)]; },
                        level, window, threads);
}

WaveletStreams encode(const Raster<float>& cells, int side, float step) { return encode_wavelet_streams(cells.view(), side, step); }

double squared_error(const Raster<float>& a, const Raster<float>& b) {
  double sum = 0;
  for (std::int64_t i = 0; i < a.size().cells(); ++i) sum += std::pow(static_cast<double>(a.data()[i]) - b.data()[i], 2);
  return sum;
}

TEST(WaveletCoder, FinerStepsComeCloser) {
  const Raster<float> cells = codec_terrain(200, 150);
  double error = 1e30;
  for (float step : {10.0F, 1.0F, 0.1F, 0.01F}) {
    const WaveletStreams streams = encode(cells, 64, step);
    const double now = squared_error(decode(streams, 0, {0, 0, 200, 150}), cells);
    EXPECT_LT(now, error / 20) << step;
    EXPECT_LT(std::sqrt(now / 30000), step) << step;
    EXPECT_NEAR(streams.squared_error / now, 1, 0.2) << step;
    error = now;
  }
}

// The tree is one terrain: whatever window, level or number of threads it is read by.
TEST(WaveletCoder, WindowsAreTheWhole) {
  const Raster<float> cells = codec_terrain(300, 211);
  const WaveletStreams streams = encode(cells, 64, 2);
  for (int level = 0; level <= streams.parameters.grid.levels(); ++level) {
    const Size size = streams.parameters.grid.level_size(level);
    const Raster<float> whole = decode(streams, level, {0, 0, size.width, size.height}, 2);
    for (std::uint64_t i = 0; i < 20; ++i) {
      const auto x = static_cast<std::int64_t>(hash_position(1, i) % static_cast<std::uint64_t>(size.width));
      const auto y = static_cast<std::int64_t>(hash_position(2, i) % static_cast<std::uint64_t>(size.height));
      const Window window{x, y, 1 + static_cast<std::int64_t>(hash_position(3, i) % static_cast<std::uint64_t>(size.width - x)),
                          1 + static_cast<std::int64_t>(hash_position(4, i) % static_cast<std::uint64_t>(size.height - y))};
      const Raster<float> part = decode(streams, level, window, 7);
      for (std::int64_t row = 0; row < window.height; ++row)
        for (std::int64_t column = 0; column < window.width; ++column) ASSERT_EQ(part(column, row), whole(x + column, y + row)) << "level " << level;
    }
  }
}

TEST(WaveletCoder, ACacheChangesNothing) {
  const Raster<float> cells = codec_terrain(300, 211);
  const WaveletStreams streams = encode(cells, 64, 2);
  std::int64_t reads = 0;
  const StreamReader reader = [&](std::int64_t i) {
    ++reads;
    return streams.nodes[static_cast<std::size_t>(i)];
  };
  CoefficientCache cache(1 << 24);
  const Raster<float> plain = decode(streams, 0, {70, 60, 90, 50});
  for (int i = 0; i < 2; ++i) {
    reads = 0;
    const Raster<float> kept = decode_wavelet(streams.parameters, streams.root, reader, 0, {70, 60, 90, 50}, 1, &cache);
    EXPECT_TRUE(std::equal(plain.data(), plain.data() + 90 * 50, kept.data()));
    EXPECT_EQ(reads > 4, i == 0);
    EXPECT_EQ(reads == 0, i == 1);
  }
}

TEST(WaveletCoder, OddAndTinyRasters) {
  for (const Size size : {Size{1, 1}, Size{1, 40}, Size{9, 1}, Size{33, 65}, Size{8, 8}}) {
    const Raster<float> cells = codec_terrain(size.width, size.height);
    const WaveletStreams streams = encode(cells, 32, 0.05F);
    EXPECT_LT(std::sqrt(squared_error(decode(streams, 0, {0, 0, size.width, size.height}), cells) / static_cast<double>(size.cells())), 0.06)
        << size.width << "x" << size.height;
  }
}

TEST(WaveletCoder, AnyStreamsDecode) {
  const Raster<float> cells = codec_terrain(90, 70);
  WaveletStreams streams = encode(cells, 32, 1);
  for (std::uint64_t i = 0; i < 100; ++i) {
    std::vector<std::byte>& node = streams.nodes[hash_position(1, i) % streams.nodes.size()];
    if (!node.empty()) node[hash_position(2, i) % node.size()] = static_cast<std::byte>(hash_position(3, i));
    if (!streams.root.empty()) streams.root[hash_position(4, i) % streams.root.size()] = static_cast<std::byte>(hash_position(5, i));
    EXPECT_EQ(decode(streams, 0, {0, 0, 90, 70}).size(), cells.size());
  }
}

}  // namespace
}  // namespace arete
