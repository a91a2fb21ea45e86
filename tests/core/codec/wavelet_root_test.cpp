#include "core/codec/wavelet_root.h"

#include <gtest/gtest.h>

#include "core/codec/wavelet.h"

namespace arete {
namespace {

// A root of 8 x 5 cells.
const WaveletParameters parameters{NodeGrid({16, 10}, 32), 0.5F, {}};

TEST(WaveletRoot, ComesBackWithinHalfAStep) {
  Raster<float> root(8, 5);
  for (std::int64_t i = 0; i < 40; ++i) root.data()[i] = static_cast<float>((i % 7) * 311 - 900) + 0.3F * static_cast<float>(i);
  const Raster<float> back = decode_wavelet_root(encode_wavelet_root(root, parameters), parameters);
  for (std::int64_t i = 0; i < 40; ++i) EXPECT_NEAR(back.data()[i], root.data()[i], 1.001F * parameters.step / band_norm(1, band_count));
}

TEST(WaveletRoot, AnyBytesDecode) {
  EXPECT_EQ(decode_wavelet_root({}, parameters).size(), (Size{8, 5}));
  const std::vector<std::byte> ones(100, std::byte{0xff});
  EXPECT_EQ(decode_wavelet_root(ones, parameters).size(), (Size{8, 5}));
}

}  // namespace
}  // namespace arete
