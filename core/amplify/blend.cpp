#include "core/amplify/blend.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "core/amplify/blend_kernel.h"
#include "core/support/error.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

std::int64_t floor_div(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

/// The part of a pitch block inside a window, in coarse cells: the block begins at `begin` of the grid.
struct Span {
  std::int64_t begin, first, last;
};

Span span_of(std::int64_t block, int pitch, std::int64_t begin, std::int64_t end) {
  const std::int64_t origin = block * pitch;
  return {origin, std::max(origin, begin), std::min(origin + pitch, end)};
}

/// The terms of all patches over one pitch block, ready for the kernel.
struct BlockTerms {
  std::vector<const float*> cells;
  std::vector<float> factors;
  void clear() {
    cells.clear();
    factors.clear();
  }
  void add(const float* block, double factor) {
    cells.push_back(block);
    factors.push_back(static_cast<float>(factor));
  }
};

}  // namespace

std::vector<float> blending_weights(const PatchGrid& grid, int factor, Blending blending) {
  if (grid.patch_cells % grid.pitch != 0)
    throw Error(ErrorKind::usage, "patch pitch of " + std::to_string(grid.pitch) + " cells: expected a divisor of the patch, " +
                                      std::to_string(grid.patch_cells) + " cells");
  const int side = grid.patch_cells * factor, period = grid.pitch * factor;
  std::vector<float> weights = disc_weights(side);
  std::vector<double> sums(static_cast<std::size_t>(period * period));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto w = static_cast<double>(weights[static_cast<std::size_t>(y * side + x)]);
      sums[static_cast<std::size_t>(y % period * period + x % period)] += blending == Blending::mean ? w : w * w;
    }
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double sum = sums[static_cast<std::size_t>(y % period * period + x % period)];
      float& w = weights[static_cast<std::size_t>(y * side + x)];
      w = static_cast<float>(static_cast<double>(w) / (blending == Blending::mean ? sum : std::sqrt(sum)));
    }
  return weights;
}

void weigh_atoms(Eigen::MatrixXf& atoms, const std::vector<float>& weights, int threads) {
  assert(atoms.rows() == static_cast<Eigen::Index>(weights.size()));
  const Eigen::Map<const Eigen::ArrayXf> w(weights.data(), static_cast<Eigen::Index>(weights.size()));
  constexpr std::int64_t together = 256;
  parallel_for((atoms.cols() + together - 1) / together, threads, [&](std::int64_t chunk) {
    for (std::int64_t j = chunk * together; j < std::min<std::int64_t>(atoms.cols(), (chunk + 1) * together); ++j)
      atoms.col(j).array() *= w;
  });
}

void blend_patches(const PatchGrid& grid, int factor, const Window& window, const std::vector<float>& weights,
                   const Eigen::MatrixXf& weighted_atoms, const std::function<PatchTerms(std::int64_t, std::int64_t)>& terms_of,
                   RasterView<float> out, int threads) {
  assert(out.width == window.width * factor && out.height == window.height * factor);
  const int pitch = grid.pitch, overlap = grid.patch_cells / pitch, side = grid.patch_cells * factor;
  const std::int64_t first_row = floor_div(window.y, pitch), last_row = floor_div(window.y + window.height - 1, pitch);
  const std::int64_t first_column = floor_div(window.x, pitch), last_column = floor_div(window.x + window.width - 1, pitch);
  parallel_for(last_row - first_row + 1, threads, [&](std::int64_t r) {
    const std::int64_t block_y = first_row + r;
    const Span rows = span_of(block_y, pitch, window.y, window.y + window.height);
    BlockTerms terms;
    for (std::int64_t block_x = first_column; block_x <= last_column; ++block_x) {
      const Span columns = span_of(block_x, pitch, window.x, window.x + window.width);
      terms.clear();
      double base = 0;
      bool based = false;
      // Patch k lies over blocks k - overlap + 1 to k.
      for (int j = 0; j < overlap; ++j)
        for (int i = 0; i < overlap; ++i) {
          const PatchTerms patch = terms_of(block_x + i, block_y + j);
          if (!patch.known) continue;
          if (!based) base = patch.offset;
          based = true;
          const std::int64_t within = (rows.first - patch_origin(grid, block_y + j)) * factor * side +
                                      (columns.first - patch_origin(grid, block_x + i)) * factor;
          if (patch.offset != base) terms.add(weights.data() + within, patch.offset - base);
          for (std::int64_t t = 0; t < patch.count; ++t)
            if (patch.atoms[t] >= 0) terms.add(weighted_atoms.col(patch.atoms[t]).data() + within, static_cast<double>(patch.coefficients[t]));
        }
      // The part of the base that a float cannot hold travels with the terms.
      const auto rounded = static_cast<float>(base);
      float* to = out.row((rows.first - window.y) * factor) + (columns.first - window.x) * factor;
      blend_block(terms.cells.data(), terms.factors.data(), static_cast<std::int64_t>(terms.cells.size()), side, rounded,
                  static_cast<float>(base - static_cast<double>(rounded)), to, out.stride, (columns.last - columns.first) * factor,
                  (rows.last - rows.first) * factor);
    }
  });
}

}  // namespace arete
