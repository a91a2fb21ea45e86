// Fidelity on real terrain. The expected errors are those of one 9 x 9 ridge regression in a NumPy prototype, measured on the same files by
// the same protocol: input = area average; voids, and the 6 coarse cells nearest to them and to the border, left out.
#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "core/amplify/amplify.h"
#include "core/amplify/learn.h"
#include "core/terrain/resample.h"
#include "core/terrain/spectrum.h"
#include "gis/dem_file.h"
#include "tests/data.h"

namespace arete {
namespace {

/// A DEM, or its western or eastern half ("davos_srtm1_1arcsec.tif:west"). No cells where the data is absent.
Raster<float> load(const std::string& name) {
  const std::size_t colon = name.find(':');
  const std::string path = test_data(name.substr(0, colon));
  if (path.empty()) return {};
  const DemReader reader(path);
  const Size size = reader.size();
  Window window{0, 0, size.width, size.height};
  if (colon != std::string::npos) {
    window.width = size.width / 2;
    if (name.substr(colon + 1) == "east") window.x = size.width - window.width;
  }
  Raster<float> cells(window.width, window.height);
  reader.read(window, cells.view());
  return cells;
}

/// A truth, its area average, and what the average makes of itself with a dictionary.
struct Trial {
  Trial(const Raster<float>& cells, Dictionary dictionary, double detail) : factor(dictionary.factor), coarse(area_average(cells.view(), factor)) {
    truth = Raster<float>(coarse.width() * factor, coarse.height() * factor);
    ViewSource(cells.view()).read({0, 0, truth.width(), truth.height()}, truth.view());
    fine = Raster<float>(truth.width(), truth.height());
    AmplifyOptions options;
    options.factor = factor;
    options.detail = detail;
    ViewSink sink(fine.view());
    NoProgress silent;
    report = amplify(ViewSource(coarse.view()), std::move(dictionary), options, sink, silent);
  }

  bool counts(std::int64_t x, std::int64_t y) const {  // coarse cells
    constexpr std::int64_t border = 6;
    if (x < border || y < border || x >= coarse.width() - border || y >= coarse.height() - border) return false;
    for (std::int64_t j = y - border; j <= y + border; ++j)
      for (std::int64_t i = x - border; i <= x + border; ++i)
        if (is_void(coarse(i, j))) return false;
    return true;
  }

  double rmse() const {
    double sum = 0;
    std::int64_t cells = 0;
    for (std::int64_t y = 0; y < coarse.height(); ++y)
      for (std::int64_t x = 0; x < coarse.width(); ++x) {
        if (!counts(x, y)) continue;
        for (std::int64_t k = 0; k < factor * factor; ++k, ++cells) {
          const std::int64_t i = x * factor + k % factor, j = y * factor + k / factor;
          sum += std::pow(static_cast<double>(fine(i, j)) - static_cast<double>(truth(i, j)), 2);
        }
      }
    return std::sqrt(sum / static_cast<double>(cells));
  }

  /// The largest distance of the area average from the input, in units of the spacing of floats there.
  double inconsistency() const {
    const Raster<float> average = area_average(fine.view(), factor);
    double worst = 0;
    for (std::int64_t i = 0; i < coarse.size().cells(); ++i) {
      const float z = coarse.data()[i];
      if (is_void(z) && is_void(average.data()[i])) continue;
      const float spacing = std::nextafter(std::abs(z), INFINITY) - std::abs(z);
      const double off = std::abs(static_cast<double>(average.data()[i]) - static_cast<double>(z)) / std::max(1e-5, static_cast<double>(spacing));
      worst = std::isnan(off) ? INFINITY : std::max(worst, off);
    }
    return worst;
  }

