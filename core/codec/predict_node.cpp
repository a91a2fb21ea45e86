#include "core/codec/predict_node.h"

#include "core/codec/predict_pass.h"

namespace arete {
namespace {

// The true value of a cell on the way out, nothing on the way in.
struct Truth {
  RasterView<const std::int32_t> values;
  const std::int32_t* row(int phase, int y) const { return values.row(2 * y + odd_y(phase)) + odd_x(phase); }
};

// The stream of nothing but zeros.
struct ZeroReader {
  int bit(int, Probability) { return 0; }
  std::uint32_t raw(std::uint32_t, int) { return 0; }
};

// Whether any residual was not zero.
template <typename Sum, typename Bits>
bool code_phase(Bits& bits, NodePlanes& planes, int phase, const PredictParameters& file, const LevelParameters& level,
                ResidualModels& models, const Truth* truth) {
  const auto p = static_cast<std::size_t>(phase);
  const PhaseParameters& parameters = level.phases[p - 1];
  const PhaseContext common{parameters, level.step, quarter_log2(static_cast<std::uint64_t>(level.step)), phase - 1};
  const int columns = coded_width(planes, phase), rows_coded = coded_height(planes, phase);
  PhaseRows<Sum> rows(planes.width);
  std::int64_t any = 0;
  for (int y = -phase_margin[p]; y < planes.height + phase_margin[p]; ++y) {
    filter_row(planes, phase, y, file, parameters, rows.filtered_row());
    if (y < 0 || y >= rows_coded) continue;
    rows.next_row();
    measure_activity(planes, phase, y, columns, parameters, rows.filtered_row(), rows.activity());
    std::int32_t* values = planes.values[p].row(y);
    std::int32_t* magnitudes = planes.magnitudes[p].row(y);
    const std::int32_t* magnitudes_above = planes.magnitudes[p].row(y - 1);
    const std::uint8_t* voids = planes.any_void ? planes.voids[p].row(y) : nullptr;
    const std::int32_t* wanted = truth != nullptr ? truth->row(phase, y) : nullptr;
    for (int x = 0; x < columns; ++x) {
      if (voids != nullptr && voids[x] != 0) continue;
      const auto [prediction, lean] = predict_cell(rows, x, file, parameters);
      const ResidualContext context = residual_context(rows, x, lean, magnitudes[x - 1], magnitudes_above[x], common);
      const std::int64_t index =
          code_residual(bits, models, context, wanted != nullptr ? residual_steps(wanted[2 * x], prediction, level.step) : 0);
      any |= index;
      keep_cell(rows, x, add_steps(prediction, index, level.step, file), index, level.step, values, magnitudes);
    }
  }
  return any != 0;
}

template <typename Bits>
bool code_values(Bits& bits, NodePlanes& planes, const PredictParameters& file, const LevelParameters& level, ResidualModels& models,
                 const Truth* truth) {
  bool any = false;
  for (int phase = 1; phase < 4; ++phase) {
    const bool here = file.narrow() ? code_phase<std::int32_t>(bits, planes, phase, file, level, models, truth)
                                    : code_phase<std::int64_t>(bits, planes, phase, file, level, models, truth);
    any = any || here;
  }
  return any;
}

}  // namespace

std::vector<std::byte> encode_node(const LevelView& coarse, const Window& cells, const PredictParameters& file,
                                   const LevelParameters& level, const BlockView& truth, RasterView<std::int32_t> decoded) {
  ResidualModels models = initial_residual_models();
  return encode_node(coarse, cells, file, level, truth, models, decoded);
}

std::vector<std::byte> encode_node(const LevelView& coarse, const Window& cells, const PredictParameters& file, const LevelParameters& level,
                                   const BlockView& truth, ResidualModels& models, RasterView<std::int32_t> decoded) {
  NodePlanes planes = make_planes(coarse, cells, truth.voids, file);
  RangeEncoder coder;
  BitWriter bits{coder};
  const Truth wanted{truth.values};
  const bool any = code_values(bits, planes, file, level, models, &wanted);
  copy_block(planes, decoded);
  std::vector<std::byte> bytes = coder.finish();
  if (!any) return {};
  if (bytes.empty()) bytes.push_back(std::byte{0});  // an empty stream says that all residuals are zero
  return bytes;
}

void decode_node(const LevelView& coarse, const Window& cells, const PredictParameters& file, const LevelParameters& level,
                 std::span<const std::byte> bytes, RasterView<const std::uint8_t> voids, RasterView<std::int32_t> decoded) {
  NodePlanes planes = make_planes(coarse, cells, voids, file);
  ResidualModels models = initial_residual_models();
  if (bytes.empty()) {
    ZeroReader bits;
    code_values(bits, planes, file, level, models, nullptr);
  } else {
    RangeDecoder coder(bytes);
    BitReader bits{coder};
    code_values(bits, planes, file, level, models, nullptr);
  }
  copy_block(planes, decoded);
}

}  // namespace arete
