#pragma once

#include <vector>

#include "core/sparse/dictionary.h"
#include "core/support/progress.h"

namespace arete {

/// How much detail a terrain has below the cells of its area average, against the activity of that average.
struct DetailMeasure {
  double squared_detail = 0;    ///< sum over patches of the mean square of z - U(D z), under the squared disc weights
  double squared_activity = 0;  ///< sum over patches of the squared activity
  std::int64_t patches = 0;
  double power() const { return squared_activity > 0 ? squared_detail / squared_activity : 0; }
};

/// Patches needed before a measure says anything about a terrain.
inline constexpr std::int64_t least_patches_to_judge = 30;

/// Measures the detail of `fine` on patches of `patch_cells` coarse cells, half overlapping, without voids in reach of the upsampler.
DetailMeasure measure_detail(RasterView<const float> fine, const Upsampler& upsampler, int patch_cells);

/// Completes a dictionary with what consistent amplification needs: the upsampler, the detail of each atom, and the power of the detail.
/// `exemplars` are the terrains that the atoms were learned from, in the order of AtomSource::exemplar. An atom that is no real
/// patch (K-SVD) takes the detail of the real patch that correlates most with it.
///
/// The exemplar's detail is split into octaves (binomial filters), freed of what lies below the coarse Nyquist frequency, and
/// each octave is scaled so that amplifying the exemplars' own averages, with atoms from elsewhere in them, gives the target share of
/// their power: natural_share of the truth in each octave. (Exactly 1 costs RMSE for nothing that the eye sees: independent detail of
/// the full power doubles the squared error.)
void add_detail(Dictionary& dictionary, const std::vector<RasterView<const float>>& exemplars, int threads, Progress& progress);

/// Share of the true power that natural detail has, in the finest octave and in the coarser ones.
inline constexpr double natural_share_finest = 0.95;
inline constexpr double natural_share = 0.90;

}  // namespace arete
