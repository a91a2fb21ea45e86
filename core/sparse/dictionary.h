#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/amplify/upsampler.h"

namespace arete {

/// Where an atom was cut from.
struct AtomSource {
  std::int32_t exemplar = -1;  ///< index into Dictionary::exemplars; -1 for an atom that is no real patch (K-SVD)
  std::int64_t x = 0;          ///< first column and row of the patch in the exemplar's low-resolution grid
  std::int64_t y = 0;
  std::uint8_t symmetry = 0;   ///< which of the 8 rotations and mirrors: bit 0 flips x, bit 1 flips y, bit 2 transposes (first)
};

enum class LearningMethod : std::uint8_t { all = 0, ksvd = 1, constrained = 2 };

/// Atoms of terrain at one or two resolutions.
///
/// A patch is m x m samples (m even), row-major, minus its plain mean, times the disc weight of PatchGrid. `low` holds such
/// patches as unit columns. With a factor f >= 2, column j of `high` is the same piece of ground f times finer,
/// (f m) x (f m) samples minus the mean of the low patch, NOT weighted, divided by the norm of the *low* patch: the
/// same coefficients rebuild both. Column j of `detail` is what the linear upsampler cannot know of that ground: the exemplar minus the
/// upsampling of its own area average, filtered so that its spectrum continues the input's, scaled to a mean square of 1 under the
/// squared disc weights; `detail_power` and the activity of the patch give its variance.
struct Dictionary {
  LearningMethod method = LearningMethod::all;
  int patch_cells = 8;            ///< m, of the low-resolution grid
  int factor = 1;                 ///< f; 1 for a dictionary of one resolution
  double cell_size_m = 0;         ///< of the low-resolution grid, where known; else 0
  Eigen::MatrixXf low;            ///< m^2 x N, unit columns
  Eigen::MatrixXf high;           ///< (f m)^2 x N, or empty
  Eigen::MatrixXf detail;         ///< (f m)^2 x N, or empty
  std::vector<AtomSource> sources;      ///< N
  std::vector<std::string> exemplars;   ///< names of the files that the atoms come from
  std::optional<Upsampler> upsampler;
  double detail_power = 0;         ///< variance of the detail at activity 1 (core/amplify/activity.h)
  double coarse_detail_power = 0;  ///< the same, measured one factor coarser, on the exemplars' low-resolution versions; 0 if too small
  std::string provenance;         ///< how it was made: the command, as text
  std::int64_t atoms() const { return low.cols(); }
};

}  // namespace arete
