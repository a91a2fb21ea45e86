#include "core/tree/compress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/support/error.h"
#include "tests/core/codec/codec_terrain.h"
#include "tests/core/tree/tree_sources.h"

namespace arete {
namespace {

// Whole metres, with a hole where asked for.
MemoryStored whole_metres(std::int64_t width, std::int64_t height, bool hole) {
  const Raster<float> terrain = codec_terrain(width, height);
  Raster<double> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = hole && std::hypot(x - width / 3, y - height / 2) < static_cast<double>(height) / 5 ? std::nan("") : std::round(terrain(x, y));
  return MemoryStored(std::move(cells));
}

TreeHeader int16_header() {
  TreeHeader header;
  header.type = ValueType::int16;
  return header;
}

struct Measured {
  double rmse = 0, max = 0;
  std::int64_t valid = 0;
};

// By a comparison of its own, not the one in the encoder.
Measured compare(const MemoryStored& source, const MadeTree& made) {
  const Size size = source.size();
  Raster<double> decoded(size.width, size.height);
  open_tree(made, 2).read_stored(0, {0, 0, size.width, size.height}, decoded.view());
  Measured measured;
  for (std::int64_t i = 0; i < size.cells(); ++i) {
    EXPECT_EQ(std::isnan(decoded.data()[i]), std::isnan(source.cells().data()[i])) << i;
    if (std::isnan(source.cells().data()[i])) continue;
    const double error = std::abs(decoded.data()[i] - source.cells().data()[i]);
    measured.rmse += error * error;
    measured.max = std::max(measured.max, error);
    ++measured.valid;
  }
  measured.rmse = std::sqrt(measured.rmse / static_cast<double>(measured.valid));
  return measured;
}

TEST(Compress, ReachesThePsnrAndSaysWhatItMeasured) {
  const MemoryStored source = whole_metres(300, 200, false);
  for (double psnr : {35.0, 45.0, 55.0}) {
    CompressOptions options;
    options.target = {TreeClaim::psnr, psnr};
    const MadeTree made = make_tree(source, int16_header(), options);
    EXPECT_GE(made.report.psnr_db(), psnr);
    EXPECT_LT(made.report.psnr_db(), psnr + 0.2);
    const Measured measured = compare(source, made);
    EXPECT_NEAR(measured.rmse, made.report.rmse_m, 1e-9);
    EXPECT_EQ(measured.max, made.report.max_error_m);
    EXPECT_EQ(made.report.bytes, made.file.size());
  }
}

TEST(Compress, VoidsComeBackToTheCell) {
  const MemoryStored source = whole_metres(211, 180, true);
  CompressOptions options;
  options.target = {TreeClaim::rmse, 1.5};
  const MadeTree made = make_tree(source, int16_header(), options);
  const Measured measured = compare(source, made);
  EXPECT_LE(measured.rmse, 1.5);
  EXPECT_LT(measured.valid, 211 * 180);
  EXPECT_EQ(measured.valid, made.report.valid_cells);
}

TEST(Compress, KeepsToTheBytes) {
  const MemoryStored source = whole_metres(256, 256, false);
  for (double bytes : {700.0, 3000.0, 12000.0}) {
    CompressOptions options;
    options.target = {TreeClaim::bytes, bytes};
    const MadeTree made = make_tree(source, int16_header(), options);
    EXPECT_LE(static_cast<double>(made.file.size()), bytes);
    EXPECT_GE(static_cast<double>(made.file.size()), 0.95 * bytes);
  }
}

TEST(Compress, ErrorsAreInMetres) {
  const MemoryStored source = whole_metres(128, 128, false);
  TreeHeader header = int16_header();
  header.scale = 0.1;
  header.geo.vertical_unit = "foot";
  header.geo.metres_per_unit = 0.3048;
  CompressOptions options;
  options.target = {TreeClaim::rmse, 0.1};
  const MadeTree made = make_tree(source, header, options);
  EXPECT_NEAR(compare(source, made).rmse * 0.03048, made.report.rmse_m, 1e-9);
  EXPECT_LE(made.report.rmse_m, 0.1);
  EXPECT_GT(made.report.rmse_m, 0.09);
}

TEST(Compress, ThreadsGiveTheSameFile) {
  const MemoryStored source = whole_metres(300, 270, true);
  CompressOptions options;
  options.target = {TreeClaim::rmse, 2};
  options.threads = 1;
  const MadeTree one = make_tree(source, int16_header(), options);
  for (int threads : {2, 7}) {
    options.threads = threads;
    EXPECT_EQ(make_tree(source, int16_header(), options).file, one.file) << threads;
  }
}

TEST(Compress, MemoryAndFilesGiveTheSameFile) {
  const MemoryStored source = whole_metres(700, 530, true);
  for (const CompressionTarget& target : {CompressionTarget{TreeClaim::rmse, 2}, CompressionTarget{TreeClaim::lossless, 0}}) {
    CompressOptions options;
    options.target = target;
    const MadeTree held = make_tree(source, int16_header(), options);
    options.scratch = {1 << 16, std::filesystem::temp_directory_path().string()};
    EXPECT_EQ(make_tree(source, int16_header(), options).file, held.file);
  }
}

// Two lakes that touch, in terrain with a hole: exact at every level, beside cells that are not.
TEST(Compress, FlatWaterIsExactWhereAskedFor) {
  const Raster<float> terrain = codec_terrain(260, 200);
  Raster<double> cells(260, 200);
  for (std::int64_t y = 0; y < 200; ++y)
    for (std::int64_t x = 0; x < 260; ++x)
      cells(x, y) = y > 150 && x < 40 ? std::nan("") : y > 90 && x > 60 ? (x < 140 ? 417 : 415) : std::round(terrain(x, y));
  const MemoryStored source(std::move(cells));
  CompressOptions options;
  options.target = {TreeClaim::rmse, 8};
  options.node_side = 64;
  options.flat = FlatWater::exact;
  const MadeTree made = make_tree(source, int16_header(), options);
  const ElevationTree tree = open_tree(made, 2);
  std::int64_t off = 0;
  for (int level = 0; level <= 2; ++level) {
    const Size size = tree.level_size(level);
    Raster<double> decoded(size.width, size.height);
    tree.read_stored(level, {0, 0, size.width, size.height}, decoded.view());
    for (std::int64_t y = 0; y < size.height; ++y)
      for (std::int64_t x = 0; x < size.width; ++x) {
        const double truth = source.cells()(x << level, y << level);
        if ((y << level) > 90 && (x << level) > 60) ASSERT_EQ(decoded(x, y), truth) << level << ": " << x << ", " << y;
        else off += decoded(x, y) != truth;
        ASSERT_EQ(std::isnan(decoded(x, y)), std::isnan(truth));
      }
  }
  EXPECT_GT(off, 1000);
  Raster<double> part(50, 40), whole(260, 200);
  tree.read_stored(0, {0, 0, 260, 200}, whole.view());
  tree.read_stored(0, {111, 73, 50, 40}, part.view());
  for (std::int64_t y = 0; y < 40; ++y)
    for (std::int64_t x = 0; x < 50; ++x) EXPECT_EQ(part(x, y), whole(x + 111, y + 73));
}

// A ragged sea between hills: its mask costs much at a coarse quality, and little beside what ripples cost at a fine one. Automatic is the better
// of both, and knows a terrain without water.
TEST(Compress, FlatWaterIsExactWhereThatPays) {
  const Raster<float> terrain = codec_terrain(300, 240);
  Raster<double> cells(300, 240);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = terrain.data()[i];
  std::vector<double> sorted(cells.data(), cells.data() + cells.size().cells());
  std::nth_element(sorted.begin(), sorted.begin() + 28000, sorted.end());
  const double sea = static_cast<double>(static_cast<float>(sorted[28000]));
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = std::max(cells.data()[i], sea);
  const MemoryStored source(std::move(cells)), dry = whole_metres(200, 160, false);
  int paid = 0;
  for (const double rmse : {20.0, 0.02}) {
    const auto bytes = [&](const StoredSource& from, FlatWater flat) {
      CompressOptions options;
      options.target = {TreeClaim::rmse, rmse};
      options.flat = flat;
      return make_tree(from, TreeHeader(), options).file.size();
    };
    const std::size_t automatic = bytes(source, FlatWater::automatic), exact = bytes(source, FlatWater::exact), none = bytes(source, FlatWater::as_others);
    EXPECT_LE(automatic, none) << rmse;
    EXPECT_LE(static_cast<double>(automatic), 1.01 * static_cast<double>(exact)) << rmse;
    paid += automatic < none;
    EXPECT_EQ(bytes(dry, FlatWater::automatic), bytes(dry, FlatWater::as_others));
  }
  EXPECT_EQ(paid, 1);
}

TEST(Compress, TinyAndFlatRasters) {
  for (const Size size : {Size{1, 1}, Size{1, 50}, Size{3, 2}, Size{40, 40}}) {
    const MemoryStored source(Raster<double>(size.width, size.height, 417));
    CompressOptions options;
    options.target = {TreeClaim::rmse, 0.4};
    EXPECT_LE(compare(source, make_tree(source, int16_header(), options)).rmse, 0.4) << size.width << " x " << size.height;
  }
}

// Counts stages, and stops in one of them.
class Watcher final : public Progress {
 public:
  explicit Watcher(int stop_in) : stop_in_(stop_in) {}
  void begin(const std::string&, std::int64_t total) override {
    EXPECT_EQ(left_, 0) << "a stage began before the last one ended";
    left_ = total;
    ++stages;
  }
  void advance(std::int64_t done) override {
    left_ -= done;
    EXPECT_GE(left_, 0);
    if (stages == stop_in_) throw Error(ErrorKind::interrupted, "stopped");
  }
  void end() override {
    EXPECT_LE(left_, 2) << "of stage " << stages;  // what thirds and quarters round away
    left_ = 0;
  }
  int stages = 0;

