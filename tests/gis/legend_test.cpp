#include "gis/legend.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace arete {
namespace {

TEST(RoundTicks, AreRoundAndInside) {
  EXPECT_EQ(round_ticks(556, 3373, 5), (std::vector<double>{1000, 1500, 2000, 2500, 3000}));
  EXPECT_EQ(round_ticks(-1, 1, 4), (std::vector<double>{-1, -0.5, 0, 0.5, 1}));
  for (const double high : {0.013, 7.0, 88.0, 1211.0, 8848.0}) {
    const std::vector<double> ticks = round_ticks(-0.3 * high, high, 5);
    EXPECT_GE(ticks.size(), 3u) << high;
    EXPECT_LE(ticks.size(), 8u) << high;
    for (const double tick : ticks) {
      EXPECT_GE(tick, -0.3 * high * (1 + 1e-9));
      EXPECT_LE(tick, high * (1 + 1e-9));
    }
  }
  EXPECT_EQ(round_ticks(5, 5, 4).size(), 1u);
}

TEST(RoundLength, IsTheLongestRoundOneThatFits) {
  EXPECT_DOUBLE_EQ(round_length(1000), 1000);
  EXPECT_DOUBLE_EQ(round_length(999), 500);
  EXPECT_DOUBLE_EQ(round_length(23456), 20000);
  EXPECT_DOUBLE_EQ(round_length(0.7), 0.5);
}

TEST(FormatTick, HasTheDecimalsOfTheStep) {
  EXPECT_EQ(format_tick(1500, 500), "1500");
  EXPECT_EQ(format_tick(0.5, 0.5), "0.5");
  EXPECT_EQ(format_tick(-0.25, 0.05), "-0.25");
}

TEST(DrawLegend, ShowsTheRampFromLeftToRightAndARoundScaleBar) {
  const ColourRamp ramp = named_ramp("viridis");
  Legend legend;
  legend.low = 0;
  legend.high = 100;
  legend.metres_per_pixel = 10;
  const Picture strip = draw_legend(legend, ramp, 800);
  ASSERT_EQ(strip.width(), 800);
  std::int64_t dark = 0, longest = 0, low_x = 800, high_x = 0, seen = 0;
  for (std::int64_t y = 0; y < strip.height(); ++y) {
    dark = 0;
    for (std::int64_t x = 0; x < 800; ++x) {
      if (strip(x, y) == ramp.at(0.02)) low_x = std::min(low_x, x), ++seen;
      if (strip(x, y) == ramp.at(0.98)) high_x = std::max(high_x, x), ++seen;
      // The first row of the scale bar is ink all along.
      dark = x > 500 && strip(x, y) == Colour{45, 45, 48, 255} ? dark + 1 : 0;
      longest = std::max(longest, dark);
    }
  }
  EXPECT_GT(seen, 10);
  EXPECT_LT(low_x + 300, high_x);
  EXPECT_EQ(longest, 200);  // a quarter of 800 pixels of 10 m: 2 km
}

TEST(DrawLegend, WithoutARangeOrAScaleStillWorks) {
  Legend legend;
  legend.low = legend.high = std::nan("");
  EXPECT_GT(draw_legend(legend, named_ramp("grey"), 300).height(), 0);
}

TEST(StyleLegend, TellsWhatTheColoursAndLinesAre) {
  Legend legend;
  legend.title = "Elevation, 0 to 900 m";
  style_legend(legend, {.colour = GroundColour::slope, .contour_interval_m = 50}, 45);
  EXPECT_EQ(legend.title, "Slope in degrees (elevation 0 to 900 m)");
  EXPECT_EQ(legend.high, 45);
  EXPECT_EQ(legend.note, "contours every 50 m");
  Legend directions;
  style_legend(directions, {.colour = GroundColour::aspect}, 45);
  ASSERT_EQ(directions.marks.size(), 5u);
  EXPECT_EQ(directions.marks[1], (std::pair<double, std::string>{90, "E"}));
  EXPECT_EQ(directions.swatches.size(), 1u);
  Legend plain;
  plain.high = 900;
  style_legend(plain, {}, 45);
  EXPECT_EQ(plain.high, 900);
  EXPECT_TRUE(plain.note.empty());
}

}  // namespace
}  // namespace arete
