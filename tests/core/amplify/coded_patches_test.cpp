#include "core/amplify/coded_patches.h"

#include <gtest/gtest.h>

#include "core/sparse/patches.h"
#include "tests/core/amplify/sample_terrain.h"

namespace arete {
namespace {

constexpr std::int64_t margin = 7;  // patch_cells - 1

struct Case {
  Raster<float> terrain = fractal_terrain(60, 50, 1);
  PatchGrid grid = make_patch_grid(8, 4);
  CodingDictionary dictionary;
  Case() {
    const Raster<float> exemplar = fractal_terrain(96, 96, 2);
    const Patches patches = extract_patches(exemplar.view(), grid);
    dictionary = prepare_coding(patches.values.colwise().normalized(), 2);
  }
  /// The window of the whole (origin 0, 0), which lies at least a margin inside.
  CodedPatches code(const Window& window, int threads, const ActivityMeter* meter = nullptr) const {
    const Window with_margin{window.x - margin, window.y - margin, window.width + 2 * margin, window.height + 2 * margin};
    return code_patches(terrain.view().sub(with_margin), with_margin.x, with_margin.y, window, grid, dictionary, 2, meter, threads);
  }
};

TEST(CodedPatches, AreThePatchesOfTheTerrainAndTheirCodes) {
  const Case c;
  const ActivityMeter meter(8);
  const CodedPatches coded = c.code({10, 10, 30, 25}, 2, &meter);
  std::vector<float> cells(64);
  for (std::int64_t row = coded.rows.begin; row < coded.rows.end; ++row)
    for (std::int64_t column = coded.columns.begin; column < coded.columns.end; ++column) {
      const std::int64_t i = coded.index(column, row);
      ASSERT_TRUE(cut_cells(c.terrain.view(), patch_origin(c.grid, column), patch_origin(c.grid, row), 8, 0, cells.data()));
      EXPECT_EQ(coded.activity[static_cast<std::size_t>(i)], meter.measure(cells.data()));
      EXPECT_EQ(coded.means[static_cast<std::size_t>(i)], make_patch(c.grid, cells.data()));
      EXPECT_EQ(coded.known[static_cast<std::size_t>(i)], 1);
      const SparseCodes alone = omp(c.dictionary, Eigen::Map<const Eigen::MatrixXf>(cells.data(), 64, 1), 2);
      EXPECT_EQ(coded.codes.atoms.col(i), alone.atoms.col(0));
      EXPECT_EQ(coded.codes.coefficients.col(i), alone.coefficients.col(0));
    }
}

TEST(CodedPatches, TouchTheWindowAndNoOtherDoes) {
  const Case c;
  const Window window{11, 9, 17, 22};
  const CodedPatches coded = c.code(window, 1);
  const auto touches = [&](std::int64_t k, std::int64_t begin, std::int64_t end) {
    return patch_origin(c.grid, k) < end && patch_origin(c.grid, k) + 8 > begin;
  };
  for (std::int64_t k = -5; k < 30; ++k) {
    EXPECT_EQ(k >= coded.columns.begin && k < coded.columns.end, touches(k, 11, 28)) << k;
    EXPECT_EQ(k >= coded.rows.begin && k < coded.rows.end, touches(k, 9, 31)) << k;
  }
}

TEST(CodedPatches, WithAVoidCellAreUnknownAndEmpty) {
  Case c;
  c.terrain(25, 25) = void_value;
  const CodedPatches coded = c.code({10, 10, 30, 25}, 3);
  std::int64_t unknown = 0;
  for (std::int64_t row = coded.rows.begin; row < coded.rows.end; ++row)
    for (std::int64_t column = coded.columns.begin; column < coded.columns.end; ++column) {
      const std::int64_t x = patch_origin(c.grid, column), y = patch_origin(c.grid, row), i = coded.index(column, row);
      const bool has_void = x <= 25 && x + 8 > 25 && y <= 25 && y + 8 > 25;
      EXPECT_EQ(coded.known[static_cast<std::size_t>(i)], has_void ? 0 : 1);
      if (has_void) {
        EXPECT_EQ(coded.codes.atoms(0, i), -1);
        EXPECT_EQ(coded.codes.coefficients(0, i), 0);
      }
      unknown += has_void;
    }
  EXPECT_EQ(unknown, 4);
}

TEST(CodedPatches, DoNotDependOnTheWindow) {
  const Case c;
  const CodedPatches whole = c.code({8, 8, 44, 34}, 2), part = c.code({21, 17, 9, 11}, 1);
  for (std::int64_t row = part.rows.begin; row < part.rows.end; ++row)
    for (std::int64_t column = part.columns.begin; column < part.columns.end; ++column) {
      EXPECT_EQ(part.codes.atoms.col(part.index(column, row)), whole.codes.atoms.col(whole.index(column, row)));
      EXPECT_EQ(part.codes.coefficients.col(part.index(column, row)), whole.codes.coefficients.col(whole.index(column, row)));
    }
}

}  // namespace
}  // namespace arete
