#include "tools/bench_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/bench_sample.h"

namespace arete::tools {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(BenchPage, SaysWhatWasMeasuredAndWhatWasBroken) {
  const std::string html = write_html(bench_page({sample_bench("one"), sample_bench("two")}, "arete bench compression <x>"));
  for (const char* part : {"<h2>one</h2>", "<h2>two</h2>", "+2.00 dB", "-20.6 %", "Broken promise: one: Other &lt;new&gt; was asked for 1 m and erred by 1.5 m",
                           "3.000 (broken)", "<td>43.50</td><td>-3.50</td>", "10 cells are void", "medians of 3 runs with 2 threads", "compression &lt;x&gt;", "one, two"})
    EXPECT_THAT(html, HasSubstr(part));
  EXPECT_THAT(html, Not(HasSubstr("nan")));
  EXPECT_THAT(html, Not(HasSubstr("<script")));
}

TEST(BenchPage, HoldsTheFirstCodecAgainstTheBestOther) {
  BenchedDem dem = sample_bench();
  dem.trials[1].bounds[0]->max_error_m = 1;
  dem.trials[1].bounds[0]->bytes = 2400;
  const std::string html = write_html(bench_page({dem}, "x"));
  EXPECT_THAT(html, HasSubstr("<td>bytes of JPEG 2000 against the best other</td><td>+25.0 %</td><td>-</td>"));
  EXPECT_THAT(write_html(bench_page({sample_bench()}, "x")), Not(HasSubstr("against the best other</td>")));
}

TEST(PsnrPlot, BeginsBelowTheAnchorAndLeavesOutExactPoints) {
  const LinePlot plot = psnr_plot(sample_bench());
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_EQ(plot.series[0].points.size(), 3u);
  EXPECT_EQ(plot.series[1].points.size(), 2u);
  EXPECT_LT(plot.y_low, plot.series[0].points.front().second);
  EXPECT_GT(plot.y_high, 60);
  EXPECT_NE(plot.series[0].colour, plot.series[1].colour);
}

TEST(MaxErrorPlot, DashesWhatWasAskedForAnError) {
  const LinePlot plot = max_error_plot(sample_bench());
  ASSERT_EQ(plot.series.size(), 4u);
  EXPECT_FALSE(plot.series[0].dashed);
  EXPECT_TRUE(plot.series[1].dashed);
  EXPECT_EQ(plot.series[1].name, "");
  EXPECT_EQ(plot.series[1].points, (std::vector<std::pair<double, double>>{{3, 1}}));
  EXPECT_TRUE(plot.log_y);
}

TEST(BoundPlot, HasWhatWasKeptOverTheBound) {
  BenchedDem dem = sample_bench();
  dem.trials[0].bounds[1] = Measurement{.target = {CodingTarget::Kind::max_error, 2}, .bits = 2, .max_error_m = 2};
  const LinePlot plot = bound_plot(dem);
  ASSERT_EQ(plot.series.size(), 1u) << "the other broke its only bound";
  EXPECT_EQ(plot.series[0].points, (std::vector<std::pair<double, double>>{{1, 3}, {2, 2}}));
  EXPECT_TRUE(plot.log_x && plot.log_y);
}

}  // namespace
}  // namespace arete::tools
