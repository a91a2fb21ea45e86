#include "gis/tin/tile_border.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

using testing::ElementsAre;

constexpr float hole = std::numeric_limits<float>::quiet_NaN();

std::vector<float> rough_line(std::size_t cells, std::uint64_t seed) {
  std::vector<float> line;
  for (std::size_t i = 0; i < cells; ++i)
    line.push_back(static_cast<float>(std::round(100 + 30 * std::sin(static_cast<double>(i) / 9) + 10 * uniform_at(seed, i))));
  return line;
}

TEST(SimplifyLine, AStraightLineHasTwoVertices) {
  const std::vector<float> cells{3, 5, 7, 9, 11};
  EXPECT_THAT(simplify_line(cells, {0.5, 0.25}), ElementsAre(ElementsAre(LineVertex{0, 3}, LineVertex{8, 11})));
}

TEST(SimplifyLine, KeepsTheBoundAtEveryCell) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const std::vector<float> cells = rough_line(200, seed);
    for (const double bound : {0.25, 1.0, 5.0, 40.0}) {
      const std::vector<Polyline> lines = simplify_line(cells, {bound, 1.0 / 1024});
      ASSERT_EQ(lines.size(), 1u);
      for (std::size_t i = 0; i < cells.size(); ++i)
        EXPECT_LE(std::abs(height_at(lines[0], static_cast<std::int32_t>(2 * i)) - cells[i]), bound) << seed << ' ' << i;
    }
  }
}

TEST(SimplifyLine, ALooserBoundHasFewerVertices) {
  const std::vector<float> cells = rough_line(1000, 1);
  std::size_t before = cells.size() + 1;
  for (const double bound : {0.5, 2.0, 8.0, 30.0}) {
    const std::size_t vertices = simplify_line(cells, {bound, 1.0 / 1024})[0].size();
    EXPECT_LT(vertices, before);
    before = vertices;
  }
}

TEST(SimplifyLine, RunsEndAtTheEdgesOfTheirCells) {
  const std::vector<float> cells{hole, 4, 4, hole, 9, hole, 1};
  EXPECT_THAT(simplify_line(cells, {1, 0.25}), ElementsAre(ElementsAre(LineVertex{1, 4}, LineVertex{5, 4}), ElementsAre(LineVertex{7, 9}, LineVertex{9, 9}),
                                                           ElementsAre(LineVertex{11, 1}, LineVertex{12, 1})));
  EXPECT_THAT(simplify_line(std::vector<float>{hole, hole}, {1, 0.25}), ElementsAre());
}

TEST(SimplifyLine, ForcedPlacesAreVertices) {
  const std::vector<float> cells{0, 0, 10, 0, 0};
  const std::int32_t forced[] = {3, 4};
  const std::vector<Polyline> lines = simplify_line(cells, {20, 0.25}, forced);
  EXPECT_THAT(lines, ElementsAre(ElementsAre(LineVertex{0, 0}, LineVertex{3, 5}, LineVertex{4, 10}, LineVertex{8, 0})));
}

TEST(SimplifyLine, SidesAreNoLongerThanAllowed) {
  const std::vector<float> cells(100, 5.0f);
  const std::vector<Polyline> lines = simplify_line(cells, {1, 0.25, 2, 10});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].back().at, 198);
  for (std::size_t i = 1; i < lines[0].size(); ++i) EXPECT_LE(lines[0][i].at - lines[0][i - 1].at, 20);
}

}  // namespace
}  // namespace arete
