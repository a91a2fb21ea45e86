#include "core/synthesis/spectral.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "core/terrain/spectrum.h"

namespace {

using arete::Raster;

bool same_bytes(const Raster<float>& a, const Raster<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size().cells()) * sizeof(float)) == 0;
}

/// Slope of log power over log frequency between 4 cycles per side and a quarter of the side, by least squares over the rings.
double measured_power_slope(const Raster<float>& terrain) {
  arete::SpectrumOptions options;
  options.tile = terrain.width();
  const auto spectrum = arete::compare_spectra(terrain.view(), terrain.view(), options);
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::int64_t i = 4; i <= spectrum.tile / 4; ++i) {
    const double x = std::log(static_cast<double>(i)), y = std::log(spectrum.reference[static_cast<std::size_t>(i)]);
    const double weight = 1 / static_cast<double>(i);  // rings are closer to each other in log f, the higher f is
    n += weight, sx += weight * x, sy += weight * y, sxx += weight * x * x, sxy += weight * x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// Ratio of the eigenvalues of the sum of gradient outer products: 1 where no direction is preferred. Central differences: those
/// of one side share a cell and would correlate.
double anisotropy(const Raster<float>& terrain) {
  double xx = 0, yy = 0, xy = 0;
  for (std::int64_t y = 1; y + 1 < terrain.height(); ++y)
    for (std::int64_t x = 1; x + 1 < terrain.width(); ++x) {
      const double gx = terrain(x + 1, y) - terrain(x - 1, y), gy = terrain(x, y + 1) - terrain(x, y - 1);
      xx += gx * gx, yy += gy * gy, xy += gx * gy;
    }
  const double middle = (xx + yy) / 2, spread = std::hypot((xx - yy) / 2, xy);
  return (middle + spread) / (middle - spread);
}

TEST(Spectral, PowerFallsAsTwiceTheExponent) {
  // The window of the estimate is Hann's, whose side lobes fall fast enough for slopes down to -6.
  for (const double beta : {1.25, 1.75, 2.0})
    EXPECT_NEAR(measured_power_slope(arete::synthesize_spectral({512, 512}, {.beta = beta, .relief_m = 1000})), -2 * beta, 0.15);
}

TEST(Spectral, HasNoGrain) {
  // Frequencies that are not wrapped give 2.5 to 3.5.
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
    EXPECT_LT(anisotropy(arete::synthesize_spectral({256, 256}, {.beta = 1.75, .relief_m = 1, .seed = seed})), 1.25) << seed;
}

TEST(Spectral, IsPeriodic) {
  const Raster<float> terrain = arete::synthesize_spectral({128, 96}, {.beta = 2.5, .relief_m = 100});
  double inside = 0, across = 0;
  for (std::int64_t y = 0; y < 96; ++y) {
    across = std::max(across, std::abs(static_cast<double>(terrain(0, y)) - terrain(127, y)));
    for (std::int64_t x = 0; x + 1 < 128; ++x)
      inside = std::max(inside, std::abs(static_cast<double>(terrain(x + 1, y)) - terrain(x, y)));
  }
  EXPECT_LE(across, 1.5 * inside);
}

TEST(Spectral, HasTheReliefAskedForAtAnySize) {
  for (const arete::Size size : {arete::Size{7, 13}, {1, 50}, {50, 1}, {2, 2}, {125, 81}}) {
    const Raster<float> terrain = arete::synthesize_spectral(size, {.beta = 2, .relief_m = 1234});
    const auto [lowest, highest] = std::minmax_element(terrain.data(), terrain.data() + size.cells());
    EXPECT_EQ(*lowest, 0);
    EXPECT_FLOAT_EQ(*highest, 1234);
  }
  EXPECT_EQ(arete::synthesize_spectral({1, 1}, {})(0, 0), 0);
}

TEST(Spectral, DependsOnTheSeedAndNotOnTheThreads) {
  const auto make = [](std::uint64_t seed, int threads) {
    return arete::synthesize_spectral({101, 64}, {.beta = 2, .relief_m = 1, .seed = seed, .threads = threads});
  };
  EXPECT_TRUE(same_bytes(make(5, 1), make(5, 3)));
  EXPECT_FALSE(same_bytes(make(5, 1), make(6, 1)));
}

}  // namespace
