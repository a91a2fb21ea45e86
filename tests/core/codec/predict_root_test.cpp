#include "core/codec/predict_root.h"

#include <gtest/gtest.h>

#include "tests/core/codec/predict_fixture.h"

namespace arete {
namespace {

TEST(PredictRoot, IsWithinHalfAStep) {
  Raster<std::int32_t> terrain = fractal_terrain(8, 7, 4000);
  Raster<std::uint8_t> mask(8, 7, 0);
  mask(0, 0) = mask(3, 4) = mask(7, 6) = 1;
  for (bool voids : {false, true})
    for (std::int32_t step : {1, 4, 4001}) {
      PredictParameters file;
      file.lowest = 0;
      file.highest = 4000;
      file.root_step = step;
      Raster<std::int32_t> seen(8, 7), read(8, 7);
      const BlockView truth{terrain.view(), voids ? mask.view() : RasterView<const std::uint8_t>{}};
      const auto bytes = encode_root(file, truth, seen.view());
      decode_root(file, bytes, truth.voids, read.view());
      EXPECT_EQ(largest_difference(seen.view(), read.view()), 0);
      EXPECT_LE(largest_difference(terrain.view(), read.view(), truth.voids), step / 2);
    }
}

TEST(PredictRoot, HostileBytesGiveValuesInRange) {
  PredictParameters file;
  file.lowest = -5;
  file.highest = 1000;
  Raster<std::int32_t> values(8, 8);
  for (std::uint64_t i = 0; i < 500; ++i) {
    std::vector<std::byte> noise(hash_position(1, i) % 200);
    for (std::size_t k = 0; k < noise.size(); ++k) noise[k] = static_cast<std::byte>(hash_position(2, i, k));
    decode_root(file, noise, {}, values.view());
    for (std::int64_t k = 0; k < 64; ++k) {
      ASSERT_GE(values.data()[k], -5);
      ASSERT_LE(values.data()[k], 1000);
    }
  }
}

}  // namespace
}  // namespace arete
