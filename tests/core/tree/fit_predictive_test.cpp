#include "core/tree/fit_predictive.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/support/error.h"
#include "core/support/random.h"
#include "core/support/random.h"
#include "tests/core/codec/codec_terrain.h"
#include "tests/core/tree/tree_sources.h"

namespace arete {
namespace {

MemoryStored rounded(double quantum, bool hole) {
  const Raster<float> terrain = codec_terrain(150, 110);
  Raster<double> cells(150, 110);
  for (std::int64_t y = 0; y < 110; ++y)
    for (std::int64_t x = 0; x < 150; ++x)
      cells(x, y) = hole && x > 60 && y > 70 ? std::nan("") : static_cast<float>(std::round(terrain(x, y) / quantum) * quantum);
  return MemoryStored(std::move(cells));
}

TreeHeader header_of(ValueType type) {
  TreeHeader header;
  header.type = type;
  return header;
}

FittedTree fit(const MemoryStored& source, ValueType type, const CompressionTarget& target) {
  TreeHeader header = header_of(type);
  header.claim = target.kind;
  header.claimed = target.value;
  CompressOptions options;
  options.target = target;
  return fit_predictive(read_tree_cells(source, header, options.scratch), header, options, nullptr);
}

TEST(FitPredictive, LosslessIsEveryBit) {
  for (const bool hole : {false, true})
    for (const auto& [quantum, type] : {std::pair{1.0, ValueType::int16}, std::pair{0.01, ValueType::float32}, std::pair{1e-5, ValueType::float32}}) {
      const FittedTree fitted = fit(rounded(quantum, hole), type, {TreeClaim::lossless, 0});
      EXPECT_EQ(fitted.errors.differs, 0) << quantum;
      EXPECT_EQ(fitted.errors.void_differs, 0);
      EXPECT_EQ(fitted.coder, TreeCoder::predictive);
    }
}

TEST(FitPredictive, NoCellBreaksTheBoundAndWiderBoundsAreSmaller) {
  for (const auto& [quantum, type] : {std::pair{1.0, ValueType::int16}, std::pair{1e-5, ValueType::float32}}) {
    std::uint64_t bytes = 1 << 30;
    for (double bound : {1.0, 3.0, 12.0}) {
      const FittedTree fitted = fit(rounded(quantum, true), type, {TreeClaim::max_error, bound});
      EXPECT_LE(fitted.errors.max_error_m, bound);
      EXPECT_GT(fitted.errors.max_error_m, 0.5 * bound);
      EXPECT_LT(fitted.file->size(), bytes);
      bytes = fitted.file->size();
    }
  }
}

// Doubles with noise down to their last bit, with a hole, in several levels of nodes.
TEST(FitPredictive, AnyDoublesAreLossless) {
  Raster<double> cells(150, 90);
  for (std::int64_t y = 0; y < 90; ++y)
    for (std::int64_t x = 0; x < 150; ++x) cells(x, y) = x > 100 && y < 20 ? std::nan("") : 700 + 9 * std::sin(x * 0.1) + uniform_at(3, x, y);
  const MemoryStored source(std::move(cells));
  CompressOptions options;
  options.target = {TreeClaim::lossless, 0};
  options.node_side = 32;
  const MadeTree made = make_tree(source, header_of(ValueType::float64), options);
  EXPECT_EQ(made.report.differs, 0);
  EXPECT_EQ(made.report.void_differs, 0);
  const ElevationTree tree = open_tree(made);
  const Window window{11, 23, 7, 9};  // of level 1
  Raster<double> part(window.width, window.height);
  tree.read_stored(1, window, part.view());
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x) EXPECT_EQ(part(x, y), source.cells()(2 * (window.x + x), 2 * (window.y + y)));
}

// Centimetres but for 3 % of the cells and one seam, with a hole, in several levels of nodes.
MemoryStored nearly_rounded(bool noise) {
  const Raster<float> terrain = codec_terrain(150, 110);
  Raster<double> cells(150, 110);
  for (std::int64_t y = 0; y < 110; ++y)
    for (std::int64_t x = 0; x < 150; ++x) {
      const auto u = static_cast<std::uint64_t>(x), v = static_cast<std::uint64_t>(y);
      const double whole = std::round(static_cast<double>(terrain(x, y)) * 100) / 100, off = 0.003 * uniform_at(4, u, v);
      const bool other = noise && (y == 40 || uniform_at(3, u, v) < 0.03);
      cells(x, y) = x > 100 && y < 20 ? std::nan("") : static_cast<float>(other ? whole + off : whole);
    }
  return MemoryStored(std::move(cells));
}

TEST(FitPredictive, FloatsNearlyAllOfAQuantumAreLosslessAndSmall) {
  CompressOptions options;
  options.target = {TreeClaim::lossless, 0};
  options.node_side = 32;
  options.threads = 1;
  const MemoryStored source = nearly_rounded(true);
  const MadeTree made = make_tree(source, header_of(ValueType::float32), options);
  EXPECT_EQ(made.report.differs, 0);
  EXPECT_EQ(made.report.void_differs, 0);
  // An exception costs less than a byte to tell and two to give.
  EXPECT_LT(made.file.size(), make_tree(nearly_rounded(false), header_of(ValueType::float32), options).file.size() + 3 * (150 + 110 * 150 * 3 / 100));
  options.threads = 4;
  EXPECT_EQ(make_tree(source, header_of(ValueType::float32), options).file, made.file);
  const ElevationTree tree = open_tree(made, 3);
  for (int level = 0; level <= tree.header().grid.levels(); ++level) {
    const Size size = tree.header().grid.level_size(level);
    for (const Window& window : {Window{0, 0, size.width, size.height}, Window{size.width / 3, size.height / 4, size.width / 2, size.height / 3 + 1}}) {
      Raster<double> part(window.width, window.height);
      tree.read_stored(level, window, part.view());
      for (std::int64_t y = 0; y < window.height; ++y)
        for (std::int64_t x = 0; x < window.width; ++x) {
          const double value = source.cells()((window.x + x) << level, (window.y + y) << level);
          ASSERT_TRUE(part(x, y) == value || (std::isnan(part(x, y)) && std::isnan(value))) << level << " " << x << " " << y;
        }
    }
  }
}

// Whole metres about a nodata value of 0, as on a coast: what is decoded to 0 is written as 1, which is 2 m from -1.
TEST(FitPredictive, KeepsTheBoundAsWrittenWithANodataValueAmidTheElevations) {
  Raster<double> cells(150, 110);
  for (std::int64_t y = 0; y < 110; ++y)
    for (std::int64_t x = 0; x < 150; ++x) {
      const double height = std::round(4 * std::sin(0.08 * static_cast<double>(x)) * std::cos(0.1 * static_cast<double>(y)) +
                                       2 * uniform_at(5, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)) - 1);
      cells(x, y) = height == 0 ? -1 : height;
    }
  const MemoryStored source(std::move(cells));
  for (const ValueType type : {ValueType::int16, ValueType::float32, ValueType::float64})
    for (const double bound : {1.0, 2.0}) {
      TreeHeader header = header_of(type);
      header.geo.nodata = 0;
      header.claim = TreeClaim::max_error;
      header.claimed = bound;
      CompressOptions options;
      options.target = {TreeClaim::max_error, bound};
      const FittedTree fitted = fit_predictive(read_tree_cells(source, header, {}), header, options, nullptr);
      const ElevationTree tree(TreeFile(fitted.file, "coast.sct"));
      Raster<double> decoded(150, 110);
      tree.read_stored(0, {0, 0, 150, 110}, decoded.view());
      for (std::int64_t i = 0; i < decoded.size().cells(); ++i) {
        const double written = decoded.data()[i] == 0 ? next_value(type, 0) : decoded.data()[i];
        ASSERT_LE(std::abs(written - source.cells().data()[i]), bound) << i << " " << name_of(type);
      }
      // Without the nodata value the bound of 1 m is reached, by cells of -1 that come out as 0.
      header.geo.nodata.reset();
      const FittedTree free = fit_predictive(read_tree_cells(source, header, {}), header, options, nullptr);
      if (type == ValueType::int16) {
        EXPECT_LT(free.file->size(), fitted.file->size());
      }
      EXPECT_NEAR(free.errors.max_error_m, bound, 1e-5 * bound);
    }
}

TEST(FitPredictive, RefusesABoundBelowTheTypesOwn) {
  EXPECT_THROW(fit(rounded(1e-5, false), ValueType::float32, {TreeClaim::max_error, 1e-6}), Error);
}

}  // namespace
}  // namespace arete
