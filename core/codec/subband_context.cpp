#include "core/codec/subband_context.h"

namespace arete {
namespace {

using Magnitudes = const std::uint8_t* __restrict;
using Sums = std::uint16_t* __restrict;

// A row of a block and the ones beside it; the border of zeros stands for what lies outside.
struct Rows {
  Magnitudes row, up, down;
  Rows(const CoefficientBlock& block, int y) : row(block.magnitudes(y)), up(block.magnitudes(y - 1)), down(block.magnitudes(y + 1)) {}
};

std::uint16_t narrow(int value) { return static_cast<std::uint16_t>(value); }

// The same band: up, up2, up-left, up-right.
void add_above(const CoefficientBlock& block, int y, const EnergyWeights& weights, Sums energy, Sums near) {
  Magnitudes up = block.magnitudes(y - 1);
  Magnitudes up2 = block.magnitudes(y - 2);
  for (int x = 0; x < block.width(); ++x) {
    const int n = up[x], nn = up2[x], nw = up[x - 1], ne = up[x + 1];
    energy[x] = narrow(weights.up * n + weights.up2 * nn + weights.up_left * nw + weights.up_right * ne);
    near[x] = narrow(2 * n + nw + ne);
  }
}

// Another band of the node, at the same place.
void add_beside(const CoefficientBlock& block, int y, int weight, int weight_around, int width, Sums energy, Sums cross) {
  const Rows rows(block, y);
  for (int x = 0; x < width; ++x) {
    const int here = rows.row[x];
    const int around = rows.row[x - 1] + rows.row[x + 1] + rows.up[x] + rows.down[x];
    energy[x] = narrow(energy[x] + weight * here + weight_around * around);
    cross[x] = narrow(cross[x] + 2 * here + around / 2);
  }
}

// The same band of the parent, two columns to each of its own.
void add_parent(const CoefficientBlock& block, int origin_x, int y, const EnergyWeights& weights, int width, RowContext& context, Sums cross) {
  const Rows rows(block, y);
  const int half = (width + 1) / 2;
  Sums here = context.here.data();
  Sums around = context.around.data();
  for (int x = 0; x < half; ++x) {
    const int at = origin_x + x;
    here[x] = rows.row[at];
    around[x] = narrow(rows.row[at - 1] + rows.row[at + 1] + rows.up[at] + rows.down[at]);
  }
  for (int x = 0; x < width; ++x) {
    const auto i = static_cast<std::size_t>(x);
    const int h = here[x / 2], a = around[x / 2];
    context.energy[i] = narrow(context.energy[i] + weights.parent * h + weights.parent_around * a);
    cross[x] = narrow(cross[x] + 2 * h + a / 2);
  }
}

}  // namespace

RowContext::RowContext(int width) {
  const auto n = static_cast<std::size_t>(width);
  energy.resize(n), near.resize(n), cross.resize(n);
  here.resize(n / 2 + 1), around.resize(n / 2 + 1), others.resize(n);
}

void prepare_row(const NodeCoefficients& node, const ParentView& parent, int band, int y, RowContext& context) {
  const CoefficientBlock& block = node.bands[static_cast<std::size_t>(band)];
  const int width = block.width();
  const EnergyWeights& weights = energy_weights[band];
  add_above(block, y, weights, context.energy.data(), context.near.data());
  std::fill(context.others.begin(), context.others.end(), std::uint16_t{0});
  if (band > 0) add_beside(node.bands[0], y, weights.first, weights.first_around, width, context.energy.data(), context.others.data());
  if (band > 1) add_beside(node.bands[1], y, weights.second, weights.second_around, width, context.energy.data(), context.others.data());
  if (parent.node)
    add_parent(parent.node->bands[static_cast<std::size_t>(band)], parent.origin_x, parent.origin_y + y / 2, weights, width, context,
               context.others.data());
  for (int x = 0; x < width; ++x) context.cross[static_cast<std::size_t>(x)] = static_cast<std::uint8_t>(local_bin(context.others[static_cast<std::size_t>(x)] / 2));
}

}  // namespace arete
