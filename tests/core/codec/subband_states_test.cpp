#include <gtest/gtest.h>

#include "core/codec/subband_models.h"

namespace arete {
namespace {

// The larger the magnitudes around, the less likely a zero: what the trained states must have learned.
TEST(SubbandStates, ZerosGrowRareWithTheExpectedMagnitude) {
  const SubbandModels& models = initial_subband_models();
  for (int quantiser = 0; quantiser < 2; ++quantiser)
    for (int band = 0; band < band_count; ++band)
      for (int bin = 8; bin < 24; bin += 4)
        EXPECT_GT(models.quantisers[quantiser].energy[band][bin + 4][0].p(), models.quantisers[quantiser].energy[band][bin][0].p())
            << quantiser << band << bin;
}

TEST(SubbandStates, TheWholeTableIsRead) {
  const SubbandModels& models = initial_subband_models();
  for (const BitMixer<2>& mixer : models.sign_mixer)
    for (std::int32_t weight : mixer.weights) EXPECT_NE(weight, 0);
}

// The count of core/codec/tree-format.md, 6.6.
TEST(SubbandStates, AllModelsAreVisitedOnce) {
  SubbandModels models;
  int numbers = 0;
  visit_models(models, [&](auto& model) {
    if constexpr (requires { model.state; }) {
      ++numbers;
      ASSERT_NE(model.state, 0U);
      model.state = 0;
    } else {
      numbers += 2;
      ASSERT_NE(model.weights[0], 0);
      model.weights[0] = 0;
    }
  });
  EXPECT_EQ(numbers, 5651);
}

}  // namespace
}  // namespace arete
