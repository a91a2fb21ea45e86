#include "core/codec/subband_context.h"

#include <gtest/gtest.h>

namespace arete {
namespace {

TEST(SubbandContext, WeightsFitSixteenBits) {
  for (const EnergyWeights& w : energy_weights)
    EXPECT_LE(w.left + w.left2 + w.up + w.up2 + w.up_left + w.up_right + w.first + 4 * w.first_around + w.second + 4 * w.second_around + w.parent +
                  4 * w.parent_around,
              257);
}

TEST(SubbandContext, EnergyBinsAreMonotoneFourToAnOctave) {
  for (int e = 1; e < 5000; ++e) ASSERT_GE(energy_bin(e), energy_bin(e - 1)) << e;
  for (int e = 16; e < 512; e *= 2) EXPECT_EQ(energy_bin(2 * e) - energy_bin(e), 4) << e;
  EXPECT_EQ(energy_bin(0), 0);
  EXPECT_EQ(energy_bin(1 << 20), energy_bins - 1);
}

// One coefficient of 16 in the row above: its share of the expectation is its weight.
TEST(SubbandContext, ExpectedMagnitudeIsTheWeightedSum) {
  NodeCoefficients node;
  for (CoefficientBlock& block : node.bands) block = CoefficientBlock(8, 4);
  node.bands[0].set(3, 1, -16);
  RowContext context(8);
  prepare_row(node, {}, 0, 2, context);
  const EnergyWeights& w = energy_weights[0];
  EXPECT_EQ(expected_magnitude(context, 0, node.bands[0].magnitudes(2), 3), w.up);
  EXPECT_EQ(expected_magnitude(context, 0, node.bands[0].magnitudes(2), 4), w.up_left);
  EXPECT_EQ(expected_magnitude(context, 0, node.bands[0].magnitudes(2), 2), w.up_right);
  EXPECT_EQ(expected_magnitude(context, 0, node.bands[0].magnitudes(2), 6), 0);
}

}  // namespace
}  // namespace arete
