#pragma once

#include <vector>

namespace arete {

/// A linear upsampler, exactly consistent: each fine block keeps the mean of its coarse cell, and a plane stays a plane.
/// Fine cell (px, py) of coarse cell c = z(c) + sum over taps k of weights[(py f + px) T + k] (z(c + k) - z(c)),
/// T = (2 reach + 1)^2 taps, row-major from (-reach, -reach).
struct Upsampler {
  int factor = 0;
  int reach = 0;
  std::vector<float> weights;  ///< f^2 x T
};

}  // namespace arete
