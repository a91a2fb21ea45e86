#include "core/amplify/detail.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/amplify/amplified_terrain.h"
#include "core/amplify/consistent_stage.h"
#include "core/terrain/spectrum.h"
#include "tests/core/amplify/sample_dictionary.h"

namespace arete {
namespace {

Upsampler learned(int factor) { return train_upsampler({fractal_terrain(64 * factor, 64 * factor, 1).view()}, factor); }

TEST(MeasureDetail, IsAPropertyOfTheTerrainNotOfItsHeights) {
  const Upsampler upsampler = learned(4);
  Raster<float> terrain = fractal_terrain(256, 256, 2);
  const DetailMeasure once = measure_detail(terrain.view(), upsampler, 8);
  for (std::int64_t i = 0; i < terrain.size().cells(); ++i) terrain.data()[i] = 3 * (terrain.data()[i] - 3000);
  const DetailMeasure scaled = measure_detail(terrain.view(), upsampler, 8);
  EXPECT_EQ(once.patches, scaled.patches);
  EXPECT_NEAR(scaled.squared_detail / once.squared_detail, 9, 0.01);
  EXPECT_NEAR(scaled.power() / once.power(), 1, 0.005);
}

// 64 coarse cells less the upsampler's reach on both sides leave 56: 13 patches of 8, half overlapping, in each direction.
TEST(MeasureDetail, CountsThePatchesInsideAndOutsideVoids) {
  const Upsampler upsampler = learned(4);
  Raster<float> terrain = fractal_terrain(256, 256, 3);
  EXPECT_EQ(measure_detail(terrain.view(), upsampler, 8).patches, 13 * 13);
  terrain(130, 130) = void_value;
  const DetailMeasure holed = measure_detail(terrain.view(), upsampler, 8);
  EXPECT_LT(holed.patches, 13 * 13);
  EXPECT_GE(holed.patches, 13 * 13 - 25);  // the void's 9 x 9 neighbourhood touches at most 5 x 5 patches
  EXPECT_TRUE(std::isfinite(holed.power()));
}

TEST(MeasureDetail, OfNothingIsNothing) {
  const Upsampler upsampler = learned(4);
  EXPECT_EQ(measure_detail(Raster<float>(3, 200, 1.0f).view(), upsampler, 8).patches, 0);
  EXPECT_EQ(measure_detail(Raster<float>(40, 40, 1.0f).view(), upsampler, 8).patches, 0);
  EXPECT_EQ(measure_detail(Raster<float>(200, 200, void_value).view(), upsampler, 8).power(), 0);
  const DetailMeasure level = measure_detail(Raster<float>(200, 200, 1234.5f).view(), upsampler, 8);
  EXPECT_GT(level.patches, 0);
  EXPECT_EQ(level.power(), 0);
}

TEST(AddDetail, CompletesTheDictionary) {
  for (const int factor : {2, 3, 4}) {
    const Dictionary dictionary = fractal_dictionary(factor);
    ASSERT_TRUE(dictionary.upsampler);
    EXPECT_EQ(dictionary.detail.cols(), dictionary.atoms());
    EXPECT_EQ(dictionary.detail.rows(), 64 * factor * factor);
    EXPECT_TRUE(dictionary.detail.allFinite());
    EXPECT_GT(dictionary.detail.squaredNorm(), 0);
    EXPECT_GT(dictionary.detail_power, 0);
    if (factor > 2) {  // of 96 coarse cells 32 or 24 are left one factor coarser: 25 patches or fewer beside the upsampler's reach
      EXPECT_EQ(dictionary.coarse_detail_power, 0) << "too few patches to judge";
      continue;
    }
    // A fractal has the same detail at every scale, up to what sampling cuts off.
    EXPECT_NEAR(std::log2(dictionary.detail_power / dictionary.coarse_detail_power), 0, 0.5);
  }
}

// The point of the calibration: natural detail has the power of the truth, on terrain that the atoms do not come from.
TEST(AddDetail, NaturalDetailContinuesTheSpectrum) {
  for (const int factor : {2, 4}) {
    const Dictionary dictionary = fractal_dictionary(factor);
    const auto stage = make_consistent_stage(dictionary, {1, 1, 0, 2});
    for (const std::uint64_t seed : {31u, 32u}) {
      const Raster<float> truth = fractal_terrain(96 * factor, 96 * factor, seed), coarse = area_average(truth.view(), factor);
      const ViewSource source(coarse.view());
      const Raster<float> fine = read_all(AmplifiedTerrain(source, *stage, 2));
      const SpectrumComparison spectrum = compare_spectra(truth.view(), fine.view(), {factor, 64, 6 * factor, 2});
      ASSERT_GT(spectrum.tile, 0);
      for (const BandPower& band : spectrum.bands) {
        EXPECT_GT(band.ratio(), 0.8) << "factor " << factor << " from " << band.lower;
        EXPECT_LT(band.ratio(), 1.25) << "factor " << factor << " from " << band.lower;
      }
    }
  }
}

// An atom that is no real patch (K-SVD) takes the detail of the real patch most like it: here they are equal.
TEST(AddDetail, AnAtomWithoutSourceTakesTheDetailOfThePatchMostLikeIt) {
  const Raster<float> exemplar = fractal_terrain(192, 192, 4);
  const PatchGrid grid = make_patch_grid(8);
  Dictionary known = pair_dictionary(exemplar.view(), 4, grid, PatchEdges::inside, 5);
  Dictionary unknown = pair_dictionary(exemplar.view(), 4, grid, PatchEdges::inside, 5);
  for (std::size_t j = 0; j < unknown.sources.size(); j += 2) unknown.sources[j] = {};
  const std::vector<AtomSource> labels = unknown.sources;
  NoProgress silent;
  add_detail(known, {exemplar.view()}, 2, silent);
  add_detail(unknown, {exemplar.view()}, 2, silent);
  EXPECT_LT((known.detail - unknown.detail).norm(), 1e-5 * known.detail.norm());
  for (std::size_t j = 0; j < labels.size(); ++j) EXPECT_EQ(unknown.sources[j].exemplar, labels[j].exemplar) << "the label stays";
}

TEST(AddDetail, ThreadsChangeNoBit) {
  const Raster<float> a = fractal_terrain(200, 160, 5), b = fractal_terrain(130, 150, 6);
  Dictionary one = pair_dictionary(a.view(), 3, make_patch_grid(6), PatchEdges::inside, 4);
  Dictionary many = pair_dictionary(a.view(), 3, make_patch_grid(6), PatchEdges::inside, 4);
  NoProgress silent;
  add_detail(one, {a.view(), b.view()}, 1, silent);
  add_detail(many, {a.view(), b.view()}, 7, silent);
  EXPECT_EQ(one.detail_power, many.detail_power);
  EXPECT_EQ(one.coarse_detail_power, many.coarse_detail_power);
  EXPECT_TRUE(one.detail == many.detail);
}

TEST(AddDetail, AnExemplarWithVoidsOrTooSmallToCalibrateStillWorks) {
  Raster<float> holed = fractal_terrain(240, 240, 7);
  make_void(holed, {60, 70, 50, 40});
  Raster<float> small = fractal_terrain(52, 48, 8);
  for (const Raster<float>* exemplar : {&holed, &small}) {
    Dictionary dictionary = pair_dictionary(exemplar->view(), 4, make_patch_grid(8), PatchEdges::inside, 1);
    ASSERT_GT(dictionary.atoms(), 0);
    NoProgress silent;
    add_detail(dictionary, {exemplar->view()}, 2, silent);
    EXPECT_TRUE(dictionary.detail.allFinite());
    EXPECT_TRUE(std::isfinite(dictionary.detail_power));
  }
}

}  // namespace
}  // namespace arete