 private:
  int stop_in_;
  std::int64_t left_ = 0;
};

TEST(Compress, EveryStageShowsItsProgressAndCanBeStopped) {
  const MemoryStored source = whole_metres(300, 200, true);
  for (const CompressionTarget& target : {CompressionTarget{TreeClaim::rmse, 2}, CompressionTarget{TreeClaim::max_error, 2}}) {
    CompressOptions options;
    options.target = target;
    Watcher whole(0);
    compress(source, int16_header(), options, [](std::span<const std::byte>) {}, &whole);
    ASSERT_GE(whole.stages, 3);
    for (int stage = 1; stage <= whole.stages; ++stage) {
      Watcher stopping(stage);
      const auto sink = [](std::span<const std::byte>) { FAIL() << "something was written"; };
      EXPECT_THROW(compress(source, int16_header(), options, sink, &stopping), Error) << "stage " << stage;
    }
  }
}

TEST(Compress, RefusesWhatCannotBe) {
  const MemoryStored voids(Raster<double>(5, 4, std::numeric_limits<double>::quiet_NaN()));
  EXPECT_THROW(make_tree(voids, int16_header(), {}), Error);
  CompressOptions options;
  options.target = {TreeClaim::bytes, 10};
  EXPECT_THROW(make_tree(whole_metres(100, 100, false), int16_header(), options), Error);
}

}  // namespace
}  // namespace arete
