#include "core/tree/measure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/support/random.h"
#include "tests/core/tree/tree_sources.h"

namespace arete {
namespace {

// A flat tree against an original that is off by hand.
TEST(Measure, CountsWhatIsOff) {
  Raster<double> flat(20, 10, 100), original(20, 10, 100);
  original(3, 2) = 103;
  original(4, 2) = 96;
  original(5, 5) = std::nan("");
  TreeHeader header;
  header.type = ValueType::int16;
  header.geo.metres_per_unit = 2;
  CompressOptions options;
  options.target = {TreeClaim::rmse, 0.5};
  const MadeTree made = make_tree(MemoryStored(std::move(flat)), header, options);
  const TreeErrors errors = measure_tree(open_tree(made), MemoryStored(std::move(original)), 1 << 20);
  EXPECT_EQ(errors.valid_cells, 199);
  EXPECT_EQ(errors.void_differs, 1);
  EXPECT_EQ(errors.differs, 2);
  EXPECT_DOUBLE_EQ(errors.max_error_m, 8);
  EXPECT_DOUBLE_EQ(errors.rmse_m, 2 * std::sqrt(25.0 / 199));
  EXPECT_DOUBLE_EQ(errors.highest_m - errors.lowest_m, 14);
  EXPECT_DOUBLE_EQ(errors.psnr_db(), 20 * std::log10(14 / errors.rmse_m));
}

TEST(Measure, CellsDecodedToTheNodataValueCountAsTheNextOne) {
  const MemoryStored original(Raster<double>(20, 10, 100));
  TreeHeader header;
  header.type = ValueType::int16;
  CompressOptions options;
  options.target = {TreeClaim::rmse, 0.4};
  MadeTree made = make_tree(original, header, options);
  EXPECT_EQ(made.report.differs, 0);
  header.geo.nodata = 100;
  options.target = {TreeClaim::max_error, 1};
  made = make_tree(original, header, options);
  EXPECT_EQ(made.report.differs, 200);
  EXPECT_EQ(made.report.max_error_m, 1);
  EXPECT_EQ(nodata_step(header), 1);
  header.geo.nodata = 0.5;
  EXPECT_EQ(nodata_step(header), 0) << "no integer";
}

// Wider than a window, so that sums come from several.
TEST(Measure, TheMemoryDoesNotChangeTheSums) {
  Raster<double> cells(2100, 1030);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = 100 + 40 * uniform_at(1, static_cast<std::uint64_t>(i));
  const MemoryStored source(std::move(cells));
  CompressOptions options;
  options.target = {TreeClaim::rmse, 5};
  const MadeTree made = make_tree(source, {}, options);
  const TreeErrors large = measure_tree(open_tree(made), source, std::int64_t{1} << 30), small = measure_tree(open_tree(made), source, 1);
  EXPECT_EQ(large.rmse_m, small.rmse_m);
  EXPECT_EQ(large.max_error_m, small.max_error_m);
  EXPECT_EQ(large.valid_cells, small.valid_cells);
  EXPECT_EQ(large.rmse_m, made.report.rmse_m);
}

TEST(Measure, ClaimsAreKeptOrNot) {
  TreeErrors errors;
  errors.bytes = 100;
  errors.cells = errors.valid_cells = 10;
  errors.highest_m = 10;
  errors.rmse_m = 1;
  errors.max_error_m = 3;
  errors.differs = 2;
  const auto keeps = [&](TreeClaim claim, double value) {
    TreeHeader header;
    header.claim = claim;
    header.claimed = value;
    return keeps_claim(header, errors);
  };
  EXPECT_TRUE(keeps(TreeClaim::psnr, 20));
  EXPECT_FALSE(keeps(TreeClaim::psnr, 20.1));
  EXPECT_TRUE(keeps(TreeClaim::rmse, 1));
  EXPECT_FALSE(keeps(TreeClaim::rmse, 0.99));
  EXPECT_TRUE(keeps(TreeClaim::max_error, 3));
  EXPECT_FALSE(keeps(TreeClaim::max_error, 2.999));
  EXPECT_TRUE(keeps(TreeClaim::bytes, 100));
  EXPECT_FALSE(keeps(TreeClaim::bytes, 99));
  EXPECT_FALSE(keeps(TreeClaim::lossless, 0));
  EXPECT_TRUE(keeps(TreeClaim::none, 0));
  errors.void_differs = 1;
  EXPECT_FALSE(keeps(TreeClaim::psnr, 20));
}

}  // namespace
}  // namespace arete
