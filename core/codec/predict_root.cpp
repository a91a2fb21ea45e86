#include "core/codec/predict_root.h"

#include "core/codec/predict_pass.h"

namespace arete {
namespace {

// How many binary digits a residual has, each digit of the count by its own model.
struct RootModels {
  std::array<BitModel, 34> length;
};

template <typename Bits>
std::int64_t code_step_count(Bits& bits, RootModels& models, std::int64_t index) {
  const auto magnitude = static_cast<std::uint64_t>(index < 0 ? -index : index);
  const int wanted = 64 - std::countl_zero(magnitude);
  int length = 0;
  while (length < 33 && code_bit(bits, models.length[static_cast<std::size_t>(length)], length < wanted) != 0) ++length;
  if (length == 0) return 0;
  const std::uint64_t low = length == 1 ? 0 : bits.raw(static_cast<std::uint32_t>(magnitude & ((std::uint64_t{1} << (length - 1)) - 1)), length - 1);
  const auto read = static_cast<std::int64_t>((std::uint64_t{1} << (length - 1)) | low);
  return bits.raw(index < 0, 1) != 0 ? -read : read;
}

template <typename Bits>
void code_root(Bits& bits, const PredictParameters& file, const std::int32_t* truth, RasterView<const std::uint8_t> voids,
               RasterView<std::int32_t> values) {
  RootModels models;
  auto before = static_cast<std::int32_t>((std::int64_t{file.lowest} + file.highest) >> 1);
  for (std::int64_t y = 0; y < values.height; ++y)
    for (std::int64_t x = 0; x < values.width; ++x) {
      std::int64_t mean = before;
      if (x > 0 && y > 0)
        mean = (std::int64_t{values(x - 1, y)} + values(x, y - 1)) >> 1;
      else if (y > 0)
        mean = values(x, y - 1);
      const auto prediction = static_cast<std::int32_t>(mean);
      values(x, y) = prediction;
      if (voids.data != nullptr && voids(x, y) != 0) continue;
      const std::int64_t index =
          code_step_count(bits, models, truth != nullptr ? residual_steps(truth[y * values.width + x], prediction, file.root_step) : 0);
      values(x, y) = add_steps(prediction, index, file.root_step, file);
      before = values(x, y);
    }
}

}  // namespace

std::vector<std::byte> encode_root(const PredictParameters& file, const BlockView& truth, RasterView<std::int32_t> decoded) {
  std::vector<std::int32_t> wanted;
  for (std::int64_t y = 0; y < decoded.height; ++y) wanted.insert(wanted.end(), truth.values.row(y), truth.values.row(y) + decoded.width);
  RangeEncoder coder;
  BitWriter bits{coder};
  code_root(bits, file, wanted.data(), truth.voids, decoded);
  return coder.finish();
}

void decode_root(const PredictParameters& file, std::span<const std::byte> bytes, RasterView<const std::uint8_t> voids,
                 RasterView<std::int32_t> decoded) {
  RangeDecoder coder(bytes);
  BitReader bits{coder};
  code_root(bits, file, nullptr, voids, decoded);
}

}  // namespace arete
