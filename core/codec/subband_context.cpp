// Plain loops, compiled once for each instruction set: the compiler vectorises them over x.
#include "core/codec/subband_context.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/codec/subband_context.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace arete {
namespace HWY_NAMESPACE {

using Magnitudes = const std::uint8_t* HWY_RESTRICT;
using Sums = std::uint16_t* HWY_RESTRICT;
using Values = const std::int32_t* HWY_RESTRICT;

HWY_INLINE std::uint16_t narrow(int value) { return static_cast<std::uint16_t>(value); }

// The same band of the parent, two columns to each of its own: the first to write the sums.
void set_parent(const CoefficientBlock& block, int origin_x, int y, const EnergyWeights& weights, Columns columns, Sums energy, Sums others) {
  Magnitudes row = block.magnitudes(y) + origin_x;
  Magnitudes up = block.magnitudes(y - 1) + origin_x;
  Magnitudes down = block.magnitudes(y + 1) + origin_x;
  const int end = (columns.end + 1) / 2;
  for (int x = columns.first / 2; x < end; ++x) {
    const std::uint16_t here = row[x];
    const std::uint16_t around = narrow(row[x - 1] + row[x + 1] + up[x] + down[x]);
    const std::uint16_t share = narrow(weights.parent * here + weights.parent_around * around);
    const std::uint16_t sum = narrow(2 * here + around / 2);
    energy[2 * x] = share;
    energy[2 * x + 1] = share;
    others[2 * x] = sum;
    others[2 * x + 1] = sum;
  }
}

// Another band of the node, at the same place.
void add_beside(const CoefficientBlock& block, int y, int weight, int weight_around, Columns columns, Sums energy, Sums others) {
  Magnitudes row = block.magnitudes(y);
  Magnitudes up = block.magnitudes(y - 1);
  Magnitudes down = block.magnitudes(y + 1);
  for (int x = columns.first; x < columns.end; ++x) {
    const std::uint16_t here = row[x];
    const std::uint16_t around = narrow(row[x - 1] + row[x + 1] + up[x] + down[x]);
    energy[x] = narrow(energy[x] + narrow(weight * here + weight_around * around));
    others[x] = narrow(others[x] + 2 * here + around / 2);
  }
}

HWY_INLINE std::uint32_t local_bin_of(std::uint16_t s) {
  return static_cast<std::uint32_t>((s >= 1) + (s >= 2) + (s >= 3) + (s >= 5) + (s >= 8) + (s >= 13) + (s >= near_limit));
}

// The same band: up, up2, up-left, up-right; and all sums together.
void pack_places(const CoefficientBlock& block, int y, const EnergyWeights& weights, Columns columns, const std::uint16_t* HWY_RESTRICT energy,
                 const std::uint16_t* HWY_RESTRICT others, std::uint32_t* HWY_RESTRICT places) {
  Magnitudes up = block.magnitudes(y - 1);
  Magnitudes up2 = block.magnitudes(y - 2);
  const std::uint16_t w_up = narrow(weights.up), w_up2 = narrow(weights.up2), w_left = narrow(weights.up_left), w_right = narrow(weights.up_right);
  for (int x = columns.first; x < columns.end; ++x) {
    const std::uint16_t n = up[x], nn = up2[x], nw = up[x - 1], ne = up[x + 1];
    const std::uint16_t sum = narrow(energy[x] + narrow(w_up * n) + narrow(w_up2 * nn) + narrow(w_left * nw) + narrow(w_right * ne));
    const std::uint16_t half = narrow((2 * n + nw + ne) / 2);
    const std::uint16_t near = half < near_limit ? half : std::uint16_t{near_limit};
    places[x] = sum | std::uint32_t{near} << 16 | local_bin_of(narrow(others[x] / 2)) << 24;
  }
}

void fill_places(const NodeCoefficients& node, const ParentView& parent, int band, int y, Columns columns, RowContext& context) {
  const EnergyWeights& weights = energy_weights[band];
  Sums energy = context.energy.data();
  Sums others = context.others.data();
  if (parent.node) {
    set_parent(parent.node->bands[static_cast<std::size_t>(band)], parent.origin_x, parent.origin_y + y / 2, weights, columns, energy, others);
  } else {
    for (int x = columns.first; x < columns.end; ++x) energy[x] = others[x] = 0;
  }
  if (band > 0) add_beside(node.bands[0], y, weights.first, weights.first_around, columns, energy, others);
  if (band > 1) add_beside(node.bands[1], y, weights.second, weights.second_around, columns, energy, others);
  pack_places(node.bands[static_cast<std::size_t>(band)], y, weights, columns, energy, others, context.places.data());
}

HWY_INLINE std::int32_t held(std::int32_t value) { return value < -255 ? -255 : value > 255 ? 255 : value; }
HWY_INLINE std::int32_t sign(std::int32_t value) { return (value > 0) - (value < 0); }

void fill_signs(const CoefficientBlock& block, int band, int y, Columns columns, std::int32_t* HWY_RESTRICT signs) {
  const MeanWeights w = mean_weights[band];
  Values up = block.row(y - 1);
  Values up2 = block.row(y - 2);
  for (int x = columns.first; x < columns.end; ++x) {
    const std::int32_t mean = w.up * held(up[x]) + w.up2 * held(up2[x]) + w.up_left * held(up[x - 1]) + w.up_right * held(up[x + 1]);
    signs[x] = 256 * mean + 3 * (sign(up[x]) + 1) + 9 * (sign(up[x - 1]) + 1);
  }
}

void fill_row(const NodeCoefficients& node, const ParentView& parent, int band, int y, Columns columns, RowContext& context) {
  fill_places(node, parent, band, y, columns, context);
  fill_signs(node.bands[static_cast<std::size_t>(band)], band, y, columns, context.signs.data());
}

}  // namespace HWY_NAMESPACE
}  // namespace arete
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace arete {

HWY_EXPORT(fill_places);
HWY_EXPORT(fill_row);

RowContext::RowContext(int width) {
  // Columns come in pairs under the parent.
  const auto n = static_cast<std::size_t>(width + width % 2);
  places.resize(n), signs.resize(n), energy.resize(n), others.resize(n);
}

void prepare_places(const NodeCoefficients& node, const ParentView& parent, int band, int y, Columns columns, RowContext& context) {
  HWY_DYNAMIC_DISPATCH(fill_places)(node, parent, band, y, columns, context);
}

void prepare_row(const NodeCoefficients& node, const ParentView& parent, int band, int y, Columns columns, RowContext& context) {
  HWY_DYNAMIC_DISPATCH(fill_row)(node, parent, band, y, columns, context);
}

}  // namespace arete
#endif
