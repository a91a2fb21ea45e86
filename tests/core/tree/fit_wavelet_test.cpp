#include "core/tree/fit_wavelet.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/codec/codec_terrain.h"
#include "tests/core/tree/tree_sources.h"

namespace arete {
namespace {

FittedTree fit_cells(Raster<double> stored, const CompressionTarget& target, int side) {
  TreeHeader header;
  CompressOptions options;
  options.target = target;
  options.node_side = side;
  return fit_wavelet(read_tree_cells(MemoryStored(std::move(stored)), header, options.scratch), header, options, nullptr);
}

FittedTree fit(const CompressionTarget& target, int side) {
  const Raster<float> terrain = codec_terrain(200, 160);
  Raster<double> stored(200, 160);
  for (std::int64_t i = 0; i < terrain.size().cells(); ++i) stored.data()[i] = terrain.data()[i];
  return fit_cells(std::move(stored), target, side);
}

TEST(FitWavelet, ComesCloseToTheError) {
  for (double rmse : {0.05, 0.5, 5.0}) {
    const FittedTree fitted = fit({TreeClaim::rmse, rmse}, 64);
    EXPECT_LE(fitted.errors.rmse_m, rmse);
    EXPECT_GE(fitted.errors.rmse_m, 0.96 * rmse);  // the last tree has less than 200 bytes: its error jumps with the step
  }
}

TEST(FitWavelet, FillsTheBytes) {
  const FittedTree fitted = fit({TreeClaim::bytes, 5000}, 128);
  EXPECT_LE(fitted.file->size(), 5000U);
  EXPECT_GE(fitted.file->size(), 4900U);
}

TEST(FitWavelet, SaysWhereNothingFits) { EXPECT_TRUE(fit({TreeClaim::bytes, 30}, 64).file == nullptr); }

// More bytes than the finest step fills: the finest is taken, and its coefficients are in range.
TEST(FitWavelet, MoreBytesThanNeededAreNotSpoiled) {
  const FittedTree fitted = fit({TreeClaim::bytes, 1e7}, 64);
  ASSERT_NE(fitted.file, nullptr);
  EXPECT_LT(fitted.errors.rmse_m, 1e-3);
}

// Found by tests/fuzz/round_trip_fuzz.cpp, as 2b 98 98 ee 2f 0a 0b 98 ee 2f 0a e5: the range was taken for a nanometre.
TEST(FitWavelet, KeepsTheRatioOfATinyRange) {
  Raster<double> stored(20, 9, 0.0);
  stored(4, 5) = 1e-12;
  const FittedTree fitted = fit_cells(std::move(stored), {TreeClaim::psnr, 40}, 32);
  ASSERT_TRUE(fitted.file != nullptr);
  EXPECT_GE(fitted.errors.psnr_db(), 40);
}

// Found by tests/fuzz/round_trip_fuzz.cpp, as 08 ff ff ff 02 00 00 00 7a: more steps than an index has room for.
TEST(FitWavelet, SaysWhereAStepIsTooFine) {
  for (double highest : {1.0, 1e10, 3.4e38}) {
    Raster<double> stored(40, 37, 0.0);
    stored(20, 11) = highest;
    stored(0, 0) = -highest;
    EXPECT_TRUE(fit_cells(std::move(stored), {TreeClaim::rmse, highest * 1e-40}, 32).file == nullptr) << highest;
  }
}

// A raster without nodes: nothing foretells its size.
TEST(FitWavelet, ThreeCellsInManyBytesAreNearlyExact) {
  Raster<double> stored(3, 1);
  stored(0, 0) = 1, stored(1, 0) = 5, stored(2, 0) = 2;
  const MemoryStored source(std::move(stored));
  CompressOptions options;
  options.target = {TreeClaim::bytes, 120};
  const FittedTree fitted = fit_wavelet(read_tree_cells(source, {}, {}), {}, options, nullptr);
  ASSERT_NE(fitted.file, nullptr);
  EXPECT_LT(fitted.errors.max_error_m, 1e-4);
}

}  // namespace
}  // namespace arete
