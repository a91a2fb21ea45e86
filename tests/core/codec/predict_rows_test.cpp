#include "core/codec/predict_rows.h"

#include <gtest/gtest.h>

#include <set>

#include "core/codec/predict_pass.h"
#include "tests/core/codec/predict_fixture.h"

namespace arete {
namespace {

NodePlanes random_planes(const PredictParameters& file, std::uint64_t seed) {
  Raster<std::int32_t> level(40, 36);
  const auto range = static_cast<std::uint64_t>(std::int64_t{file.highest} - file.lowest + 1);
  for (std::int64_t i = 0; i < level.size().cells(); ++i)
    level.data()[i] = static_cast<std::int32_t>(file.lowest + static_cast<std::int64_t>(hash_position(seed, static_cast<std::uint64_t>(i)) % range));
  NodePlanes planes = make_planes({level.view(), {}, 0, 0, level.size()}, {16, 16, 33, 32}, {}, file);
  for (int phase = 1; phase < 4; ++phase)
    for (int y = 0; y < coded_height(planes, phase); ++y)
      for (int x = 0; x < coded_width(planes, phase); ++x)
        planes.magnitudes[static_cast<std::size_t>(phase)].row(y)[x] =
            static_cast<std::int32_t>(hash_position(seed + 100, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)) % magnitude_limit);
  return planes;
}

PredictParameters range(std::int32_t lowest, std::int32_t highest) {
  PredictParameters file;
  file.lowest = lowest;
  file.highest = highest;
  return file;
}

// Each tap must be a cell that is decoded before, each pair used once.
TEST(PredictRows, TapsAreKnownBeforeThePhase) {
  for (int phase = 1; phase < 4; ++phase) {
    std::set<std::pair<int, int>> seen;
    for (int i = 0; i < pair_count[static_cast<std::size_t>(phase - 1)]; ++i) {
      const TapPair pair = tap_pairs[static_cast<std::size_t>(phase - 1)][static_cast<std::size_t>(i)];
      for (int sign : {1, -1}) {
        EXPECT_LT(locate(phase, sign * pair.dx, sign * pair.dy).phase, phase);
        EXPECT_TRUE(seen.insert({sign * pair.dx, sign * pair.dy}).second);
      }
    }
  }
}

TEST(PredictRows, LocateFindsTheCell) {
  for (int phase = 0; phase < 4; ++phase)
    for (int dy = -5; dy <= 5; ++dy)
      for (int dx = -5; dx <= 5; ++dx) {
        const PlaneOffset at = locate(phase, dx, dy);
        EXPECT_EQ(2 * at.dx + odd_x(at.phase), odd_x(phase) + dx);
        EXPECT_EQ(2 * at.dy + odd_y(at.phase), odd_y(phase) + dy);
      }
}

// The definition of the format, cell by cell in 64 bits, against the vectorised rows of both kinds.
TEST(PredictRows, NarrowAndWideGiveTheDefinition) {
  const PredictParameters file = range(-65536, 65536);
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    NodePlanes narrow = random_planes(file, seed), wide = random_planes(file, seed);
    for (int phase = 1; phase < 4; ++phase) {
      const auto p = static_cast<std::size_t>(phase);
      PhaseParameters parameters = default_level_parameters().phases[p - 1];
      if (seed > 1) parameters.taps = {5119, -3071};  // the largest that may be
      PhaseRows<std::int32_t> rows(narrow.width);
      PhaseRows<std::int64_t> wide_rows(wide.width);
      for (int y = -phase_margin[p]; y < narrow.height + phase_margin[p]; ++y) {
        filter_row(narrow, phase, y, file, parameters, rows.filtered_row());
        filter_row(wide, phase, y, file, parameters, wide_rows.filtered_row());
        for (int x = -phase_margin[p]; x < narrow.width + phase_margin[p]; ++x) {
          std::int64_t sum = 0;
          for (int i = 0; i < pair_count[p - 1]; ++i) {
            const TapPair pair = tap_pairs[p - 1][static_cast<std::size_t>(i)];
            for (int sign : {1, -1}) {
              const PlaneOffset at = locate(phase, sign * pair.dx, sign * pair.dy);
              sum += std::int64_t{parameters.taps[static_cast<std::size_t>(i)]} *
                     wide.values[static_cast<std::size_t>(at.phase)].row(y + at.dy)[x + at.dx];
            }
          }
          const std::int64_t expected = std::clamp<std::int64_t>((sum + 128) >> 8, std::int64_t{16} * file.lowest, std::int64_t{16} * file.highest);
          ASSERT_EQ(rows.filtered_row()[x], expected);
          ASSERT_EQ(wide_rows.filtered_row()[x], expected);
          ASSERT_EQ(narrow.values[p].row(y)[x], (expected + 8) >> 4);
          ASSERT_EQ(wide.values[p].row(y)[x], (expected + 8) >> 4);
        }
        if (y < 0 || y >= narrow.height) continue;
        measure_activity(narrow, phase, y, narrow.width, parameters, rows.filtered_row(), rows.activity());
        measure_activity(wide, phase, y, wide.width, parameters, wide_rows.filtered_row(), wide_rows.activity());
        for (int x = 0; x < narrow.width; ++x) {
          const auto features = activity_features(narrow, phase, x, y, rows.filtered_row()[x]);
          std::uint32_t expected = noise_floor(parameters.noise);
          for (std::size_t i = 1; i < features.size(); ++i) expected += parameters.activity[i] * static_cast<std::uint32_t>(features[i]);
          const auto k = static_cast<std::size_t>(x);
          ASSERT_EQ(rows.expected[k], expected);
          ASSERT_EQ(wide_rows.expected[k], expected);
          ASSERT_EQ(rows.spread[k], features[3]);
          ASSERT_EQ(rows.curvature[k], features[4]);
          std::int32_t around = 0;
          for (int v = -2; v <= (phase == 1 ? -1 : phase == 2 ? 1 : 2); ++v)
            for (int u = -2; u <= (phase == 3 ? 1 : 2); ++u) around += narrow.magnitudes[1].row(y + v)[x + u] * (phase == 1 ? 2 : 1);
          ASSERT_EQ(rows.around[k], around);
          ASSERT_EQ(wide_rows.around[k], around);
        }
      }
    }
  }
}

TEST(PredictRows, APlaneIsPredictedExactly) {
  Raster<std::int32_t> level(40, 36);
  for (std::int64_t y = 0; y < 36; ++y)
    for (std::int64_t x = 0; x < 40; ++x) level(x, y) = static_cast<std::int32_t>(10 * x + 6 * y);
  NodePlanes planes = make_planes({level.view(), {}, 0, 0, level.size()}, {16, 16, 32, 32}, {}, range(-10000, 10000));
  for (int phase = 1; phase < 4; ++phase) {
    PhaseRows<std::int32_t> rows(planes.width);
    const auto p = static_cast<std::size_t>(phase);
    for (int y = -phase_margin[p]; y < planes.height + phase_margin[p]; ++y) {
      filter_row(planes, phase, y, range(-10000, 10000), default_level_parameters().phases[p - 1], rows.filtered_row());
      for (int x = 0; x < planes.width; ++x)
        ASSERT_EQ(planes.values[p].row(y)[x], 5 * (2 * (x + 8) + odd_x(phase)) + 3 * (2 * (y + 8) + odd_y(phase)));
    }
  }
}

}  // namespace
}  // namespace arete
