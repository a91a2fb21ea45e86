#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/codec/patch_discs.h"
#include "core/codec/patch_parameters.h"
#include "core/terrain/raster.h"

namespace arete {

/// A disc as the blend takes it.
struct DiscView {
  std::int32_t mean = 0;
  std::span<const DiscTerm> terms;
};

/// Evaluates f(p) = sum a_i f_i / sum a_i at the centres of cells. The sums are of integers; what follows is one rounding after the other,
/// in double, without contraction: the same values on every machine, for any window and any number of threads.
class DiscBlend {
 public:
  explicit DiscBlend(const PatchParameters& parameters);

  /// The discs (columns and rows of the patch grid) that reach a window of a level, whose cell (x, y) is cell (2^l x, 2^l y) of the raster.
  PatchRange discs_reaching(std::int64_t begin, std::int64_t end, int level) const;

  /// f in metres on `window` of a level. `disc_at(column, row)` gives the discs.
  void evaluate(int level, const Window& window, const std::function<DiscView(std::int64_t, std::int64_t)>& disc_at, RasterView<float> out,
                int threads) const;

 private:
  struct Span;
  struct Sums;
  void add_disc(const DiscView& disc, const Span& columns, const Span& rows, std::int64_t corner, Sums& sums) const;
  float value(std::int64_t mean_sum, std::int64_t detail_sum, std::int64_t weight) const;

  const PatchAtoms& atoms_;
  int radius_;
  double base_, mean_quantum_, coefficient_quantum_;
  std::vector<std::int32_t> weights_;  // m x m
  std::vector<std::int32_t> totals_;   // R x R: the sum of the weights of the four discs over a cell
};

}  // namespace arete
