#include "gis/compression_trial.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "gis/dem_file.h"
#include "gis/peer_codecs.h"
#include "tests/data.h"

namespace arete {
namespace {

using Kind = CodingTarget::Kind;

constexpr double relief = 100;

TestedTerrain slope(std::int64_t side = 64) {
  Raster<float> cells(side, side);
  for (std::int64_t y = 0; y < side; ++y)
    for (std::int64_t x = 0; x < side; ++x) cells(x, y) = static_cast<float>(relief * static_cast<double>(x) / static_cast<double>(side - 1));
  return examine_terrain("slope", std::move(cells));
}

/// A codec whose law is known: a setting s gives 256 / s bytes and an error of 0.1 s metres everywhere, so that the PSNR falls by 20 dB where
/// the size falls by ten.
class LawfulCodec final : public CodecUnderTest {
 public:
  explicit LawfulCodec(bool sized) : sized_(sized) {}
  std::string name() const override { return "lawful"; }
  std::string title() const override { return "Lawful"; }
  std::string description() const override { return "a law"; }
  bool keeps_voids() const override { return false; }
  std::int64_t bytes_per_cell() const override { return 0; }
  bool can(const TestedTerrain&, CodingTarget target) const override { return target.kind == (sized_ ? Kind::bytes : Kind::setting); }
  std::optional<SettingsRange> settings_range(const TestedTerrain&) const override {
    return sized_ ? std::nullopt : std::optional(SettingsRange{10, 0.1});
  }
  std::vector<std::byte> encode(const TestedTerrain& terrain, CodingTarget target, int) const override {
    const double setting = sized_ ? 256 / target.value : target.value;
    std::vector<std::byte> file(std::max<std::size_t>(8, static_cast<std::size_t>(std::lround(256 / setting))));
    std::memcpy(file.data(), &setting, sizeof setting);
    last_ = &terrain;
    return file;
  }
  void decode(std::span<const std::byte> file, RasterView<float> out, int) const override {
    double setting = 0;
    std::memcpy(&setting, file.data(), sizeof setting);
    for (std::int64_t y = 0; y < out.height; ++y)
      for (std::int64_t x = 0; x < out.width; ++x) out(x, y) = last_->cells(x, y) + static_cast<float>(0.1 * setting);
  }

 private:
  bool sized_;
  mutable const TestedTerrain* last_ = nullptr;
};

// 64 x 64 cells and 256 / s bytes: 0.5 / s bits per sample; PSNR = 20 log10(100 / (0.1 s)).
TEST(TryCodec, ReadsTheLawOfACodecOffItsCurve) {
  const TestedTerrain terrain = slope();
  NoProgress progress;
  for (const bool sized : {false, true}) {
    const CodecTrial trial = try_codec(LawfulCodec(sized), terrain, {.rates = {0.1, 0.5, 2}, .lossless = true, .repeats = 1}, progress);
    ASSERT_EQ(trial.rates.size(), 3u);
    for (const auto& reading : trial.rates) {
      ASSERT_TRUE(reading) << sized;
      const double setting = 0.5 / reading->rate;
      // A byte of 51 at the lowest rate is 0.2 dB.
      EXPECT_NEAR(reading->psnr_db, 20 * std::log10(relief / (0.1 * setting)), 0.2) << reading->rate;
      EXPECT_NEAR(reading->max_error_m, 0.1 * setting, 0.05 * setting);
    }
    EXPECT_FALSE(trial.lossless);
    for (std::size_t i = 1; i < trial.curve.size(); ++i) EXPECT_LE(trial.curve[i - 1].bits, trial.curve[i].bits);
  }
}

TEST(TryCodec, HasNoReadingBeyondWhatACodecReaches) {
  NoProgress progress;
  // 0.05 to 5 bits per sample.
  const CodecTrial trial = try_codec(LawfulCodec(false), slope(), {.rates = {0.01, 8, 1}, .lossless = false, .repeats = 1}, progress);
  EXPECT_FALSE(trial.rates[0]);
  EXPECT_FALSE(trial.rates[1]);
  EXPECT_TRUE(trial.rates[2]);
}

/// Says that it cannot, and with what kind of error.
class UnwillingCodec final : public CodecUnderTest {
 public:
  explicit UnwillingCodec(ErrorKind kind) : kind_(kind) {}
  std::string name() const override { return "unwilling"; }
  std::string title() const override { return "Unwilling"; }
  std::string description() const override { return ""; }
  bool keeps_voids() const override { return true; }
  std::int64_t bytes_per_cell() const override { return 0; }
  bool can(const TestedTerrain&, CodingTarget) const override { return true; }
  std::optional<SettingsRange> settings_range(const TestedTerrain&) const override { return std::nullopt; }
  std::vector<std::byte> encode(const TestedTerrain&, CodingTarget, int) const override { throw Error(kind_, "no"); }
  void decode(std::span<const std::byte>, RasterView<float>, int) const override {}

