#include "core/codec/subband_models.h"

#include <cstddef>
#include <cstdint>
#include <iterator>

// The states that every stream starts with: what the coder had learned from the bands of real DEMs at seven rates each.
// tests/bench/train_subband_states.cpp wrote the numbers: for each probability 32 x its logit in 1/24 + a count of bits that
// says how fast the state gives way to the stream's own; then the weights of the mixers in 1/65536.

namespace arete {
namespace {

constexpr std::int32_t trained[] = {
#include "core/codec/subband_states.inc"
};

BitModel unpack(std::int32_t packed) {
  const std::int32_t count = packed & 31;
  const std::int32_t logit = (packed - count) / 32 * 24;
  return {(squash(logit) << 16) | static_cast<std::uint32_t>(count)};
}

SubbandModels read_models() {
  SubbandModels models;
  const std::int32_t* next = std::begin(trained);
  visit_models(models, [&](auto& model) {
    if constexpr (requires { model.state; })
      model = unpack(*next++);
    else
      for (std::int32_t& weight : model.weights) weight = *next++;
  });
  return models;
}

}  // namespace

const SubbandModels& initial_subband_models() {
  static const SubbandModels models = read_models();
  return models;
}

}  // namespace arete
