#include "gis/tin/constraint_lines.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

using Place = std::array<std::int64_t, 2>;
using Segment = LineArrangement::Segment;

const std::vector<std::int64_t> columns{0, 20, 40}, rows{0, 15, 30};
constexpr std::int64_t half = line_units / 2;

LineArrangement arrange(const TinLines& lines, double tolerance = 0) { return LineArrangement(lines, columns, rows, tolerance); }

/// Distance of a place from a segment, in units; -1 where the foot of the perpendicular is not inside the segment.
double distance_inside(const Segment& s, const Place& p) {
  const double dx = static_cast<double>(s.to[0] - s.from[0]), dy = static_cast<double>(s.to[1] - s.from[1]);
  const double px = static_cast<double>(p[0] - s.from[0]), py = static_cast<double>(p[1] - s.from[1]);
  const double along = (dx * px + dy * py) / (dx * dx + dy * dy);
  return along <= 0 || along >= 1 ? -1 : std::abs(dx * py - dy * px) / std::hypot(dx, dy);
}

int side(const Segment& s, const Place& p) {
  const auto across = (s.to[0] - s.from[0]) * (p[1] - s.from[1]) - (s.to[1] - s.from[1]) * (p[0] - s.from[0]);
  return across > 0 ? 1 : across < 0 ? -1 : 0;
}

bool cross(const Segment& s, const Segment& t) { return side(s, t.from) * side(s, t.to) < 0 && side(t, s.from) * side(t, s.to) < 0; }

/// Lines over and beyond the raster, many of them on half cells, some twice.
TinLines soup(std::uint64_t seed, int count) {
  TinLines lines;
  std::uint64_t next = 0;
  const auto draw = [&] { return uniform_at(seed, next++, 0); };
  for (int i = 0; i < count; ++i) {
    RasterLine line;
    const double snap = draw();
    for (int k = 0; k < 2 + static_cast<int>(4 * draw()); ++k) {
      RasterPlace p{-5 + 50 * draw(), -5 + 40 * draw()};
      if (snap < 0.3) p = {std::round(2 * p[0]) / 2, std::round(2 * p[1]) / 2};
      if (snap > 0.9 && !line.empty()) p = {line.back()[0] + 1e-4 * draw(), p[1]};
      line.push_back(p);
    }
    if (draw() < 0.2) lines.breaklines.push_back(line);
    lines.breaklines.push_back(line);
  }
  return lines;
}

void expect_guarantees(const LineArrangement& arrangement, std::int64_t tolerance) {
  const std::vector<Segment>& all = arrangement.segments();
  std::set<Place> ends;
  for (const Segment& s : all) {
    ASSERT_LT(s.from, s.to);
    ends.insert(s.from), ends.insert(s.to);
    ASSERT_GE(std::min(s.from[0], s.to[0]), 0);
    ASSERT_LE(std::max(s.from[0], s.to[0]), 40 * line_units);
    ASSERT_GE(std::min(s.from[1], s.to[1]), 0);
    ASSERT_LE(std::max(s.from[1], s.to[1]), 30 * line_units);
    for (const auto& [k, edge] : {std::pair{0, 20}, {1, 15}}) {
      const std::int64_t at = std::int64_t{edge} * line_units, a = s.from[static_cast<std::size_t>(k)], b = s.to[static_cast<std::size_t>(k)];
      ASSERT_FALSE(std::min(a, b) < at && std::max(a, b) > at) << "a piece crosses a border of tiles";
    }
    for (const Place& p : {s.from, s.to})
      for (const std::int64_t v : p) {
        const std::int64_t off = (v + half / 2) % half - half / 2;
        ASSERT_TRUE(off == 0 || std::abs(off) > tolerance) << v;
      }
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const Place& p : ends) {
      const double distance = distance_inside(all[i], p);
      ASSERT_TRUE(distance < 0 || distance > static_cast<double>(tolerance)) << distance;
    }
    for (std::int64_t x = 0; x <= 80; ++x)
      for (std::int64_t y = 0; y <= 60; ++y) {
        const double distance = distance_inside(all[i], {x * half, y * half});
        ASSERT_TRUE(distance < 0 || distance > static_cast<double>(tolerance)) << "beside the half cell " << x << ", " << y;
      }
    for (std::size_t j = i + 1; j < all.size(); ++j) ASSERT_FALSE(cross(all[i], all[j]));
  }
}

TEST(LineArrangement, KeepsItsGuaranteesForSoupsOfLines) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) expect_guarantees(arrange(soup(seed, 25)), 2);
  for (std::uint64_t seed = 21; seed <= 24; ++seed) expect_guarantees(arrange(soup(seed, 25), 1e-3), 128);
}

