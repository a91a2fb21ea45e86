#include "gis/line_plot.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace arete {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr Colour red = {255, 0, 0, 255};

LinePlot plot_of(std::vector<std::pair<double, double>> points) {
  LinePlot plot{.title = "A < B & \"C\"", .x_title = "x", .y_title = "y"};
  plot.series.push_back({.name = "curve", .points = std::move(points), .colour = red});
  return plot;
}

std::int64_t red_pixels(const Picture& picture, std::int64_t from_x, std::int64_t to_x) {
  std::int64_t count = 0;
  for (std::int64_t y = 0; y < picture.height(); ++y)
    for (std::int64_t x = from_x; x < to_x; ++x) count += picture(x, y) == red ? 1 : 0;
  return count;
}

/// The row of the only dot in the column, by its pixels.
double middle_row(const Picture& picture, std::int64_t x) {
  double sum = 0, count = 0;
  for (std::int64_t y = 0; y < picture.height(); ++y)
    if (picture(x, y)[0] > 200 && picture(x, y)[1] < 60) sum += static_cast<double>(y) + 0.5, ++count;
  return sum / count;
}

// On logarithmic axes y = x^2 is straight: at a tenth of the way the line is at a tenth of the height.
TEST(DrawLinePlot, APowerIsStraightOnLogarithmicAxes) {
  LinePlot plot = plot_of({{0.01, 1e-4}, {0.1, 1e-2}, {10, 100}});
  plot.log_x = plot.log_y = true;
  const Picture picture = draw_line_plot(plot);
  EXPECT_EQ(picture.width(), 960);
  const double at_150 = middle_row(picture, 150), at_350 = middle_row(picture, 350), at_550 = middle_row(picture, 550);
  EXPECT_NEAR(at_150 - at_350, at_350 - at_550, 1);
  EXPECT_GT(at_150, at_550 + 100);
}

TEST(DrawLinePlot, CutsLinesAtTheFrame) {
  LinePlot plot = plot_of({{0, -1000}, {1, 0.5}, {2, 1000}});
  plot.y_low = 0.1;
  plot.y_high = 1;
  const Picture picture = draw_line_plot(plot);
  for (std::int64_t x = 0; x < 700; ++x) {
    for (std::int64_t y = 0; y < 60; ++y) ASSERT_NE(picture(x, y), red) << x << " " << y;
    for (std::int64_t y = 500; y < picture.height(); ++y) ASSERT_NE(picture(x, y), red) << x << " " << y;
  }
  EXPECT_GT(red_pixels(picture, 0, 700), 50);
}

TEST(DrawLinePlot, LeavesOutWhatAnAxisCannotShow) {
  LinePlot plot = plot_of({{0, 1}, {-1, 1}, {INFINITY, 2}, {1, NAN}});
  plot.log_x = true;
  EXPECT_EQ(red_pixels(draw_line_plot(plot), 0, 700), 0);
  EXPECT_GT(red_pixels(draw_line_plot(plot), 700, 960), 10) << "the legend stays";
  EXPECT_EQ(red_pixels(draw_line_plot(plot_of({})), 0, 700), 0);
}

TEST(DrawLinePlot, ScalesAndIsTheSameEachTime) {
  const LinePlot plot = plot_of({{0, 1}, {1, 3}, {2, 2}});
  const Picture once = draw_line_plot(plot, 2), again = draw_line_plot(plot, 2);
  EXPECT_EQ(once.width(), 1920);
  EXPECT_TRUE(std::equal(once.data(), once.data() + once.width() * once.height(), again.data()));
  // Four times the pixels, but for the edges.
  EXPECT_GT(red_pixels(once, 0, 1400), 3 * red_pixels(draw_line_plot(plot), 0, 700));
}

TEST(LinePlotSvg, EscapesTextAndNamesItsSeries) {
  LinePlot plot = plot_of({{0.02, 40}, {0.1, 50}, {1, 60}});
  plot.log_x = true;
  plot.x_ticks = {0.02, 0.1, 1};
  plot.note = "a note";
  const std::string svg = line_plot_svg(plot);
  EXPECT_THAT(svg, HasSubstr("A &lt; B &amp; &quot;C&quot;"));
  EXPECT_THAT(svg, HasSubstr(">curve</text>"));
  EXPECT_THAT(svg, HasSubstr(">0.02</text>"));
  EXPECT_THAT(svg, HasSubstr("#ff0000"));
  EXPECT_THAT(svg, HasSubstr("a note"));
  EXPECT_THAT(svg, Not(HasSubstr("href")));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(PlotColour, ApartForSevenCurves) {
  for (std::size_t i = 0; i < 7; ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(plot_colour(i), plot_colour(j));
}

}  // namespace
}  // namespace arete
