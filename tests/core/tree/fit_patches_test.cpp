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

TEST(FitPatches, AGivenDictionaryIsNamedAndNotStored) {
  const Raster<float> terrain = codec_terrain(120, 100);
  Raster<double> stored(120, 100);
  for (std::int64_t i = 0; i < terrain.size().cells(); ++i) stored.data()[i] = terrain.data()[i];
  const TreeHeader header;
  const TreeCells cells = read_tree_cells(MemoryStored(stored.clone()), header, {});
  Eigen::MatrixXf atoms = Eigen::MatrixXf::Zero(64, 3);
  for (Eigen::Index i = 0; i < 64; ++i) atoms.row(i) << static_cast<float>(i % 8) - 3.5F, static_cast<float>(i / 8) - 3.5F, (i % 8 < 4) == (i < 32) ? 1.0F : -1.0F;
  atoms.colwise().normalize();
  CompressOptions options;
  options.profile = TreeProfile::paper;
  options.patches.radius = 4;
  options.patches.dictionary = &atoms;
  options.patches.dictionary_name = "00112233445566778899aabbccddeeff";
  const FittedTree fitted = fit_patches(cells, header, options, nullptr);

  std::vector<std::string> asked;
  const auto find = [&](const std::string& digest) {
    asked.push_back(digest);
    return atoms;
  };
  const ElevationTree tree(TreeFile(fitted.file, "named.sct"), 1, find);
  EXPECT_EQ(asked, std::vector{options.patches.dictionary_name});
  EXPECT_EQ(named_dictionary(tree.header().parameters), options.patches.dictionary_name);
  EXPECT_EQ(measure_tree(tree, MemoryStored(std::move(stored)), 1 << 24).rmse_m, fitted.errors.rmse_m);
  EXPECT_LT(fitted.errors.rmse_m, 30);
  EXPECT_THROW(ElevationTree(TreeFile(fitted.file, "named.sct")), Error);

  options.patches.dictionary_name.clear();
  const FittedTree whole = fit_patches(cells, header, options, nullptr);
  EXPECT_EQ(named_dictionary(TreeFile(whole.file, "whole.sct").header().parameters), "");
}

}  // namespace
}  // namespace arete
