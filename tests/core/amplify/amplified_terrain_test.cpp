#include "core/amplify/amplified_terrain.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/core/amplify/sample_terrain.h"

namespace arete {
namespace {

/// Repeats each cell; uncertain by 3 m; adds up its neighbourhood as the atom, to see what lies in the margin.
class Blocks final : public Stage {
 public:
  Blocks(int factor, bool repeats_edge) : factor_(factor), repeats_edge_(repeats_edge) {}
  int factor() const override { return factor_; }
  int margin() const override { return 2; }
  bool repeats_edge() const override { return repeats_edge_; }
  void evaluate(const Window& window, RasterView<const float> coarse, const AmplifiedBands& out, int) const override {
    for (std::int64_t y = 0; y < window.height * factor_; ++y)
      for (std::int64_t x = 0; x < window.width * factor_; ++x) {
        const std::int64_t i = x / factor_ + 2, j = y / factor_ + 2;
        if (out.elevation.data) out.elevation(x, y) = coarse(i, j);
        if (out.uncertainty.data) out.uncertainty(x, y) = 3;
        if (out.exemplar.data) out.exemplar(x, y) = static_cast<float>((window.x + x / factor_) * 1000 + window.y + y / factor_);
        if (out.atom.data) out.atom(x, y) = coarse(i - 2, j - 2) + 10 * coarse(i + 2, j + 2);
      }
  }

 private:
  int factor_;
  bool repeats_edge_;
};

Raster<float> numbered(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t i = 0; i < width * height; ++i) cells.data()[i] = static_cast<float>(i);
  return cells;
}

TEST(AmplifiedTerrain, IsTheStageCutToAnyWindow) {
  const Raster<float> cells = numbered(9, 7);
  const ViewSource source(cells.view());
  const Blocks stage(3, false);
  const AmplifiedTerrain terrain(source, stage, 1);
  ASSERT_EQ(terrain.size(), (Size{27, 21}));
  for (const Window& w : {Window{0, 0, 27, 21}, Window{1, 2, 3, 4}, Window{26, 20, 1, 1}, Window{4, 0, 9, 21}, Window{3, 3, 6, 6}}) {
    Raster<float> out(w.width, w.height), cell(w.width, w.height);
    AmplifiedBands bands;
    bands.elevation = out.view();
    bands.exemplar = cell.view();
    terrain.read_bands(w, bands);
    for (std::int64_t y = 0; y < w.height; ++y)
      for (std::int64_t x = 0; x < w.width; ++x) {
        EXPECT_EQ(out(x, y), cells((w.x + x) / 3, (w.y + y) / 3));
        EXPECT_EQ(cell(x, y), static_cast<float>((w.x + x) / 3 * 1000 + (w.y + y) / 3));
      }
  }
}

TEST(AmplifiedTerrain, BeyondTheBorderTheEdgeRepeatsOrIsVoidAsTheStageAsks) {
  const Raster<float> cells = numbered(9, 7);
  const ViewSource source(cells.view());
  for (const bool repeats : {false, true}) {
    const Blocks stage(2, repeats);
    Raster<float> sum(18, 14);
    AmplifiedBands bands;
    bands.atom = sum.view();
    AmplifiedTerrain(source, stage, 1).read_bands({0, 0, 18, 14}, bands);
    const auto at = [&](std::int64_t x, std::int64_t y) {
      if (!repeats && (x < 0 || y < 0 || x > 8 || y > 6)) return void_value;
      return cells(std::clamp<std::int64_t>(x, 0, 8), std::clamp<std::int64_t>(y, 0, 6));
    };
    for (std::int64_t y = 0; y < 14; ++y)
      for (std::int64_t x = 0; x < 18; ++x) {
        const float expected = at(x / 2 - 2, y / 2 - 2) + 10 * at(x / 2 + 2, y / 2 + 2);
        EXPECT_TRUE(sum(x, y) == expected || (is_void(sum(x, y)) && is_void(expected))) << x << ", " << y;
      }
  }
}

TEST(AmplifiedTerrain, StagesChainAndTheirUncertaintiesAddInQuadrature) {
  const Raster<float> cells = numbered(5, 4);
  const ViewSource source(cells.view());
  const Blocks stage(2, false);
  const AmplifiedTerrain once(source, stage, 1), twice(once, stage, 1), thrice(twice, stage, 1);
  ASSERT_EQ(thrice.size(), (Size{40, 32}));
  const Window w{5, 3, 21, 17};
  Raster<float> out(w.width, w.height), error(w.width, w.height);
  AmplifiedBands bands;
  bands.elevation = out.view();
  bands.uncertainty = error.view();
  thrice.read_bands(w, bands);
  for (std::int64_t y = 0; y < w.height; ++y)
    for (std::int64_t x = 0; x < w.width; ++x) {
      EXPECT_EQ(out(x, y), cells((w.x + x) / 8, (w.y + y) / 8));
      EXPECT_FLOAT_EQ(error(x, y), std::sqrt(27.0f));
    }
}

TEST(AmplifiedTerrain, ARasterOfOneCellWorks) {
  const Raster<float> cells = numbered(1, 1);
  const ViewSource source(cells.view());
  const Blocks stage(4, true);
  const Raster<float> fine = read_all(AmplifiedTerrain(source, stage, 1));
  for (std::int64_t i = 0; i < 16; ++i) EXPECT_EQ(fine.data()[i], 0);
}

}  // namespace
}  // namespace arete
