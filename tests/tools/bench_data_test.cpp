#include "tools/bench_data.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/bench_sample.h"

namespace arete::tools {
namespace {

using testing::HasSubstr;

TEST(GainOverAnchor, IsOverWhatBothReached) {
  const BenchedDem dem = sample_bench();
  ASSERT_NE(anchor_trial(dem), nullptr);
  const GainOverAnchor gain = gain_over_anchor(dem, dem.trials[1]);
  EXPECT_NEAR(gain.mean_db.value(), 2, 1e-12);
  EXPECT_NEAR(gain.bd_psnr_db.value(), 2, 1e-12);
  // 6 dB for each doubling: 2 dB are a factor of 2^(1/3).
  EXPECT_NEAR(gain.bd_rate_percent.value(), 100 * (std::pow(2, -1.0 / 3) - 1), 1e-9);
  EXPECT_FALSE(gain_over_anchor(dem, dem.trials[0]).mean_db);
  BenchedDem alone = sample_bench();
  alone.trials.erase(alone.trials.begin());
  EXPECT_EQ(anchor_trial(alone), nullptr);
  EXPECT_FALSE(gain_over_anchor(alone, alone.trials[0]).bd_psnr_db);
}

TEST(PercentOverBestOther, CountsOnlyWhatWasKept) {
  BenchedDem dem = sample_bench();
  EXPECT_FALSE(percent_over_best_other(dem, dem.trials[0], 0)) << "the only other broke the bound";
  dem.trials[1].bounds[0]->max_error_m = 1;
  dem.trials[1].bounds[0]->bytes = 2400;
  EXPECT_NEAR(percent_over_best_other(dem, dem.trials[1], 0).value(), -20, 1e-9);
  EXPECT_NEAR(percent_over_best_other(dem, dem.trials[0], 0).value(), 25, 1e-9);
  EXPECT_FALSE(percent_over_best_other(dem, dem.trials[1], 1));
  EXPECT_FALSE(percent_over_best_other(dem, dem.trials[1], std::nullopt));
}

TEST(BenchCsv, HasAsManyFieldsInEachLineAndQuotesNames) {
  const std::string csv = bench_csv({sample_bench("plain"), sample_bench("a \"b\", c")});
  EXPECT_THAT(csv, HasSubstr("\n\"a \"\"b\"\", c\",openjpeg,point,bytes,100,100,0.1,"));
  EXPECT_THAT(csv, HasSubstr("plain,other,bound,max_error_m,1,3000,3,"));
  EXPECT_THAT(csv, HasSubstr("plain,other,lossless,lossless,,1000,1,inf,0,0,"));
  EXPECT_THAT(csv, HasSubstr(",no\n")) << "the bound that was broken";
  std::string plain_part = csv.substr(0, csv.find("\n\"a "));
  for (std::size_t at = 0, end; at < plain_part.size(); at = end + 1) {
    end = std::min(plain_part.find('\n', at), plain_part.size());
    EXPECT_EQ(std::count(plain_part.begin() + static_cast<std::ptrdiff_t>(at), plain_part.begin() + static_cast<std::ptrdiff_t>(end), ','), 12)
        << plain_part.substr(at, end - at);
  }
}

TEST(BenchJson, HasNullWhereThereIsNoNumber) {
  const auto data = bench_json({sample_bench()});
  const auto& other = data.at("dems").at(0).at("codecs").at(1);
  EXPECT_TRUE(other.at("curve").at(2).at("psnr_db").is_null());
  EXPECT_EQ(other.at("curve").at(2).at("exact"), true);
  EXPECT_TRUE(other.at("rates").at(2).is_null());
  EXPECT_EQ(other.at("bounds").at(0).at("kept"), false);
  EXPECT_TRUE(other.at("bounds").at(1).is_null());
  EXPECT_NEAR(other.at("over_anchor").at("mean_gain_db").get<double>(), 2, 1e-12);
  EXPECT_TRUE(data.at("dems").at(0).at("codecs").at(0).at("lossless").is_null());
}

TEST(PaperCsv, HasARowForEachSparsity) {
  const std::string csv = paper_csv({sample_bench("one"), sample_bench("two")});
  EXPECT_THAT(csv, HasSubstr("\none,128,8,0.5,0.25,1000,1,40.0000,1001,43.5000,0.0000,0.0000\ntwo,128,8,"));
  EXPECT_EQ(bench_json({sample_bench()}).at("dems").at(0).at("paper").at(0).at("jpeg2000").at("bytes"), 1001);
  EXPECT_THAT(bench_text({sample_bench()}), HasSubstr("8 | 50.0 % | 25.0 % | 1000 | 1.000 | 40.00 | 1001 | 43.50 | -3.50"));
}

TEST(BenchText, ShowsGainsAndBrokenBounds) {
  const std::string text = bench_text({sample_bench()});
  for (const char* part : {"100 x 80 cells", "+2.00", "broken", "1.000"}) EXPECT_THAT(text, HasSubstr(part));
}

TEST(FormatValue, NamesWhatIsNoNumber) {
  EXPECT_EQ(format_value(1.25, 1), "1.2");
  EXPECT_EQ(format_value(std::nullopt, 1), "-");
  EXPECT_EQ(format_value(INFINITY, 1), "exact");
  EXPECT_EQ(format_plain(0.05), "0.05");
  EXPECT_EQ(format_plain(20), "20");
}

}  // namespace
}  // namespace arete::tools
