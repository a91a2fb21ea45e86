// What each codec promises the benchmark, on small mountains.
#include "gis/peer_codecs.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/synthesis/mountains.h"
#include "gis/compression_trial.h"

namespace arete {
namespace {

using Kind = CodingTarget::Kind;

enum class Data { metres, centimetres, floats };

TestedTerrain mountains(Data data, bool hole, Size size = {130, 90}) {
  Raster<float> cells = synthesize_mountains(size, {.relief_m = 500});
  const double quantum = data == Data::metres ? 1 : 0.01;
  if (data != Data::floats)
    for (std::int64_t i = 0; i < cells.size().cells(); ++i)
      cells.data()[i] = static_cast<float>(std::round(static_cast<double>(cells.data()[i]) / quantum) * quantum);
  if (hole)
    for (std::int64_t y = 30; y < 40; ++y)
      for (std::int64_t x = 50; x < 70; ++x) cells(x, y) = void_value;
  return examine_terrain("mountains", std::move(cells));
}

class PeerCodec : public testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override { codec_ = std::move(all_codecs()[GetParam()]); }
  std::unique_ptr<CodecUnderTest> codec_;
};

TEST_P(PeerCodec, KeepsStrictErrorsAndLosslessness) {
  for (const Data data : {Data::metres, Data::centimetres, Data::floats}) {
    const TestedTerrain terrain = mountains(data, data != Data::centimetres);
    for (const CodingTarget target : {CodingTarget{Kind::lossless, 0}, CodingTarget{Kind::max_error, 0.05}, CodingTarget{Kind::max_error, 3}}) {
      if (!codec_->can(terrain, target)) continue;
      const Measurement made = measure_codec(*codec_, terrain, target, 1, 2);
      EXPECT_TRUE(kept(made)) << codec_->name() << " of " << target.value << ": " << made.max_error_m << " quantum " << terrain.quantum;
      EXPECT_GT(made.bytes, 100);
    }
  }
}

TEST_P(PeerCodec, DecodesVoidsWhereItKeepsThem) {
  const TestedTerrain terrain = mountains(Data::metres, true);
  for (const CodingTarget target : {CodingTarget{Kind::lossless, 0}, CodingTarget{Kind::max_error, 1}, CodingTarget{Kind::setting, 1}, CodingTarget{Kind::bytes, 3000}}) {
    if (!codec_->can(terrain, target)) continue;
    Raster<float> decoded(terrain.cells.width(), terrain.cells.height());
    codec_->decode(codec_->encode(terrain, target, 1), decoded.view(), 1);
    for (std::int64_t i = 0; i < decoded.size().cells(); ++i)
      ASSERT_EQ(is_void(decoded.data()[i]), codec_->keeps_voids() && is_void(terrain.cells.data()[i])) << codec_->name() << " at " << i;
  }
}

TEST_P(PeerCodec, SpendsWhatItIsAskedTo) {
  const TestedTerrain terrain = mountains(Data::floats, false, {256, 256});
  const double bytes = 8000;
  // What takes no size has a setting to search.
  ASSERT_NE(codec_->can(terrain, {Kind::bytes, bytes}), codec_->settings_range(terrain).has_value());
  if (codec_->settings_range(terrain)) return;
  // OpenJPEG cuts its stream at whole coding passes.
  EXPECT_NEAR(static_cast<double>(measure_codec(*codec_, terrain, {Kind::bytes, bytes}, 1, 2).bytes), bytes, 0.03 * bytes);
}

TEST_P(PeerCodec, ItsSettingGoesFromCoarseToFine) {
  const TestedTerrain terrain = mountains(Data::floats, false);
  const auto range = codec_->settings_range(terrain);
  ASSERT_EQ(codec_->can(terrain, {Kind::setting, 1}), range.has_value());
  if (!range) return;
  double last_bytes = 0, last_psnr = -100;
  for (const double share : {0.3, 0.5, 0.7, 0.9}) {
    const double setting = std::exp(std::lerp(std::log(range->coarse), std::log(range->fine), share));
    const Measurement made = measure_codec(*codec_, terrain, {Kind::setting, setting}, 1, 2);
    EXPECT_GT(static_cast<double>(made.bytes), last_bytes) << codec_->name() << " at " << setting;
    EXPECT_GT(made.psnr_db, last_psnr) << codec_->name() << " at " << setting;
    last_bytes = static_cast<double>(made.bytes);
    last_psnr = made.psnr_db;
  }
}

// High above the sea floats are coarse: 1.2e-4 m at 1300 m.
TEST_P(PeerCodec, CanUseAllItsSettingsHighAboveTheSea) {
  Raster<float> cells(40, 30);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = 1300 + static_cast<float>(std::sin(static_cast<double>(i)));
  const TestedTerrain terrain = examine_terrain("plateau", std::move(cells));
  const auto range = codec_->settings_range(terrain);
  if (!range) return;
  for (const double setting : {range->coarse, range->fine}) {
    EXPECT_TRUE(codec_->can(terrain, {Kind::setting, setting})) << codec_->name() << " " << setting;
    EXPECT_LT(measure_codec(*codec_, terrain, {Kind::setting, setting}, 1, 1).max_error_m, 3) << codec_->name() << " " << setting;
  }
}

TEST_P(PeerCodec, RefusesDamagedBytes) {
  const TestedTerrain terrain = mountains(Data::metres, false);
  const CodingTarget target = codec_->can(terrain, {Kind::lossless, 0}) ? CodingTarget{Kind::lossless, 0} : CodingTarget{Kind::bytes, 2000};
  const std::vector<std::byte> file = codec_->encode(terrain, target, 1);
  Raster<float> decoded(terrain.cells.width(), terrain.cells.height());
  EXPECT_THROW(codec_->decode(std::span(file).first(40), decoded.view(), 1), Error) << codec_->name();
  EXPECT_THROW(codec_->decode({}, decoded.view(), 1), Error) << codec_->name();
}

TEST_P(PeerCodec, SmallRastersToo) {
  Raster<float> cells(3, 1);
  cells(0, 0) = 1, cells(1, 0) = 5, cells(2, 0) = 2;
  const TestedTerrain terrain = examine_terrain("tiny", std::move(cells));
  for (const CodingTarget target : {CodingTarget{Kind::lossless, 0}, CodingTarget{Kind::bytes, 120}, CodingTarget{Kind::setting, 1}})
    if (codec_->can(terrain, target)) {
      EXPECT_LE(measure_codec(*codec_, terrain, target, 1, 1).max_error_m, 4) << codec_->name();
    }
}

INSTANTIATE_TEST_SUITE_P(All, PeerCodec, testing::Range<std::size_t>(0, 7), [](const auto& one) {
  std::string name = all_codecs()[one.param]->name();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(PeerCodecs, HaveTheirOwnNamesAndOpenJpegFirst) {
  std::set<std::string> names;
  for (const auto& codec : all_codecs()) names.insert(codec->name());
  EXPECT_EQ(names.size(), all_codecs().size());
  EXPECT_EQ(names.size(), 7u);
  EXPECT_EQ(all_codecs().front()->name(), "sct");
  EXPECT_EQ(peer_codecs().front()->name(), "openjpeg");
}

}  // namespace
}  // namespace arete
