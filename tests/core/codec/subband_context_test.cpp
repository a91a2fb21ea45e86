#include "core/codec/subband_context.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/support/random.h"

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
  prepare_row(node, {}, 0, 2, {0, 8}, context);
  const EnergyWeights& w = energy_weights[0];
  const auto expected_at = [&](int x, int left, int left2) {
    return static_cast<int>(expected_magnitude(unpack_place(context.places[static_cast<std::size_t>(x)]), 0, left, left2));
  };
  EXPECT_EQ(expected_at(3, 0, 0), w.up);
  EXPECT_EQ(expected_at(4, 0, 0), w.up_left);
  EXPECT_EQ(expected_at(2, 0, 0), w.up_right);
  EXPECT_EQ(expected_at(6, 0, 0), 0);
  EXPECT_EQ(expected_at(6, 16, 32), w.left + 2 * w.left2);
}

Raster<std::int32_t> random_values(std::uint64_t seed) {
  Raster<std::int32_t> values(19, 12);
  for (std::int64_t i = 0; i < values.size().cells(); ++i)
    values.data()[i] = static_cast<std::int32_t>(std::pow(uniform_at(seed, static_cast<std::uint64_t>(i)), 4) * 700) *
                       (uniform_at(seed + 1, static_cast<std::uint64_t>(i)) < 0.5 ? -1 : 1);
  return values;
}

NodeCoefficients random_node(std::uint64_t seed) {
  NodeCoefficients node;
  for (CoefficientBlock& block : node.bands) {
    block = CoefficientBlock(19, 12);
    const Raster<std::int32_t> values = random_values(seed += 2);
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 19; ++x) block.set(x, y, values(x, y));
  }
  return node;
}

// The formulas of core/codec/tree-format.md, 6.3, one place at a time.
TEST(SubbandContext, RowsAreTheFormulas) {
  const NodeCoefficients node = random_node(1), parent = random_node(50);
  const ParentView view{&parent, 8, 4};
  for (int band = 0; band < band_count; ++band)
    for (int y = 0; y < 12; ++y) {
      RowContext context(19);
      prepare_row(node, view, band, y, {2, 19}, context);
      const EnergyWeights& w = energy_weights[band];
      const MeanWeights& m = mean_weights[band];
      const CoefficientBlock& block = node.bands[static_cast<std::size_t>(band)];
      for (int x = 2; x < 19; ++x) {
        const auto around = [](const CoefficientBlock& b, int bx, int by) {
          return b.magnitudes(by)[bx - 1] + b.magnitudes(by)[bx + 1] + b.magnitudes(by - 1)[bx] + b.magnitudes(by + 1)[bx];
        };
        const auto up = [&](int dx, int dy) { return std::clamp(block.row(y - dy)[x + dx], -255, 255); };
        const CoefficientBlock& over = parent.bands[static_cast<std::size_t>(band)];
        const int px = 8 + x / 2, py = 4 + y / 2;
        int energy = w.up * block.magnitudes(y - 1)[x] + w.up2 * block.magnitudes(y - 2)[x] + w.up_left * block.magnitudes(y - 1)[x - 1] +
                     w.up_right * block.magnitudes(y - 1)[x + 1] + w.parent * over.magnitudes(py)[px] + w.parent_around * around(over, px, py);
        int others = 2 * over.magnitudes(py)[px] + around(over, px, py) / 2;
        for (int before = 0; before < band; ++before) {
          const CoefficientBlock& beside = node.bands[static_cast<std::size_t>(before)];
          energy += (before == 0 ? w.first : w.second) * beside.magnitudes(y)[x] + (before == 0 ? w.first_around : w.second_around) * around(beside, x, y);
          others += 2 * beside.magnitudes(y)[x] + around(beside, x, y) / 2;
        }
        const PlaceContext place = unpack_place(context.places[static_cast<std::size_t>(x)]);
        ASSERT_EQ(place.energy, energy) << band << " " << x << "," << y;
        ASSERT_EQ(place.near, std::min(near_limit, (2 * block.magnitudes(y - 1)[x] + block.magnitudes(y - 1)[x - 1] + block.magnitudes(y - 1)[x + 1]) / 2));
        ASSERT_EQ(place.cross, local_bin(others / 2));
        const int mean = m.up * up(0, 1) + m.up2 * up(0, 2) + m.up_left * up(-1, 1) + m.up_right * up(1, 1);
        const int pattern = 3 * (sign_of(up(0, 1)) + 1) + 9 * (sign_of(up(-1, 1)) + 1);
        ASSERT_EQ(context.signs[static_cast<std::size_t>(x)], 256 * mean + pattern);
      }
    }
}

TEST(SubbandContext, RunsAreTheSquaresThatAreOn) {
  CoefficientBlock block(37, 8);
  for (int b : {0, 1, 4}) block.flags(0)[b] = 1;
  std::vector<std::pair<int, int>> runs;
  visit_runs(block, 0, [&](Columns columns) { runs.emplace_back(columns.first, columns.end); });
  EXPECT_EQ(runs, (std::vector<std::pair<int, int>>{{0, 16}, {32, 37}}));
}

}  // namespace
}  // namespace arete
