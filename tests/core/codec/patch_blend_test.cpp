#include "core/codec/patch_blend.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/sparse/falloff.h"
#include "core/support/random.h"

namespace arete {
namespace {

PatchParameters parameters() {
  PatchParameters p;
  p.grid = NodeGrid({60, 45}, 32);
  p.radius = 5;
  p.sparsity = 2;
  p.base = 1000;
  p.mean_quantum = 0.5F;
  p.coefficient_quantum = 3;
  p.atoms = {10, 4, std::vector<std::int16_t>(400)};
  for (std::size_t i = 0; i < 400; ++i)
    if (inside_disc(10, static_cast<int>(i % 10), static_cast<int>(i / 10 % 10)))
      p.atoms.samples[i] = static_cast<std::int16_t>(static_cast<int>(hash_position(1, i) % 8000) - 4000);
  return p;
}

// Discs that are functions of their place.
struct Discs {
  std::vector<DiscTerm> terms;
  explicit Discs(int count) {
    for (int i = 0; i < count; ++i)
      terms.push_back({static_cast<std::int32_t>(hash_position(2, static_cast<std::uint64_t>(i)) % 4),
                       static_cast<std::int32_t>(hash_position(3, static_cast<std::uint64_t>(i)) % 200) - 100});
  }
  DiscView operator()(std::int64_t column, std::int64_t row) const {
    const auto i = static_cast<std::size_t>((row * 31 + column * 2) % static_cast<std::int64_t>(terms.size() - 1));
    return {static_cast<std::int32_t>(hash_position(4, static_cast<std::uint64_t>(column), static_cast<std::uint64_t>(row)) % 1000),
            std::span(terms).subspan(i, 2)};
  }
};

Raster<float> evaluate(const PatchParameters& p, const Discs& discs, int level, const Window& window, int threads = 1) {
  Raster<float> out(window.width, window.height, -1);
  DiscBlend(p).evaluate(level, window, discs, out.view(), threads);
  return out;
}

// f = sum (a z + x d) / sum a at one cell, by definition and in double.
double by_definition(const PatchParameters& p, const Discs& discs, std::int64_t x, std::int64_t y) {
  double sum = 0, cover = 0;
  const int m = 2 * p.radius;
  for (std::int64_t row = 0; row < 20; ++row)
    for (std::int64_t column = 0; column < 20; ++column) {
      const std::int64_t i = x - (column - 1) * p.radius, j = y - (row - 1) * p.radius;
      if (i < 0 || j < 0 || i >= m || j >= m) continue;
      const double a = falloff(std::hypot(static_cast<double>(i) + 0.5 - p.radius, static_cast<double>(j) + 0.5 - p.radius) / p.radius);
      const DiscView disc = discs(column, row);
      cover += a;
      sum += a * disc.mean * static_cast<double>(p.mean_quantum);
      for (const DiscTerm& term : disc.terms)
        sum += term.coefficient * static_cast<double>(p.coefficient_quantum) * p.atoms.atom(term.atom)[j * m + i] / 32768.0;
    }
  return static_cast<double>(p.base) + sum / cover;
}

TEST(PatchBlend, IsTheWeightedMeanOfTheDiscs) {
  const PatchParameters p = parameters();
  const Discs discs(50);
  const Raster<float> f = evaluate(p, discs, 0, {0, 0, 60, 45});
  for (std::int64_t y = 0; y < 45; ++y)
    for (std::int64_t x = 0; x < 60; ++x) EXPECT_NEAR(static_cast<double>(f(x, y)), by_definition(p, discs, x, y), 0.02);  // 16 bits of weights
}

TEST(PatchBlend, LevelsAndWindowsAreSamplesOfTheWhole) {
  const PatchParameters p = parameters();
  const Discs discs(50);
  const Raster<float> whole = evaluate(p, discs, 0, {0, 0, 60, 45});
  for (int level = 0; level <= p.grid.levels(); ++level) {
    const Size size = p.grid.level_size(level);
    for (std::uint64_t i = 0; i < 10; ++i) {
      const auto x = static_cast<std::int64_t>(hash_position(5, i) % static_cast<std::uint64_t>(size.width));
      const auto y = static_cast<std::int64_t>(hash_position(6, i) % static_cast<std::uint64_t>(size.height));
      const Window window{x, y, size.width - x, size.height - y};
      const Raster<float> part = evaluate(p, discs, level, window, 3);
      for (std::int64_t row = 0; row < window.height; ++row)
        for (std::int64_t column = 0; column < window.width; ++column)
          ASSERT_EQ(part(column, row), whole((x + column) << level, (y + row) << level)) << level;
    }
  }
}

TEST(PatchBlend, EqualMeansGiveALevelSurface) {
  PatchParameters p = parameters();
  Raster<float> out(60, 45);
  DiscBlend(p).evaluate(0, {0, 0, 60, 45}, [](std::int64_t, std::int64_t) { return DiscView{-37, {}}; }, out.view(), 1);
  for (std::int64_t i = 0; i < out.size().cells(); ++i) EXPECT_EQ(out.data()[i], 981.5F);
}

TEST(PatchBlend, ValuesStayFinite) {
  PatchParameters p = parameters();
  p.mean_quantum = 1e30F;
  p.coefficient_quantum = 1e30F;
  Raster<float> out(60, 45);
  DiscBlend(p).evaluate(0, {0, 0, 60, 45}, [](std::int64_t, std::int64_t) { return DiscView{patch_value_limit, {}}; }, out.view(), 1);
  for (std::int64_t i = 0; i < out.size().cells(); ++i) EXPECT_TRUE(std::isfinite(out.data()[i]));
}

}  // namespace
}  // namespace arete
