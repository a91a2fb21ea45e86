#include "core/codec/bjontegaard.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace arete {
namespace {

/// PSNR that rises by 6 dB with each doubling of the rate, from `at_one` dB at 1 bit: a straight line on a logarithmic axis.
std::vector<RatePoint> straight(double at_one, const std::vector<double>& rates) {
  std::vector<RatePoint> points;
  for (const double bits : rates) points.push_back({bits, at_one + 6 * std::log2(bits)});
  return points;
}

const std::vector<double> rates = {0.05, 0.1, 0.2, 0.5, 1, 2};

// Parallel lines 6 dB apart: 6 dB everywhere, and any PSNR is reached with half of the bits.
TEST(Bjontegaard, OfParallelLinesIsTheirDistance) {
  const auto low = straight(60, rates), high = straight(66, {0.07, 0.3, 0.9, 1.7});
  EXPECT_NEAR(bd_psnr(low, high).value(), 6, 1e-12);
  EXPECT_NEAR(bd_rate(low, high).value(), -50, 1e-10);
  EXPECT_NEAR(bd_psnr(high, low).value(), -6, 1e-12);
  EXPECT_NEAR(bd_rate(high, low).value(), 100, 1e-10);
}

TEST(Bjontegaard, OfACurveAndItselfIsNothing) {
  const std::vector<RatePoint> points = {{0.05, 48.15}, {0.1, 51.91}, {0.5, 59.90}, {2, 70.79}};
  EXPECT_EQ(bd_psnr(points, points).value(), 0);
  EXPECT_EQ(bd_rate(points, points).value(), 0);
}

// Expected: scipy 1.10, PchipInterpolator(...).integrate over the common interval, of log10(bits) and PSNR.
TEST(Bjontegaard, AgreesWithScipysPchip) {
  const std::vector<RatePoint> anchor = {{0.05, 48.15}, {0.1, 51.91}, {0.2, 55.23}, {0.5, 59.90}, {1, 64.32}, {2, 70.79}};
  const std::vector<RatePoint> test = {{1.9, 71.3}, {0.04, 48.0}, {0.11, 53.1}, {0.21, 56.0}, {0.45, 60.1}, {1.1, 65.4}};
  EXPECT_NEAR(bd_psnr(anchor, test).value(), 0.6622966761, 1e-9);
  EXPECT_NEAR(bd_psnr(anchor, test, 0.1, 1).value(), 0.6287975570, 1e-9);
  EXPECT_NEAR(bd_rate(anchor, test).value(), -10.4646234312, 1e-9);
}

TEST(Bjontegaard, LeavesOutWhatDoesNotRise) {
  const auto line = straight(60, rates);
  auto noisy = line;
  noisy.push_back({0.3, 20});
  noisy.push_back({4, std::numeric_limits<double>::infinity()});
  noisy.push_back({0, 10});
  EXPECT_NEAR(bd_psnr(line, noisy).value(), 0, 1e-12);
}

TEST(Bjontegaard, HasNoValueWithoutACommonInterval) {
  const auto line = straight(60, rates);
  EXPECT_FALSE(bd_psnr(line, straight(60, {3, 4, 5})));
  EXPECT_FALSE(bd_psnr(line, straight(60, {1})));
  EXPECT_FALSE(bd_psnr(line, {}));
  EXPECT_FALSE(bd_psnr(line, line, 5, 6));
  EXPECT_FALSE(bd_rate(line, straight(200, rates)));
}

}  // namespace
}  // namespace arete
