#include "core/codec/quantise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/codec/subband_models.h"
#include "core/codec/trellis.h"
#include "core/support/random.h"

namespace arete {
namespace {

Raster<float> laplacian(std::int64_t width, std::int64_t height, double scale) {
  Raster<float> values(width, height);
  for (std::int64_t i = 0; i < values.size().cells(); ++i) {
    const double u = uniform_at(11, static_cast<std::uint64_t>(i)) - 0.5;
    values.data()[i] = static_cast<float>((u < 0 ? 1 : -1) * scale * std::log(1 - 2 * std::abs(u)));
  }
  return values;
}

double mean_squared_error(const Raster<float>& values, const CoefficientBlock& block) {
  double sum = 0;
  for (int y = 0; y < block.height(); ++y)
    for (int x = 0; x < block.width(); ++x) sum += std::pow(values(x, y) - static_cast<float>(block.row(y)[x]), 2);
  return sum / static_cast<double>(values.size().cells());
}

// Without a price of bits the trellis is a plain vector quantiser: 4/12 is the error of the uniform quantiser of the same rate,
// and eight states are 1.09 dB better (Marcellin & Fischer's table gives 1.1 dB for a uniform source).
TEST(Quantise, EightStatesGainOneDecibelAtHighRates) {
  const Raster<float> values = laplacian(64, 64, 200);
  const NodeCoefficients node = quantise_node({values.view(), values.view(), values.view()}, {}, 0.0F, 1);
  EXPECT_NEAR(10 * std::log10(4.0 / 12 / mean_squared_error(values, node.bands[0])), 1.09, 0.1);
}

TEST(Quantise, DearerBitsGiveFewerBytesAndMoreError) {
  const Raster<float> values = laplacian(64, 64, 2);
  double error = 0;
  std::size_t bytes = 1 << 30;
  for (float lambda : {0.05F, 0.2F, 0.8F, 3.0F}) {
    const NodeCoefficients node = quantise_node({values.view(), values.view(), values.view()}, {}, lambda, 2);
    SubbandModels models = initial_subband_models();
    const std::size_t now = encode_subbands(node, {}, models).size();
    EXPECT_LT(now, bytes) << lambda;
    EXPECT_GT(mean_squared_error(values, node.bands[0]), error) << lambda;
    bytes = now;
    error = mean_squared_error(values, node.bands[0]);
  }
}

TEST(Quantise, FollowsTheTrellis) {
  const Raster<float> values = laplacian(50, 30, 3);
  const NodeCoefficients node = quantise_node({values.view(), values.view(), values.view()}, {}, 0.2F, 2);
  const CoefficientBlock& block = node.bands[1];
  int state = 0;
  for (int y = 0; y < block.height(); ++y)
    for (int x = 0; x < block.width(); ++x) {
      const int magnitude = std::abs(block.row(y)[x]);
      if (!block.flags(y / CoefficientBlock::square)[x / CoefficientBlock::square]) {
        ASSERT_EQ(magnitude, 0);
        continue;
      }
      if (magnitude > 0) {
        ASSERT_EQ(magnitude % 2, quantiser_of(state)) << x << "," << y;
      }
      state = trellis_next[static_cast<std::size_t>(state)][lattice_index(magnitude, quantiser_of(state)) & 1];
    }
}

TEST(Quantise, SmallCoefficientsSwitchTheirSquaresOff) {
  const Raster<float> values(24, 24, 0.4F);
  const NodeCoefficients node = quantise_node({values.view(), values.view(), values.view()}, {}, 0.2F, 1);
  for (const CoefficientBlock& block : node.bands)
    for (int y = 0; y < block.squares_high(); ++y)
      for (int x = 0; x < block.squares_wide(); ++x) EXPECT_EQ(block.flags(y)[x], 0);
}

}  // namespace
}  // namespace arete
