#include "core/amplify/upsampler.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/Dense>

#include "core/amplify/upsample_kernel.h"
#include "core/support/parallel.h"
#include "core/terrain/extend.h"
#include "core/terrain/resample.h"

namespace arete {
namespace {

constexpr double ridge = 1e-5;  // of the mean of the diagonal
constexpr std::int64_t batch = 512;

/// Normal equations: A = X X^T, B = X Y^T over cells.
struct Moments {
  Eigen::MatrixXd a, b;
  std::int64_t cells = 0;
};

/// A cell with its whole neighbourhood valid: differences of the taps, deviations of the block. False where anything is void.
bool sample_cell(RasterView<const float> fine, RasterView<const float> coarse, std::int64_t x, std::int64_t y, int factor, int reach,
                 float* taps, float* block) {
  const float centre = coarse(x, y);
  bool valid = !is_void(centre);
  for (std::int64_t j = -reach; j <= reach; ++j)
    for (std::int64_t i = -reach; i <= reach; ++i) {
      *taps = coarse(x + i, y + j) - centre;
      valid &= !is_void(*taps++);
    }
  if (!valid) return false;
  double sum = 0;
  for (int j = 0; j < factor; ++j)
    for (int i = 0; i < factor; ++i) sum += static_cast<double>(fine(x * factor + i, y * factor + j));
  const double mean = sum / (factor * factor);
  for (int j = 0; j < factor; ++j)
    for (int i = 0; i < factor; ++i) *block++ = static_cast<float>(static_cast<double>(fine(x * factor + i, y * factor + j)) - mean);
  return true;
}

std::int64_t row_step(Size coarse) { return std::max<std::int64_t>(1, coarse.cells() / most_training_cells); }

double mean_energy(RasterView<const float> fine, RasterView<const float> coarse, int factor, int reach) {
  const int side = 2 * reach + 1;
  std::vector<float> taps(static_cast<std::size_t>(side * side)), block(static_cast<std::size_t>(factor * factor));
  double sum = 0;
  std::int64_t cells = 0;
  for (std::int64_t y = reach; y + reach < coarse.height; y += 4 * row_step(coarse.size()))
    for (std::int64_t x = reach; x + reach < coarse.width; x += 4) {
      if (!sample_cell(fine, coarse, x, y, factor, reach, taps.data(), block.data())) continue;
      for (const float t : taps) sum += static_cast<double>(t) * t;
      ++cells;
    }
  return cells == 0 ? 0 : sum / static_cast<double>(cells);
}

/// Rows of cells into normal equations, in batches; double sums of float products in a fixed order.
void accumulate(RasterView<const float> fine, int factor, int reach, Moments& moments) {
  const Raster<float> coarse = area_average(fine, factor);
  const double typical = mean_energy(fine, coarse.view(), factor, reach);
  if (typical <= 0) return;
  const int side = 2 * reach + 1;
  Eigen::MatrixXf X(side * side, batch), Y(factor * factor, batch);
  std::int64_t filled = 0;
  const auto flush = [&] {
    moments.a += (X.leftCols(filled) * X.leftCols(filled).transpose()).cast<double>();
    moments.b += (X.leftCols(filled) * Y.leftCols(filled).transpose()).cast<double>();
    moments.cells += filled;
    filled = 0;
  };
  for (std::int64_t y = reach; y + reach < coarse.height(); y += row_step(coarse.size()))
    for (std::int64_t x = reach; x + reach < coarse.width(); ++x) {
      if (!sample_cell(fine, coarse.view(), x, y, factor, reach, X.col(filled).data(), Y.col(filled).data())) continue;
      const float weight = 1 / std::sqrt(X.col(filled).squaredNorm() + static_cast<float>(typical));
      X.col(filled) *= weight;
      Y.col(filled) *= weight;
      if (++filled == batch) flush();
    }
  flush();
}

/// Index map of one of the 8 symmetries on a square of `side` cells.
std::vector<int> symmetric_indices(int side, int symmetry) {
  std::vector<int> index;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      int i = symmetry & 1 ? side - 1 - x : x, j = symmetry & 2 ? side - 1 - y : y;
      if (symmetry & 4) std::swap(i, j);
      index.push_back(j * side + i);
    }
  return index;
}

/// The moments of the same cells in all 8 symmetries.
Moments symmetrise(const Moments& one, int factor, int reach) {
  Moments all{Eigen::MatrixXd::Zero(one.a.rows(), one.a.cols()), Eigen::MatrixXd::Zero(one.b.rows(), one.b.cols()), one.cells};
  for (int s = 0; s < 8; ++s) {
    const std::vector<int> taps = symmetric_indices(2 * reach + 1, s), cells = symmetric_indices(factor, s);
    all.a += one.a(taps, taps) / 8;
    all.b += one.b(taps, cells) / 8;
  }
  return all;
}

/// min ||Y - W^T X||^2 + ridge ||W||^2 under C^T W = G: planes are exact (Lagrange multipliers).
Eigen::MatrixXd solve_exact_on_planes(const Moments& moments, int factor, int reach) {
  const int side = 2 * reach + 1, taps = side * side;
  Eigen::MatrixXd C(taps, 2), G(2, factor * factor);
  for (int k = 0; k < taps; ++k) C.row(k) << k % side - reach, k / side - reach;
  for (int p = 0; p < factor * factor; ++p)
    G.col(p) << (p % factor + 0.5) / factor - 0.5, (p / factor + 0.5) / factor - 0.5;
  const double scale = moments.a.trace() / taps;
  const Eigen::MatrixXd A = moments.a + (scale > 0 ? ridge * scale : 1.0) * Eigen::MatrixXd::Identity(taps, taps);
  const Eigen::LDLT<Eigen::MatrixXd> factorised(A);
  const Eigen::MatrixXd free = factorised.solve(moments.b), lift = factorised.solve(C);
  Eigen::MatrixXd W = free + lift * (C.transpose() * lift).ldlt().solve(G - C.transpose() * free);
  const Eigen::VectorXd block_mean = W.rowwise().mean();
  return W.colwise() - block_mean;
}

}  // namespace

