#include "core/tree/fit_patches.h"

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "tests/core/codec/codec_terrain.h"
#include "tests/core/tree/tree_sources.h"

namespace arete {
namespace {

TEST(FitPatches, MoreCoefficientsComeCloserAndCostMore) {
  const Raster<float> terrain = codec_terrain(120, 100);
  Raster<double> stored(120, 100);
  for (std::int64_t i = 0; i < terrain.size().cells(); ++i) stored.data()[i] = terrain.data()[i];
  const TreeHeader header;
  const TreeCells cells = read_tree_cells(MemoryStored(std::move(stored)), header, {});
  CompressOptions options;
  options.profile = TreeProfile::paper;
  options.patches.atoms = 16;
  double error = 1e30, ratio = 0;
  for (int sparsity : {1, 4}) {
    options.patches.sparsity = sparsity;
    const FittedTree fitted = fit_patches(cells, header, options, nullptr);
    EXPECT_EQ(fitted.coder, TreeCoder::patches);
    ASSERT_TRUE(fitted.value_ratio);
    EXPECT_LT(fitted.errors.rmse_m, error);
    EXPECT_GT(fitted.value_ratio->printed, ratio);
    error = fitted.errors.rmse_m;
    ratio = fitted.value_ratio->printed;
  }
}

TEST(FitPatches, SaysWhenTheRasterDoesNotFit) {
  const MemoryStored source(Raster<double>(300, 300, 7));
  CompressOptions options;
  options.scratch.memory_bytes = 1 << 20;
  try {
    fit_patches(read_tree_cells(source, {}, options.scratch), {}, options, nullptr);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::memory);
  }
}

}  // namespace
}  // namespace arete