TEST(LineArrangement, MovesLinesByLittle) {
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const TinLines lines = soup(seed, 20);
    const LineArrangement cut = arrange(lines);
    for (const Segment& s : cut.segments())
      for (const Place& p : {s.from, s.to}) {
        double nearest = 1e9;
        for (const RasterLine& line : lines.breaklines)
          for (std::size_t i = 1; i < line.size(); ++i) {
            const double dx = line[i][0] - line[i - 1][0], dy = line[i][1] - line[i - 1][1];
            const double px = static_cast<double>(p[0]) / line_units - line[i - 1][0], py = static_cast<double>(p[1]) / line_units - line[i - 1][1];
            const double t = std::clamp((dx * px + dy * py) / std::max(1e-30, dx * dx + dy * dy), 0.0, 1.0);
            nearest = std::min(nearest, std::hypot(px - t * dx, py - t * dy));
          }
        worst = std::max(worst, nearest);
      }
  }
  EXPECT_LE(worst, 1e-4);  // a little above the pixels' half diagonal, twice: 2 x 2.83 units of 2^-16 cell
}

TEST(LineArrangement, CutsACrossAtItsMiddle) {
  const LineArrangement cut = arrange({{{{2.25, 3.25}, {6.25, 3.25}}, {{4.25, 1.25}, {4.25, 5.25}}}, {}});
  ASSERT_EQ(cut.segments().size(), 4u);
  int at_middle = 0;
  const Place middle{static_cast<std::int64_t>(4.25 * line_units), static_cast<std::int64_t>(3.25 * line_units)};
  for (const Segment& s : cut.segments()) at_middle += (s.from == middle) + (s.to == middle);
  EXPECT_EQ(at_middle, 4);
}

TEST(LineArrangement, GivesBothTilesOfABorderTheSamePlaces) {
  const LineArrangement cut = arrange({{{{17.3, 3.1}, {23.9, 7.7}}, {{20, 9.25}, {20, 11.75}}}, {}});
  const TileLines left = cut.of_tile(0, 0), right = cut.of_tile(1, 0);
  EXPECT_EQ(left.right, right.left);
  EXPECT_EQ(left.right.size(), 1u + 2u + 5u) << "a crossing, the ends of a line along the border, and the half cells between";
  EXPECT_EQ(left.pieces.size(), 1u) << "no piece lies along the border";
  EXPECT_EQ(right.pieces.size(), 1u);
}

TEST(LineArrangement, PassesThroughCentresThatItNearlyMeets) {
  const LineArrangement cut = arrange({{{{1, 1.00002}, {9, 1.00001}}}, {}});
  for (const Segment& s : cut.segments()) {
    EXPECT_EQ(s.from[1], line_units);
    EXPECT_EQ(s.to[0] - s.from[0], half);
  }
}

TEST(LineArrangement, LeavesNothingOfABoundaryThatIsThereTwice) {
  const RasterLine square{{2.25, 2.25}, {8.25, 2.25}, {8.25, 8.25}, {2.25, 8.25}, {2.25, 2.25}};
  EXPECT_EQ(arrange({{}, {square}}).segments().size(), 4u);
  EXPECT_TRUE(arrange({{}, {square, square}}).segments().empty());
}

TEST(LineArrangement, PassesTheCornerOfFourPixels) {
  // Two diagonals of a pixel (4 units) whose four corners are ends: each would lead through the ends of the other, and back.
  const auto at = [](int x, int y) { return RasterPlace{5 + 1000.0 / line_units + 4.0 * x / line_units, 5 + 1000.0 / line_units + 4.0 * y / line_units}; };
  expect_guarantees(arrange({{{at(0, 0), at(1, 1)}, {at(0, 1), at(1, 0)}}, {{at(0, 0), at(1, 1), at(9, 4), at(0, 0)}, {at(0, 1), at(1, 0), at(3, 9), at(0, 1)}}}), 1);
}

TEST(LineArrangement, LeavesOutWhatLiesOutside) {
  EXPECT_TRUE(arrange({{{{-5, -5}, {-3, 40}}, {{1e12, 1e12}, {2e12, 3e12}}, {{-1, 3}, {-1e15, 5}}}, {}}).segments().empty());
  const LineArrangement cut = arrange({{{{-1e6, 7.25}, {1e6, 7.25}}}, {}});
  std::int64_t length = 0;
  for (const Segment& s : cut.segments()) length += s.to[0] - s.from[0];
  EXPECT_EQ(length, 40 * line_units);
}

TEST(IsInside, CountsRings) {
  const RasterLine outer{{0, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 0}}, hole{{4, 4}, {6, 4}, {6, 6}, {4, 6}, {4, 4}};
  const std::vector<RasterLine> rings{outer, hole};
  EXPECT_TRUE(is_inside(rings, {2, 5}));
  EXPECT_FALSE(is_inside(rings, {5, 5}));
  EXPECT_FALSE(is_inside(rings, {11, 5}));
}

}  // namespace
}  // namespace arete