  int factor;
  Raster<float> coarse, truth, fine;
  AmplifyReport report;
};

struct Row {
  const char* exemplar;
  const char* input;
  int factor;
  double linear_rmse_m;
};
void PrintTo(const Row& row, std::ostream* out) { *out << row.exemplar << " to " << row.input << " x" << row.factor; }

class Fidelity : public testing::TestWithParam<Row> {};

TEST_P(Fidelity, WithoutDetailTheErrorIsThatOfTheRegressionAndTheInputIsKept) {
  const Row& row = GetParam();
  const Raster<float> exemplar = load(row.exemplar), input = load(row.input);
  if (exemplar.size().cells() == 0 || input.size().cells() == 0) GTEST_SKIP() << "no " << row.exemplar << " or " << row.input;
  Dictionary dictionary;
  dictionary.factor = row.factor;
  dictionary.upsampler = train_upsampler({exemplar.view()}, row.factor);
  const Trial trial(input, std::move(dictionary), 0);
  RecordProperty("rmse_m", std::to_string(trial.rmse()));  // with --gtest_output=json
  EXPECT_LT(trial.rmse(), 1.01 * row.linear_rmse_m) << row.exemplar << " -> " << row.input << " x" << row.factor;
  EXPECT_LE(trial.inconsistency(), 1) << row.exemplar << " -> " << row.input << " x" << row.factor;
}

INSTANTIATE_TEST_SUITE_P(Terrains, Fidelity,
                         testing::Values(Row{"davos_srtm1_1arcsec.tif:west", "davos_srtm1_1arcsec.tif:east", 2, 2.613},
                                         Row{"alr_tyrol_dtm_5m.tif", "hit_tyrol_dtm_5m.asc", 2, 0.477},
                                         Row{"hit_tyrol_dtm_5m.asc", "alr_tyrol_dtm_5m.tif", 2, 0.381},
                                         Row{"gabilan_lidar_1m.bil", "greenriver_lidar_1m.tif", 2, 0.0776},
                                         Row{"greenriver_lidar_1m.tif", "gabilan_lidar_1m.bil", 2, 0.0127},
                                         Row{"davos_srtm1_1arcsec.tif:west", "davos_srtm1_1arcsec.tif:east", 4, 5.137},
                                         Row{"alr_tyrol_dtm_5m.tif", "hit_tyrol_dtm_5m.asc", 4, 1.073},
                                         Row{"hit_tyrol_dtm_5m.asc", "alr_tyrol_dtm_5m.tif", 4, 0.905},
                                         Row{"gabilan_lidar_1m.bil", "greenriver_lidar_1m.tif", 4, 0.1156},
                                         Row{"greenriver_lidar_1m.tif", "gabilan_lidar_1m.bil", 4, 0.0282}));

Dictionary learn(const Raster<float>& exemplar, int factor) {
  LearnOptions options;
  options.method = LearningMethod::all;
  options.factor = factor;
  LearnReport report;
  NoProgress silent;
  return learn_dictionary({{"exemplar", exemplar.view(), 0}}, options, report, silent);
}

class Nature : public testing::TestWithParam<Row> {};

TEST_P(Nature, NaturalDetailContinuesTheSpectrumAndKeepsTheInput) {
  const Row& row = GetParam();
  const Raster<float> exemplar = load(row.exemplar), input = load(row.input);
  if (exemplar.size().cells() == 0 || input.size().cells() == 0) GTEST_SKIP() << "no " << row.exemplar << " or " << row.input;
  const Trial trial(input, learn(exemplar, row.factor), 1);
  EXPECT_FALSE(trial.report.unlike) << trial.report.likeness;
  EXPECT_LE(trial.inconsistency(), 1);
  // Independent detail of the full power would give the root of 2.
  EXPECT_LT(trial.rmse(), 1.35 * 1.01 * row.linear_rmse_m);
  const SpectrumComparison spectrum = compare_spectra(trial.truth.view(), trial.fine.view(), {row.factor, 64, 0, 0});
  for (const BandPower& band : spectrum.bands) {
    EXPECT_GT(band.ratio(), 0.8) << row.exemplar << " -> " << row.input << " from " << band.lower;
    EXPECT_LT(band.ratio(), 1.25) << row.exemplar << " -> " << row.input << " from " << band.lower;
  }
}

INSTANTIATE_TEST_SUITE_P(Terrains, Nature,
                         testing::Values(Row{"alr_tyrol_dtm_5m.tif", "hit_tyrol_dtm_5m.asc", 4, 1.073},
                                         Row{"hit_tyrol_dtm_5m.asc", "alr_tyrol_dtm_5m.tif", 4, 0.905}));

// Desert with ledges does not tell what a smooth hill looks like.
TEST(Nature, ARoughExemplarForASmoothHillIsNoticed) {
  const Raster<float> exemplar = load("greenriver_lidar_1m.tif"), input = load("gabilan_lidar_1m.bil");
  if (exemplar.size().cells() == 0 || input.size().cells() == 0) GTEST_SKIP() << "no greenriver or gabilan";
  const Trial trial(input, learn(exemplar, 4), 1);
  EXPECT_TRUE(trial.report.unlike);
  EXPECT_LT(trial.report.detail_scale, 0.6);
  EXPECT_LT(trial.rmse(), 1.1 * std::sqrt(2) * 0.0282);  // independent detail of the input's own power, 10 % for its estimate
}

}  // namespace
}  // namespace arete
