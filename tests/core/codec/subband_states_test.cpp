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
        EXPECT_GT(models.energy[0][quantiser][band][bin + 4].p(), models.energy[0][quantiser][band][bin].p()) << quantiser << band << bin;
}

TEST(SubbandStates, TheWholeTableIsRead) {
  const SubbandModels& models = initial_subband_models();
  for (const BitMixer<2>& mixer : models.sign_mixer)
    for (std::int32_t weight : mixer.weights) EXPECT_NE(weight, 0);
}

}  // namespace
}  // namespace arete
