#include "core/amplify/consistent_stage.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "core/amplify/amplified_terrain.h"
#include "core/support/error.h"
#include "core/terrain/flat_water.h"
#include "tests/core/amplify/sample_dictionary.h"

namespace arete {
namespace {

/// The parts that a stage takes of a dictionary, learned once.
Dictionary dictionary_for(int factor) {
  static std::map<int, Dictionary> learned;
  if (!learned.contains(factor)) learned[factor] = fractal_dictionary(factor);
  return learned[factor];
}

struct Bands {
  Raster<float> elevation, uncertainty, exemplar, atom;
};

Bands amplify_bands(const Raster<float>& coarse, int factor, const ConsistentOptions& options) {
  const auto stage = make_consistent_stage(dictionary_for(factor), options);
  const ViewSource source(coarse.view());
  const AmplifiedTerrain terrain(source, *stage, 2);
  const std::int64_t w = terrain.size().width, h = terrain.size().height;
  Bands bands{Raster<float>(w, h), Raster<float>(w, h), Raster<float>(w, h), Raster<float>(w, h)};
  terrain.read_bands({0, 0, w, h}, {bands.elevation.view(), bands.uncertainty.view(), bands.exemplar.view(), bands.atom.view()});
  return bands;
}

Raster<float> amplify_whole(const Raster<float>& coarse, int factor, double detail) {
  const auto stage = make_consistent_stage(dictionary_for(factor), {detail, 1, 0, 2});
  const ViewSource source(coarse.view());
  return read_all(AmplifiedTerrain(source, *stage, 2));
}

/// Mountains, a sea at 0 m, a lake at 80.25 m, voids inside, at the border and on the shore.
Raster<float> coast() {
  Raster<float> cells = fractal_terrain(60, 48, 7, 2, -150, 500);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = std::max(cells.data()[i], 0.0f);
  for (std::int64_t y = 30; y < 38; ++y)
    for (std::int64_t x = 40; x < 49; ++x) cells(x, y) = 80.25f;
  make_void(cells, {20, 18, 6, 9});
  make_void(cells, {0, 0, 3, 5});
  make_void(cells, {47, 34, 5, 2});
  cells(59, 20) = void_value;
  return cells;
}

TEST(ConsistentStage, TheAreaAverageOfTheResultIsTheInput) {
  for (const int factor : {2, 3, 4, 5})
    for (const double detail : {0.0, 0.5, 1.0}) {
      // Below 512 m floats are 0.03 mm apart; a cell sums 81 differences, each rounded.
      const Raster<float> sea = coast();
      EXPECT_LT(largest_difference(area_average(amplify_whole(sea, factor, detail).view(), factor).view(), sea.view()), 1e-4) << factor << " " << detail;
      const Raster<float> high = fractal_terrain(50, 40, 8);
      EXPECT_LT(inconsistency_ulp(high.view(), amplify_whole(high, factor, detail).view(), factor), 1) << factor << " " << detail;
      const Raster<float> rough = white_terrain(40, 30, 9);
      EXPECT_LT(inconsistency_ulp(rough.view(), amplify_whole(rough, factor, detail).view(), factor), 2) << factor << " " << detail;
    }
}

TEST(ConsistentStage, ARampGivesTheRampForAnyDetail) {
  for (const int factor : {2, 3, 4, 5})
    for (const double detail : {0.0, 0.5, 1.0}) {
      const Plane plane{7.3, -4.1};
      Raster<float> coarse = plane.sample(44, 36, 1), expected = plane.sample(44 * factor, 36 * factor, factor);
      make_void(coarse, {15, 12, 8, 7});
      make_void(coarse, {0, 30, 2, 2});
      for (std::int64_t y = 0; y < expected.height(); ++y)
        for (std::int64_t x = 0; x < expected.width(); ++x)
          if (is_void(coarse(x / factor, y / factor))) expected(x, y) = void_value;
      EXPECT_LT(largest_difference(amplify_whole(coarse, factor, detail).view(), expected.view()), 1e-3) << factor << " " << detail;
    }
}

TEST(ConsistentStage, AConstantStaysToTheLastBit) {
  for (const double detail : {0.0, 1.0}) {
    const Raster<float> fine = amplify_whole(Raster<float>(30, 25, 2222.2222f), 4, detail);
    for (std::int64_t i = 0; i < fine.size().cells(); ++i) ASSERT_EQ(fine.data()[i], 2222.2222f);
  }
}

TEST(ConsistentStage, WithoutDetailItIsTheUpsampler) {
  const Raster<float> coarse = fractal_terrain(50, 40, 10);
  const Raster<float> whole = upsample_whole(*dictionary_for(4).upsampler, coarse.view()), fine = amplify_whole(coarse, 4, 0);
  // Beyond the border the stage continues the terrain farther, by planes of wider support: compare inside.
  const Window inner{5 * 4, 5 * 4, 40 * 4, 30 * 4};
  EXPECT_TRUE(same_bits(fine.view().sub(inner), whole.view().sub(inner)));
}

TEST(ConsistentStage, VoidsStayVoidAndTheirNeighboursAreSound) {
  const Raster<float> coarse = coast();
  for (const double detail : {0.0, 1.0}) {
    const Raster<float> fine = amplify_whole(coarse, 4, detail);
    for (std::int64_t y = 0; y < fine.height(); ++y)
      for (std::int64_t x = 0; x < fine.width(); ++x) {
        ASSERT_EQ(is_void(fine(x, y)), is_void(coarse(x / 4, y / 4))) << x << ", " << y;
        if (!is_void(fine(x, y))) {
          ASSERT_GT(fine(x, y), -60) << x << ", " << y;  // relief of 350 m; no ringing at voids
          ASSERT_LT(fine(x, y), 420) << x << ", " << y;
        }
      }
  }
}

TEST(ConsistentStage, AnAllVoidTerrainStaysVoid) {
  const Bands bands = amplify_bands(Raster<float>(20, 20, void_value), 4, {});
  for (std::int64_t i = 0; i < 6400; ++i) {
    ASSERT_TRUE(is_void(bands.elevation.data()[i]));
    ASSERT_TRUE(is_void(bands.uncertainty.data()[i]));
    ASSERT_TRUE(is_void(bands.atom.data()[i]));
  }
}

TEST(ConsistentStage, CellsBeyondTheMarginChangeNothing) {
  const auto stage = make_consistent_stage(dictionary_for(4), {});
  const std::int64_t margin = stage->margin();
  const Window window{41, 30, 9, 11};
  Raster<float> one = fractal_terrain(90, 70, 11), other(90, 70);
  make_void(one, {45, 26, 3, 3});
  for (std::int64_t y = 0; y < 70; ++y)
    for (std::int64_t x = 0; x < 90; ++x) {
      const bool near = x >= window.x - margin && x < window.x + window.width + margin && y >= window.y - margin && y < window.y + window.height + margin;
      other(x, y) = near ? one(x, y) : (x % 3 == 0 ? void_value : -1e6f);
    }
  const ViewSource first(one.view()), second(other.view());
  Raster<float> a(36, 44), b(36, 44);
  AmplifiedTerrain(first, *stage, 1).read({4 * window.x, 4 * window.y, 36, 44}, a.view());
  AmplifiedTerrain(second, *stage, 1).read({4 * window.x, 4 * window.y, 36, 44}, b.view());
  EXPECT_TRUE(same_bits(a.view(), b.view()));
}

TEST(ConsistentStage, WaterStaysLevelAndItsShoreAbove) {
  const Raster<float> coarse = coast();
  const Raster<std::uint8_t> water = find_flat_water(coarse.view());
  const Raster<float> fine = amplify_whole(coarse, 4, 1);
  std::int64_t level_cells = 0, shore_cells = 0;
  for (std::int64_t y = 1; y < 47; ++y)
    for (std::int64_t x = 1; x < 59; ++x) {
      float beside = -1e9f;
      for (std::int64_t j = y - 1; j <= y + 1; ++j)
        for (std::int64_t i = x - 1; i <= x + 1; ++i)
          if (water(i, j) && coarse(i, j) <= coarse(x, y)) beside = std::max(beside, coarse(i, j));
      for (std::int64_t k = 0; k < 16; ++k) {
        const float z = fine(4 * x + k % 4, 4 * y + k / 4);
        if (water(x, y)) {
          ASSERT_EQ(z, coarse(x, y));
          ++level_cells;
        } else if (beside > -1e9f) {
          ASSERT_GE(z, beside) << x << ", " << y;
          ++shore_cells;
        }
      }
    }
  EXPECT_GT(level_cells, 1000);
  EXPECT_GT(shore_cells, 300);
}

TEST(ConsistentStage, TheUncertaintyIsTheErrorThatIsFound) {
  for (const int factor : {2, 4})
    for (const double detail : {0.0, 1.0})
      for (const std::uint64_t seed : {21u, 22u}) {
        const Raster<float> truth = fractal_terrain(64 * factor, 56 * factor, seed);
        const Bands bands = amplify_bands(area_average(truth.view(), factor), factor, {detail, 1, 0, 2});
        double sum = 0;
        std::int64_t cells = 0;
        for (std::int64_t y = 6 * factor; y < 50 * factor; ++y)
          for (std::int64_t x = 6 * factor; x < 58 * factor; ++x, ++cells) {
            ASSERT_GT(bands.uncertainty(x, y), 0);
            sum += std::pow(static_cast<double>(bands.elevation(x, y) - truth(x, y)) / static_cast<double>(bands.uncertainty(x, y)), 2);
          }
        EXPECT_GT(sum / static_cast<double>(cells), 0.5) << factor << " " << detail;
        EXPECT_LT(sum / static_cast<double>(cells), 2) << factor << " " << detail;
      }
}

TEST(ConsistentStage, SourcesAreAtomsOfTheDictionaryAndWaterHasNoUncertainty) {
  const Raster<float> coarse = coast();
  const Raster<std::uint8_t> water = find_flat_water(coarse.view());
  const Bands bands = amplify_bands(coarse, 4, {});
  const std::int64_t atoms = dictionary_for(4).atoms();
  for (std::int64_t y = 0; y < bands.atom.height(); ++y)
    for (std::int64_t x = 0; x < bands.atom.width(); ++x) {
      if (is_void(coarse(x / 4, y / 4))) {
        ASSERT_TRUE(is_void(bands.atom(x, y)) && is_void(bands.exemplar(x, y)) && is_void(bands.uncertainty(x, y)));
        continue;
      }
      const float atom = bands.atom(x, y);
      ASSERT_TRUE(atom >= -1 && atom < static_cast<float>(atoms) && atom == std::floor(atom)) << atom;
      ASSERT_EQ(bands.exemplar(x, y), atom < 0 ? 0 : 1);
      ASSERT_GE(bands.uncertainty(x, y), 0);
      ASSERT_EQ(water(x / 4, y / 4) != 0, bands.uncertainty(x, y) == 0) << x << ", " << y;
    }
}

TEST(ConsistentStage, BandsDoNotChangeTheElevation) {
  const Raster<float> coarse = coast();
  for (const double detail : {0.0, 1.0})
    EXPECT_TRUE(same_bits(amplify_bands(coarse, 4, {detail, 1, 0, 2}).elevation.view(), amplify_whole(coarse, 4, detail).view()));
}

void expect_input_error(Dictionary dictionary, double detail) {
  try {
    make_consistent_stage(std::move(dictionary), {detail, 1, 0, 1});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    EXPECT_NE(std::string(e.what()).find("--factor"), std::string::npos) << e.what();
  }
}

TEST(ConsistentStage, NeedsAnUpsamplerAndForDetailTheAtoms) {
  Dictionary no_upsampler = dictionary_for(2), no_detail = dictionary_for(2);
  no_upsampler.upsampler.reset();
  no_detail.detail.resize(0, 0);
  expect_input_error(no_upsampler, 0);
  expect_input_error(no_detail, 1);
  EXPECT_NO_THROW(make_consistent_stage(no_detail, {0, 1, 0, 1}));
}

}  // namespace
}  // namespace arete
