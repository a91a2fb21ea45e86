#include "core/codec/wavelet_encoder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/core/codec/codec_terrain.h"
#include "tests/core/codec/wavelet_fixture.h"

namespace arete {
namespace {

// Odd sizes, so that the last blocks of coefficients are a single column or row.
TEST(WaveletEncoder, ThreadsAndFilesGiveTheSameBytes) {
  const Raster<float> cells = codec_terrain(513, 258);
  const WaveletStreams one = encode_wavelet_streams(cells.view(), 32, 3, 1);
  const Scratch files{0, std::filesystem::temp_directory_path().string()};
  for (const WaveletStreams& other : {encode_wavelet_streams(cells.view(), 32, 3, 2), encode_wavelet_streams(cells.view(), 32, 3, 7, files)}) {
    EXPECT_EQ(one.root, other.root);
    EXPECT_EQ(one.nodes, other.nodes);
    EXPECT_EQ(one.parameters.shrink, other.parameters.shrink);
  }
}

TEST(WaveletEncoder, TheSourceIsReadOnlyInside) {
  class Strict final : public RasterSource {
   public:
    Size size() const override { return {301, 7}; }
    void read(const Window& w, RasterView<float> out) const override {
      EXPECT_TRUE(w.x >= 0 && w.y >= 0 && w.width > 0 && w.height > 0 && w.x + w.width <= 301 && w.y + w.height <= 7);
      for (std::int64_t y = 0; y < w.height; ++y)
        for (std::int64_t x = 0; x < w.width; ++x) out(x, y) = static_cast<float>((w.x + x) % 9 + (w.y + y));
    }
  } source;
  const WaveletPyramid pyramid = analyse_raster(source, NodeGrid(source.size(), 32), {}, 1);
  std::vector<std::vector<std::byte>> nodes;
  encode_wavelet(pyramid, {}, store_in(nodes));
  EXPECT_EQ(static_cast<std::int64_t>(nodes.size()), pyramid.grid.node_count());
}

TEST(WaveletEncoder, ProgressCountsEachNodeOnce) {
  const Raster<float> cells = codec_terrain(300, 200);
  const ViewSource source(cells.view());
  const WaveletPyramid pyramid = analyse_raster(source, NodeGrid(cells.size(), 64), {}, 1);
  std::int64_t told = 0;
  WaveletEncoding how;
  how.progress = [&](std::int64_t nodes) { told += nodes; };
  std::vector<std::vector<std::byte>> nodes;
  encode_wavelet(pyramid, how, store_in(nodes));
  EXPECT_EQ(told, pyramid.grid.node_count());
}

// The models of the search for a step: they come close enough to start from.
TEST(WaveletEncoder, DetailsForetellErrorAndSize) {
  const Raster<float> cells = codec_terrain(400, 400);
  const ViewSource source(cells.view());
  const DetailSizes details = analyse_raster(source, NodeGrid(cells.size(), 256), {}, 1).details;
  double error_before = 0, bits_before = 1e30;
  for (float step : {0.5F, 2.0F, 8.0F}) {
    const WaveletStreams streams = encode_wavelet_streams(cells.view(), 256, step);
    double bits = 0;
    for (const auto& node : streams.nodes) bits += 8 * static_cast<double>(node.size());
    EXPECT_NEAR(std::sqrt(details.squared_error(static_cast<double>(step)) / streams.squared_error), 1, 0.2) << step;
    EXPECT_NEAR(std::log2(details.bits(static_cast<double>(step)) / bits), 0, 1) << step;
    EXPECT_GT(details.squared_error(static_cast<double>(step)), error_before);
    EXPECT_LT(details.bits(static_cast<double>(step)), bits_before);
    error_before = details.squared_error(static_cast<double>(step));
    bits_before = details.bits(static_cast<double>(step));
  }
}

}  // namespace
}  // namespace arete
