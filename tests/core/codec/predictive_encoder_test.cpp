#include "core/codec/predictive_encoder.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/core/codec/predict_fixture.h"

namespace arete {
namespace {

Window whole(const PredictiveStreams& streams) { return {0, 0, streams.grid.size().width, streams.grid.size().height}; }

TEST(PredictiveEncoder, ThreadsAndFilesGiveTheSameBytes) {
  const Raster<std::int32_t> terrain = fractal_terrain(601, 514, 5000);
  const Raster<std::uint8_t> voids = ragged_mask(601, 514);
  for (const RasterView<const std::uint8_t> mask : {RasterView<const std::uint8_t>{}, RasterView<const std::uint8_t>(voids.view())}) {
    PredictiveEncoding how;
    how.step = 15;
    how.threads = 1;
    const NodeGrid grid(terrain.size(), 64);
    const PredictiveStreams one = encode_streams(terrain.view(), mask, grid, how);
    for (int threads : {2, 7}) {
      how.threads = threads;
      how.scratch = {0, threads == 7 ? std::filesystem::temp_directory_path().string() : ""};
      const PredictiveStreams many = encode_streams(terrain.view(), mask, grid, how);
      EXPECT_EQ(one.nodes, many.nodes);
      EXPECT_EQ(one.root, many.root);
      EXPECT_EQ(encode_parameters(one.parameters), encode_parameters(many.parameters));
    }
  }
}

TEST(PredictiveEncoder, FinerCoarseLevelsKeepTheBound) {
  const Raster<std::int32_t> terrain = fractal_terrain(200, 200, 9000);
  PredictiveEncoding options;
  options.step = 101;
  options.coarse_step = {240, 200, 128};
  const PredictiveStreams streams = encode_streams(terrain.view(), {}, NodeGrid(terrain.size(), 64), options);
  EXPECT_EQ(streams.parameters.levels[0].step, 101);
  EXPECT_EQ(streams.parameters.levels[1].step, 94);
  EXPECT_EQ(streams.parameters.levels[2].step, 78);
  EXPECT_EQ(streams.parameters.root_step, 50);
  EXPECT_LE(largest_difference(terrain.view(), decode(streams, 0, whole(streams)).view()), 50);
}

TEST(PredictiveEncoder, ProgressCountsEachNodeOnce) {
  const Raster<std::int32_t> terrain = fractal_terrain(200, 200, 9000);
  std::int64_t told = 0;
  PredictiveEncoding how;
  how.progress = [&](std::int64_t nodes) { told += nodes; };
  const PredictiveStreams streams = encode_streams(terrain.view(), {}, NodeGrid(terrain.size(), 64), how);
  EXPECT_EQ(told, streams.grid.node_count());
  EXPECT_EQ(static_cast<std::int64_t>(streams.nodes.size()), told);
}

}  // namespace
}  // namespace arete
