#include "gis/paper_trial.h"

#include <gtest/gtest.h>

#include "core/codec/patch_coder.h"
#include "core/synthesis/mountains.h"
#include "gis/peer_codecs.h"

namespace arete {
namespace {

TEST(PaperTrial, MoreCoefficientsTakeMoreBytesAndComeCloser) {
  const TestedTerrain terrain = examine_terrain("mountains", synthesize_mountains({200, 160}, {.relief_m = 500}));
  NoProgress progress;
  const std::vector<PaperRow> rows = try_paper_profile(terrain, *make_openjpeg_codec(), 2, progress);
  ASSERT_EQ(rows.size(), 3u);
  const int side = 2 * PatchCodingOptions().radius;
  // Discs at pitch R, one row and column beyond the border (core/codec/patch-format.md, section 3).
  const std::int64_t discs = (199 / 7 + 2) * (159 / 7 + 2);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const PaperRow& row = rows[i];
    EXPECT_EQ(row.sparsity, paper_sparsities[i]);
    const ValueRatio ratio = value_ratio(paper_atoms, disc_samples(side), discs, row.sparsity, 200 * 160);
    EXPECT_DOUBLE_EQ(row.ratio.printed, ratio.printed);
    EXPECT_DOUBLE_EQ(row.ratio.tabulated, ratio.tabulated);
    EXPECT_DOUBLE_EQ(row.tree.bits, 8.0 * static_cast<double>(row.tree.bytes) / (200 * 160));
    if (i > 0) {
      EXPECT_GT(row.tree.bytes, rows[i - 1].tree.bytes);
      EXPECT_GT(row.tree.psnr_db, rows[i - 1].tree.psnr_db);
      EXPECT_GT(row.jpeg2000.psnr_db, rows[i - 1].jpeg2000.psnr_db);
    }
    // OpenJPEG cuts its stream at whole coding passes, which are long in a small raster.
    EXPECT_NEAR(static_cast<double>(row.jpeg2000.bytes), static_cast<double>(row.tree.bytes), 0.03 * static_cast<double>(row.tree.bytes));
  }
}

}  // namespace
}  // namespace arete
