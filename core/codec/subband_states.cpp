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

class Reader {
 public:
  template <class Array>
  void read(Array& models) {
    for (auto& model : models) {
      if constexpr (requires { model.state; })
        model = unpack(trained[position_++]);
      else if constexpr (requires { model.weights; })
        for (std::int32_t& weight : model.weights) weight = trained[position_++];
      else
        read(model);
    }
  }
  bool at_end() const { return position_ == std::size(trained); }

 private:
  static BitModel unpack(std::int32_t packed) {
    const std::int32_t count = packed & 31;
    const std::int32_t logit = (packed - count) / 32 * 24;
    return {(squash(logit) << 16) | static_cast<std::uint32_t>(count)};
  }
  std::size_t position_ = 0;
};

SubbandModels read_models() {
  SubbandModels models;
  Reader reader;
  reader.read(models.energy);
  reader.read(models.local);
  reader.read(models.exponent);
  reader.read(models.mantissa);
  reader.read(models.sign_mean);
  reader.read(models.sign_pattern);
  reader.read(models.block);
  reader.read(models.mixer);
  reader.read(models.sign_mixer);
  return models;
}

}  // namespace

const SubbandModels& initial_subband_models() {
  static const SubbandModels models = read_models();
  return models;
}

}  // namespace arete
