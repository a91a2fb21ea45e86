#include "core/codec/predict_parameters.h"

#include <algorithm>
#include <cstdlib>

#include "core/codec/predict_residual.h"
#include "core/codec/predict_rows.h"
#include "core/support/error.h"

namespace arete {
namespace {

// Fitted to SRTM of the eastern Alps at 1 arc-second, without loss.
LevelParameters make_default_parameters() {
  LevelParameters level;
  level.phases[0].taps = {1476, 1275, -201, -196, -222, -173, -27, -3, 26, 34, 48, 11};
  level.phases[1].taps = {2011, 729, -242, -282, -124, -97, -123, 32, 72, 97, -3, -22};
  level.phases[2].taps = {1961, 587, 218, 87, -351, -341, -140, -91, -203, -37, 120, 143, 53, 42};
  level.phases[0].activity = {26, 13, 8, 3, 0, 4, 4, 8, 0};
  level.phases[1].activity = {24, 6, 3, 2, 4, 11, 5, 4, 1};
  level.phases[2].activity = {17, 6, 1, 2, 3, 9, 14, 2, 3};
  return level;
}

// Signed numbers in an adaptive Elias-gamma code: how long, then the digits, then the sign.
struct NumberModels {
  std::array<BitModel, 20> length;
};

template <typename Bits>
std::int32_t code_number(Bits& bits, NumberModels& models, std::int32_t value) {
  const auto magnitude = static_cast<std::uint32_t>(std::abs(value));
  const int wanted = 31 - std::countl_zero(magnitude + 1);
  int length = 0;
  while (length < 19 && code_bit(bits, models.length[static_cast<std::size_t>(length)], length < wanted) != 0) ++length;
  const std::uint32_t low = length == 0 ? 0 : bits.raw((magnitude + 1) & ((1U << length) - 1), length);
  const auto read = static_cast<std::int32_t>(((1U << length) | low) - 1);
  return read != 0 && bits.raw(value < 0, 1) != 0 ? -read : read;
}

struct ParameterModels {
  BitModel same_step;
  NumberModels taps;
  NumberModels recursion;
  NumberModels activity;
  NumberModels noise;
};

// The same walk in both directions. `out` holds the values on the way out and receives them on the way in; what a bound
// would break shows in `sound`.
template <typename Bits>
void code_phase(Bits& bits, ParameterModels& models, PhaseParameters& out, const PhaseParameters& before, std::size_t pairs, bool& sound) {
  std::int32_t sum = 0;
  for (std::size_t i = 1; i < pairs; ++i) {
    const std::int32_t difference = code_number(bits, models.taps, (out.taps[i] - before.taps[i]) / tap_grain);
    out.taps[i] = before.taps[i] + difference * tap_grain;
    sum += out.taps[i];
    sound = sound && std::abs(difference) < 8192;
  }
  out.taps[0] = 2048 - sum;
  std::int32_t magnitudes = 0;
  for (std::int32_t tap : out.taps) magnitudes += std::abs(tap);
  sound = sound && magnitudes <= 8191;
  magnitudes = 0;
  for (std::int32_t& weight : out.recursion) {
    weight = code_number(bits, models.recursion, weight / recursion_grain) * recursion_grain;
    magnitudes += std::abs(weight);
    sound = sound && magnitudes <= 256;
  }
  for (std::size_t i = 0; i < out.activity.size(); ++i) {
    const std::int32_t weight = before.activity[i] + code_number(bits, models.activity, out.activity[i] - before.activity[i]);
    sound = sound && weight >= 0 && weight <= 255;
    out.activity[i] = static_cast<std::uint8_t>(weight);
  }
  out.noise = before.noise + code_number(bits, models.noise, out.noise - before.noise);
  sound = sound && out.noise >= 0 && out.noise < 120;
}

template <typename Bits>
std::int32_t code_step(Bits& bits, std::int32_t step, bool& sound) {
  const auto read = static_cast<std::int32_t>(bits.raw(static_cast<std::uint32_t>(step), 25));
  sound = sound && read >= 1 && read <= 1 << 24;
  return read;
}

template <typename Bits>
bool code_parameters(Bits& bits, PredictParameters& file) {
  bool sound = true;
  file.lowest = static_cast<std::int32_t>(bits.raw(static_cast<std::uint32_t>(file.lowest), 32));
  file.highest = static_cast<std::int32_t>(bits.raw(static_cast<std::uint32_t>(file.highest), 32));
  sound = file.lowest <= file.highest;
  file.root_step = code_step(bits, file.root_step, sound);
  ParameterModels models;
  const LevelParameters* before = &default_level_parameters();
  for (LevelParameters& level : file.levels) {
    const bool first = before == &default_level_parameters();
    if (!first && code_bit(bits, models.same_step, level.step == before->step) != 0)
      level.step = before->step;
    else
      level.step = code_step(bits, level.step, sound);
    for (std::size_t p = 0; p < coded_phases && sound; ++p)
      code_phase(bits, models, level.phases[p], before->phases[p], static_cast<std::size_t>(pair_count[p]), sound);
    if (!sound) return false;
    before = &level;
  }
  return sound;
}

}  // namespace

const LevelParameters& default_level_parameters() {
  static const LevelParameters level = make_default_parameters();
  return level;
}

std::vector<std::byte> encode_parameters(const PredictParameters& parameters) {
  PredictParameters copy = parameters;
  RangeEncoder coder;
  BitWriter bits{coder};
  code_parameters(bits, copy);
  return coder.finish();
}

PredictParameters decode_parameters(std::span<const std::byte> bytes, int levels, const std::string& name) {
  PredictParameters parameters;
  parameters.levels.resize(static_cast<std::size_t>(levels));
  RangeDecoder coder(bytes);
  BitReader bits{coder};
  if (!code_parameters(bits, parameters))
    throw Error(ErrorKind::damaged, "'" + name + "' is damaged: its prediction parameters are not allowed; take a fresh copy or make it again");
  return parameters;
}

}  // namespace arete
