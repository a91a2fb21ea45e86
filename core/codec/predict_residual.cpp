#include "core/codec/predict_residual.h"

#include <cstddef>
#include <iterator>

// The states that every stream starts with: what the coder had learned from five real DEMs at six bounds each (SRTM of Ticino at 3
// arc-seconds and of Recife at 1, the Inyo Mountains at 30 m, lidar of the Nordkette and the Tux Alps at 5 m).
// tests/bench/train_predict_states.cpp wrote the numbers: for each probability 32 x its logit in 1/24 + a count of bits that
// says how fast the state gives way to the stream's own; then the weights of the mixers in 1/65536.

namespace arete {
namespace {

constexpr std::int32_t trained[] = {
#include "core/codec/predict_states.inc"
};

class Reader {
 public:
  void read(BitModel& model) {
    const std::int32_t packed = trained[position_++];
    const std::int32_t count = packed & 31;
    model.state = (squash((packed - count) / 32 * 24) << 16) | static_cast<std::uint32_t>(count);
  }
  template <int count>
  void read(BitMixer<count>& mixer) {
    for (std::int32_t& weight : mixer.weights) weight = trained[position_++];
  }
  template <class T, std::size_t size>
  void read(std::array<T, size>& parts) {
    for (T& part : parts) read(part);
  }

 private:
  std::size_t position_ = 0;
};

ResidualModels read_models() {
  ResidualModels models;
  Reader reader;
  for_each_state(models, [&](auto& part) { reader.read(part); });
  return models;
}

}  // namespace

const ResidualModels& initial_residual_models() {
  static const ResidualModels models = read_models();
  return models;
}

}  // namespace arete
