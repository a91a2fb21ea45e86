#include "core/amplify/learn.h"

#include <gtest/gtest.h>

#include "core/sparse/dictionary_file.h"
#include "core/sparse/patches.h"
#include "core/support/error.h"
#include "core/synthesis/mountains.h"
#include "core/terrain/resample.h"

namespace arete {
namespace {

const Raster<float>& terrain() {
  static const Raster<float> cells = synthesize_mountains({256, 192}, {});
  return cells;
}

Dictionary learn(const LearnOptions& options, LearnReport& report) {
  NoProgress silent;
  return learn_dictionary({{"made", terrain().view(), 30}}, options, report, silent);
}

LearnOptions small(LearningMethod method) {
  LearnOptions options;
  options.method = method;
  options.atoms = 40;
  options.detail = false;
  return options;
}

TEST(LearnDictionary, EveryMethodGivesUnitAtomsAndBothHalves) {
  for (const LearningMethod method : {LearningMethod::all, LearningMethod::ksvd, LearningMethod::constrained}) {
    LearnReport report;
    const Dictionary d = learn(small(method), report);
    EXPECT_EQ(d.atoms(), 40);
    EXPECT_EQ(d.low.rows(), 36);
    EXPECT_EQ(d.high.rows(), 24 * 24);
    EXPECT_EQ(d.high.cols(), 40);
    EXPECT_EQ(d.cell_size_m, 120);
    for (Eigen::Index j = 0; j < d.low.cols(); ++j) EXPECT_NEAR(d.low.col(j).norm(), 1, 1e-5);
    EXPECT_GE(report.patches, 23 * 17);  // half-overlapping patches that touch 64 x 48 coarse cells
  }
}

// D8 of the habilitation thesis: the high atom, averaged, is the low patch before its weights, in units of the low patch's norm.
TEST(LearnDictionary, TheAverageOfAHighAtomIsItsLowAtom) {
  LearnReport report;
  const Dictionary d = learn(small(LearningMethod::constrained), report);
  const std::vector<float> weights = disc_weights(6);
  for (Eigen::Index j = 0; j < d.atoms(); ++j) {
    const RasterView<const float> high{d.high.col(j).data(), 24, 24, 24};
    const Raster<float> average = area_average(high, 4);
    for (int k = 0; k < 36; ++k)
      EXPECT_NEAR(average.data()[k] * weights[static_cast<std::size_t>(k)], d.low(k, j), 1e-4) << "atom " << j;
  }
}

TEST(LearnDictionary, ConstrainedAtomsAreTheGroundThatTheyName) {
  LearnReport report;
  const Dictionary d = learn(small(LearningMethod::constrained), report);
  const Raster<float> coarse = area_average(terrain().view(), 4);
  const PatchGrid grid = make_patch_grid(6);
  for (Eigen::Index j = 0; j < d.atoms(); ++j) {
    const AtomSource& source = d.sources[static_cast<std::size_t>(j)];
    Eigen::VectorXf patch(36);
    ASSERT_TRUE(cut_cells(coarse.view(), source.x, source.y, 6, source.symmetry, patch.data()));
    make_patch(grid, patch.data());
    EXPECT_LT((patch.normalized() - d.low.col(j)).norm(), 1e-6f);
  }
}

TEST(LearnDictionary, TheSameSeedGivesTheSameBytesForAnyThreads) {
  for (const LearningMethod method : {LearningMethod::ksvd, LearningMethod::constrained}) {
    LearnOptions options = small(method);
    options.detail = true;
    LearnReport report;
    options.threads = 1;
    const auto one = encode_dictionary(learn(options, report));
    options.threads = 3;
    EXPECT_EQ(one, encode_dictionary(learn(options, report)));
    options.seed = 2;
    EXPECT_NE(one, encode_dictionary(learn(options, report)));
  }
}

TEST(LearnDictionary, TheObjectiveNeverRises) {
  for (const LearningMethod method : {LearningMethod::ksvd, LearningMethod::constrained}) {
    LearnReport report;
    learn(small(method), report);
    ASSERT_GT(report.objective.size(), 1u);
    for (std::size_t i = 1; i < report.objective.size(); ++i) EXPECT_LE(report.objective[i], report.objective[i - 1] * (1 + 1e-9));
  }
}

TEST(LearnDictionary, SeveralExemplarsShareTheAtomsByName) {
  const Raster<float> other = synthesize_mountains({192, 192}, {.seed = 7});
  NoProgress silent;
  LearnReport report;
  const Dictionary d = learn_dictionary({{"a", terrain().view(), 30}, {"b", other.view(), 30}}, small(LearningMethod::all), report, silent);
  std::int64_t from_b = 0;
  for (const AtomSource& source : d.sources) from_b += source.exemplar == 1;
  EXPECT_EQ(from_b, 20);
  EXPECT_EQ(d.exemplars, (std::vector<std::string>{"a", "b"}));
}

ErrorKind failure(const Raster<float>& cells, const LearnOptions& options) {
  NoProgress silent;
  LearnReport report;
  try {
    learn_dictionary({{"x", cells.view(), 1}}, options, report, silent);
  } catch (const Error& error) {
    return error.kind();
  }
  return ErrorKind{0};
}

TEST(LearnDictionary, RefusesWhatCannotBeLearnedFrom) {
  EXPECT_EQ(failure(Raster<float>(100, 100, void_value), {}), ErrorKind::input);
  EXPECT_EQ(failure(Raster<float>(100, 100, 5.0f), {}), ErrorKind::input);
  EXPECT_EQ(failure(Raster<float>(6, 4, 5.0f), {}), ErrorKind::input);
  LearnOptions odd;
  odd.patch_cells = 5;
  EXPECT_EQ(failure(terrain(), odd), ErrorKind::usage);
  LearnOptions no_factor;
  no_factor.factor = 1;
  EXPECT_EQ(failure(terrain(), no_factor), ErrorKind::usage);
}

}  // namespace
}  // namespace arete