Upsampler train_upsampler(const std::vector<RasterView<const float>>& terrains, int factor, int reach) {
  const int taps = (2 * reach + 1) * (2 * reach + 1);
  const auto none = [&] { return Moments{Eigen::MatrixXd::Zero(taps, taps), Eigen::MatrixXd::Zero(taps, factor * factor), 0}; };
  Moments moments = none();
  for (const RasterView<const float>& terrain : terrains) accumulate(terrain, factor, reach, moments);
  if (moments.cells < 4 * taps) moments = none();
  const Eigen::MatrixXd W = solve_exact_on_planes(symmetrise(moments, factor, reach), factor, reach);
  Upsampler upsampler{factor, reach, {}};
  for (int p = 0; p < factor * factor; ++p)
    for (int k = 0; k < taps; ++k) upsampler.weights.push_back(static_cast<float>(W(k, p)));
  return upsampler;
}

void upsample(const Upsampler& upsampler, RasterView<const float> coarse, RasterView<const float> detail_mean, RasterView<float> fine,
              int threads) {
  const int f = upsampler.factor, r = upsampler.reach, side = upsampler.side();
  const std::int64_t w = coarse.width - 2 * r, h = coarse.height - 2 * r;
  assert(fine.width == w * f && fine.height == h * f);
  const std::int64_t stride = (w + 15) / 16 * 16, padded = stride + 2 * r + 16;
  constexpr std::int64_t rows_together = 16;
  parallel_for((h + rows_together - 1) / rows_together, threads, [&](std::int64_t band) {
    const std::int64_t first = band * rows_together, last = std::min(h, first + rows_together);
    // Rows padded to whole vectors: the tail computes cells that no one reads.
    const auto pad = [&](RasterView<const float> from) {
      std::vector<float> rows(static_cast<std::size_t>((last - first + 2 * r) * padded), 0.0f);
      for (std::int64_t y = 0; y < last - first + 2 * r; ++y)
        std::copy_n(from.row(first + y), from.width, rows.begin() + y * padded);
      return rows;
    };
    const std::vector<float> z = pad(coarse);
    const std::vector<float> e = detail_mean.data ? pad(detail_mean) : std::vector<float>{};
    std::vector<float> sums(static_cast<std::size_t>(f * f * stride));
    std::vector<const float*> z_rows(static_cast<std::size_t>(side)), e_rows(z_rows.size());
    for (std::int64_t y = first; y < last; ++y) {
      for (int k = 0; k < side; ++k) {
        z_rows[static_cast<std::size_t>(k)] = z.data() + (y - first + k) * padded;
        if (!e.empty()) e_rows[static_cast<std::size_t>(k)] = e.data() + (y - first + k) * padded;
      }
      sum_taps(z_rows.data(), e.empty() ? nullptr : e_rows.data(), r, upsampler.weights.data(), f * f, w, sums.data(), stride);
      const float* centre = coarse.row(y + r) + r;
      const float* mean = detail_mean.data ? detail_mean.row(y + r) + r : nullptr;
      for (int py = 0; py < f; ++py)
        place_phases(centre, mean, sums.data() + py * f * stride, stride, f, w, fine.row(y * f + py));
    }
  });
}

Raster<float> upsample_whole(const Upsampler& upsampler, RasterView<const float> coarse, int threads) {
  const int r = upsampler.reach, f = upsampler.factor;
  Raster<float> known(coarse.width + 4 * r, coarse.height + 4 * r, void_value);
  for (std::int64_t y = 0; y < coarse.height; ++y)
    for (std::int64_t x = 0; x < coarse.width; ++x) known(x + 2 * r, y + 2 * r) = coarse(x, y);
  Raster<float> extended(known.width(), known.height());
  extend_into_voids(known.view(), r, extended.view());
  Raster<float> fine(coarse.width * f, coarse.height * f);
  const RasterView<const float> with_margin = std::as_const(extended).view().sub({r, r, coarse.width + 2 * r, coarse.height + 2 * r});
  upsample(upsampler, with_margin, {}, fine.view(), threads);
  for (std::int64_t y = 0; y < fine.height(); ++y)
    for (std::int64_t x = 0; x < fine.width(); ++x)
      if (is_void(coarse(x / f, y / f))) fine(x, y) = void_value;
  return fine;
}

}  // namespace arete