 private:
  ErrorKind kind_;
};

TEST(TryCodec, LeavesOutTargetsThatCannotBeReachedAndHidesNoOtherFailure) {
  NoProgress progress;
  const TrialPlan plan{.rates = {0.1}, .bounds_m = {1}, .lossless = true, .repeats = 1};
  const CodecTrial trial = try_codec(UnwillingCodec(ErrorKind::usage), slope(), plan, progress);
  EXPECT_TRUE(trial.curve.empty());
  EXPECT_FALSE(trial.rates[0]);
  EXPECT_FALSE(trial.bounds[0]);
  EXPECT_FALSE(trial.lossless);
  EXPECT_THROW(try_codec(UnwillingCodec(ErrorKind::format), slope(), plan, progress), Error);
}

TEST(MeasureCodec, CountsErrorsOfValidCellsOnly) {
  Raster<float> cells = slope().cells.clone();
  cells(5, 5) = void_value;
  const TestedTerrain terrain = examine_terrain("hole", std::move(cells));
  const Measurement made = measure_codec(LawfulCodec(false), terrain, {Kind::setting, 1}, 3, 1);
  EXPECT_EQ(made.bytes, 256);
  EXPECT_EQ(made.bits, 0.5);
  EXPECT_NEAR(made.rmse_m, 0.1, 1e-5);
  EXPECT_NEAR(made.psnr_db, 60, 1e-3);
  EXPECT_NEAR(made.max_error_m, 0.1, 1e-5);
}

/// Loses a valid cell.
class LossyCodec final : public CodecUnderTest {
 public:
  std::string name() const override { return "lossy"; }
  std::string title() const override { return "Lossy"; }
  std::string description() const override { return ""; }
  bool keeps_voids() const override { return true; }
  std::int64_t bytes_per_cell() const override { return 0; }
  bool can(const TestedTerrain&, CodingTarget) const override { return true; }
  std::optional<SettingsRange> settings_range(const TestedTerrain&) const override { return std::nullopt; }
  std::vector<std::byte> encode(const TestedTerrain&, CodingTarget, int) const override { return std::vector<std::byte>(1); }
  void decode(std::span<const std::byte>, RasterView<float> out, int) const override { out(1, 0) = void_value; }
};

TEST(MeasureCodec, ALostCellBreaksEveryPromise) {
  const Measurement made = measure_codec(LossyCodec(), slope(), {Kind::max_error, 1e9}, 1, 1);
  EXPECT_EQ(made.max_error_m, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(kept(made));
  EXPECT_FALSE(std::isnan(made.psnr_db));
}

TEST(DefaultBounds, AreRoundAndSuitTheRelief) {
  TestedTerrain terrain;
  const auto bounds = [&](float low, float high, double quantum) {
    terrain.low = low, terrain.high = high, terrain.quantum = quantum;
    return default_bounds(terrain);
  };
  EXPECT_EQ(bounds(556, 3373, 1), (std::vector<double>{1, 2, 5, 10, 20}));
  EXPECT_EQ(bounds(188, 307, 0.01), (std::vector<double>{0.02, 0.05, 0.1, 0.2, 0.5}));
  EXPECT_EQ(bounds(-38, 115, 1), (std::vector<double>{1, 2, 5, 10, 20}));
  EXPECT_EQ(bounds(0, 1211, 0), (std::vector<double>{0.2, 0.5, 1, 2, 5}));
}

TEST(MeanGain, IsOverTheRatesThatBothReached) {
  CodecTrial anchor, test;
  anchor.rates = {RateReading{0.02, 40}, RateReading{0.1, 50}, RateReading{1, 60}, std::nullopt};
  test.rates = {RateReading{0.02, 90}, RateReading{0.1, 51}, RateReading{1, 63}, RateReading{2, 70}};
  EXPECT_EQ(mean_gain(anchor, test, 0.05, 2), 2);
  EXPECT_FALSE(mean_gain(anchor, test, 5, 6));
}

// Reference: an independent measurement of OpenJPEG 2.5 with these settings on the same DEM, PSNR at bits per sample.
TEST(TryCodec, OpenJpegOnRealTerrainIsAsGoodAsItShouldBe) {
  const std::string path = test_data("gabilan_lidar_1m.bil");
  if (path.empty()) GTEST_SKIP() << "no gabilan_lidar_1m.bil";
  NoProgress progress;
  const TestedTerrain terrain = examine_terrain(path, read_all(DemReader(path)));
  EXPECT_EQ(terrain.quantum, 0.01);
  const CodecTrial trial = try_codec(*make_openjpeg_codec(), terrain, {.rates = {0.05, 0.2, 2}, .lossless = true, .repeats = 1, .threads = 2}, progress);
  EXPECT_NEAR(trial.rates[0]->psnr_db, 62.70, 0.1);
  EXPECT_NEAR(trial.rates[1]->psnr_db, 71.93, 0.1);
  EXPECT_NEAR(trial.rates[2]->psnr_db, 85.98, 0.1);
  EXPECT_NEAR(trial.lossless->bits, 3.21, 0.005);
}

}  // namespace
}  // namespace arete
