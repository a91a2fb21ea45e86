#include "gis/tested_terrain.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/synthesis/mountains.h"

namespace arete {
namespace {

/// Mountains rounded to whole multiples of a quantum; 0: as they are.
Raster<float> mountains(double quantum) {
  Raster<float> cells = synthesize_mountains({70, 50}, {.relief_m = 400});
  if (quantum > 0)
    for (std::int64_t i = 0; i < cells.size().cells(); ++i)
      cells.data()[i] = static_cast<float>(std::round(static_cast<double>(cells.data()[i]) / quantum) * quantum);
  return cells;
}

double worst_error(const TestedTerrain& terrain, const CodedTerrain& coded) {
  double worst = 0;
  for (std::int64_t i = 0; i < terrain.cells.size().cells(); ++i) {
    const float z = terrain.cells.data()[i];
    EXPECT_GE(coded.codes.data()[i], 0);
    EXPECT_LE(coded.codes.data()[i], coded.highest);
    if (!is_void(z)) worst = std::max(worst, std::abs(static_cast<double>(coded.map.elevation(coded.codes.data()[i])) - static_cast<double>(z)));
  }
  return worst;
}

TEST(ExamineTerrain, FindsTheQuantumAndTheRange) {
  EXPECT_EQ(examine_terrain("metres", mountains(1)).quantum, 1);
  EXPECT_EQ(examine_terrain("centimetres", mountains(0.01)).quantum, 0.01);
  EXPECT_EQ(examine_terrain("feet", mountains(0.3048), 0.3048).quantum, 0.3048);
  EXPECT_EQ(examine_terrain("floats", mountains(0)).quantum, 0);
}

TEST(ExamineTerrain, FillsVoidsBesideTheOriginal) {
  Raster<float> cells = mountains(1);
  const float highest = 9000;
  cells(3, 3) = highest;
  cells(10, 10) = void_value;
  const TestedTerrain terrain = examine_terrain("hole", std::move(cells));
  EXPECT_EQ(terrain.valid, 70 * 50 - 1);
  EXPECT_EQ(terrain.high, highest);
  EXPECT_EQ(terrain.quantum, 1);
  EXPECT_TRUE(is_void(terrain.cells(10, 10)));
  EXPECT_FALSE(is_void(terrain.filled(10, 10)));
}

TEST(ExamineTerrain, RefusesWhatHasNoRelief) {
  EXPECT_THROW(examine_terrain("flat", Raster<float>(4, 4, 7.0f)), Error);
  EXPECT_THROW(examine_terrain("void", Raster<float>(4, 4, void_value)), Error);
}

// Half of a step of relief / 65535, and the rounding of floats below 512 m (3e-5).
TEST(ScaleTo16Bits, IsHalfAStepOffAtMost) {
  const TestedTerrain terrain = examine_terrain("floats", mountains(0));
  const double step = (static_cast<double>(terrain.high) - static_cast<double>(terrain.low)) / 65535;
  EXPECT_LE(worst_error(terrain, scale_to_16_bits(terrain)), step / 2 + 1e-4);
}

TEST(StepsWithin, KeepEveryCellWithinTheBound) {
  for (const double quantum : {0.0, 1.0, 0.01, 0.3048}) {
    const TestedTerrain terrain = examine_terrain("t", mountains(quantum), quantum == 0.3048 ? quantum : 1);
    for (const double bound : {0.02, 0.05, 0.5, 1.0, 2.5, 100.0, 1e4}) {
      const auto steps = steps_within(terrain, bound);
      ASSERT_TRUE(steps) << quantum << " " << bound;
      EXPECT_LE(worst_error(terrain, quantise(terrain, *steps)), bound) << quantum;
    }
  }
}

TEST(StepsWithin, AreWholeQuantaWherePossible) {
  const TestedTerrain metres = examine_terrain("metres", mountains(1));
  EXPECT_EQ(steps_within(metres, 0)->map.stride, 1);
  EXPECT_EQ(steps_within(metres, 0.5)->map.stride, 1);
  EXPECT_EQ(steps_within(metres, 2)->map.stride, 5);
  EXPECT_EQ(steps_within(metres, 2.9)->map.stride, 5);
  EXPECT_EQ(worst_error(metres, quantise(metres, *steps_within(metres, 0))), 0);
  const TestedTerrain floats = examine_terrain("floats", mountains(0));
  EXPECT_FALSE(steps_within(floats, 0));
  EXPECT_FALSE(steps_within(floats, 1e-9));
}

TEST(WithMap, ComesBackAndCountsItsBytes) {
  const std::vector<std::byte> file = {std::byte{7}, std::byte{9}};
  const auto same = [&](const std::optional<LinearMap>& map, std::size_t bytes) {
    const std::vector<std::byte> mapped = with_map(map, file);
    EXPECT_EQ(mapped.size(), bytes);
    const MappedFile back = read_map(mapped);
    EXPECT_EQ(back.map.has_value(), map.has_value());
    if (map) {
      EXPECT_EQ(back.map->base, map->base);
      EXPECT_EQ(back.map->stride, map->stride);
      EXPECT_EQ(back.map->unit, map->unit);
    }
    EXPECT_EQ(std::vector<std::byte>(back.file.begin(), back.file.end()), file);
    for (std::size_t length = 0; length < bytes - file.size(); ++length)
      EXPECT_THROW(read_map(std::span(mapped).first(length)), Error) << length;
  };
  same(std::nullopt, 3);
  same(LinearMap{556, 0.5, 1}, 11);
  same(LinearMap{556, 0.1, 1}, 27);
  same(LinearMap{18790, 5, 0.01}, 27);
  EXPECT_THROW(read_map(std::vector{std::byte{3}, std::byte{0}}), Error);
}

}  // namespace
}  // namespace arete
