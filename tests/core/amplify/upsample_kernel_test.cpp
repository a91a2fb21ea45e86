#include "core/amplify/upsample_kernel.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

struct Rows {
  Rows(int reach, std::int64_t count, std::uint64_t seed, double scale) : stride(count + 2 * reach + 16) {
    cells.resize(static_cast<std::size_t>((2 * reach + 1) * stride));
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = static_cast<float>(scale * (uniform_at(seed, i) - 0.5));
    for (int k = 0; k <= 2 * reach; ++k) rows.push_back(cells.data() + k * stride);
  }
  std::int64_t stride;
  std::vector<float> cells;
  std::vector<const float*> rows;
};

std::vector<float> random_weights(int reach, int phases) {
  std::vector<float> weights(static_cast<std::size_t>((2 * reach + 1) * (2 * reach + 1) * phases));
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = static_cast<float>(uniform_at(9, i) - 0.5);
  return weights;
}

/// The formula of the header, in double.
double plain_sum(const Rows& z, const Rows* e, int reach, const float* weights, std::int64_t x) {
  double sum = 0;
  const auto value = [&](int dy, std::int64_t i) {
    return static_cast<double>(z.rows[static_cast<std::size_t>(dy)][i]) -
           (e ? static_cast<double>(e->rows[static_cast<std::size_t>(dy)][i]) : 0.0);
  };
  for (int dy = 0; dy <= 2 * reach; ++dy)
    for (int dx = 0; dx <= 2 * reach; ++dx) sum += static_cast<double>(*weights++) * (value(dy, x + dx) - value(reach, x + reach));
  return sum;
}

TEST(UpsampleKernel, IsThePlainSumForAnyCountAndPhases) {
  for (const int reach : {1, 2, 4})
    for (const int phases : {1, 4, 9, 16, 25})
      for (const std::int64_t count : {1, 7, 16, 33}) {
        const Rows z(reach, count, 1, 100), e(reach, count, 2, 10);
        const std::vector<float> weights = random_weights(reach, phases);
        const std::int64_t stride = (count + 15) / 16 * 16, taps = std::int64_t{2 * reach + 1} * (2 * reach + 1);
        for (const bool detailed : {false, true}) {
          std::vector<float> out(static_cast<std::size_t>(phases * stride));
          sum_taps(z.rows.data(), detailed ? e.rows.data() : nullptr, reach, weights.data(), phases, count, out.data(), stride);
          for (int p = 0; p < phases; ++p)
            for (std::int64_t x = 0; x < count; ++x)  // 81 terms of at most 55: rounding below 81^2 2^-24 55
              EXPECT_NEAR(out[static_cast<std::size_t>(p * stride + x)],
                          plain_sum(z, detailed ? &e : nullptr, reach, weights.data() + p * taps, x), 2e-3)
                  << "reach " << reach << " phases " << phases << " count " << count << " x " << x;
        }
      }
}

// A cell is one lane from the first tap to the last: its bits do not depend on where it stands in the row.
TEST(UpsampleKernel, ACellHasTheSameBitsAtAnyPlaceOfTheRow) {
  constexpr int reach = 4, phases = 5;
  constexpr std::int64_t count = 48;
  const Rows z(reach, count + 8, 3, 1000);
  const std::vector<float> weights = random_weights(reach, phases);
  std::vector<float> whole(phases * count), shifted(phases * 48);
  sum_taps(z.rows.data(), nullptr, reach, weights.data(), phases, count, whole.data(), count);
  for (std::int64_t shift = 1; shift < 8; ++shift) {
    std::vector<const float*> rows = z.rows;
    for (const float*& row : rows) row += shift;
    sum_taps(rows.data(), nullptr, reach, weights.data(), phases, 35, shifted.data(), 48);
    for (int p = 0; p < phases; ++p)
      for (std::int64_t x = 0; x < 35; ++x)
        EXPECT_EQ(shifted[static_cast<std::size_t>(p * 48 + x)], whole[static_cast<std::size_t>(p * count + x + shift)]);
  }
}

TEST(UpsampleKernel, DifferencesOfAConstantAreExactlyZero) {
  constexpr int reach = 4;
  std::vector<float> row(64 + 2 * reach + 16, 4321.123f);
  const std::vector<const float*> rows(2 * reach + 1, row.data());
  std::vector<float> out(16 * 64, 1.0f);
  sum_taps(rows.data(), nullptr, reach, random_weights(reach, 16).data(), 16, 64, out.data(), 64);
  for (const float value : out) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace arete
