#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "core/amplify/coded_patches.h"

namespace arete {

/// How overlapping patches are brought together.
enum class Blending {
  mean,     ///< sum a_i f_i / sum a_i: the functional model's blend, for elevations
  variance  ///< sum a_i f_i / sqrt(sum a_i^2): keeps the variance of independent details, which a mean would blur
            ///< (Heitz & Neyret, High-performance by-example noise using a histogram-preserving blending operator, 2018)
};

/// The weights a of the finer version of a patch, f m x f m, each divided by the normaliser of the blending at its place. The normaliser
/// is periodic with the pitch, so that it depends on the place within the patch only: a blend is then a plain sum.
/// The pitch must divide the patch.
std::vector<float> blending_weights(const PatchGrid& grid, int factor, Blending blending);

/// Multiplies every atom ((f m)^2 x N) by the weights, in place.
void weigh_atoms(Eigen::MatrixXf& atoms, const std::vector<float>& weights, int threads);

/// What a patch contributes: coefficient times weighted atom, for each term of its code, and `offset` times the weights themselves.
struct PatchTerms {
  double offset = 0;
  bool known = false;
  std::int64_t count = 0;
  const std::int32_t* atoms = nullptr;
  const float* coefficients = nullptr;
};

/// Evaluates the blend on `window` (cells of the grid): out is factor times the window. `terms_of(column, row)` gives the terms of a
/// patch; offsets are blended relative to one another, so that elevations keep their digits. A block that only unknown patches
/// touch gets 0. A cell does not depend on the window.
void blend_patches(const PatchGrid& grid, int factor, const Window& window, const std::vector<float>& weights,
                   const Eigen::MatrixXf& weighted_atoms, const std::function<PatchTerms(std::int64_t, std::int64_t)>& terms_of,
                   RasterView<float> out, int threads);

}  // namespace arete
