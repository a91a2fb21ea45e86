#pragma once

#include <array>
#include <cstdint>

namespace arete {

/// How coefficients become details: a lattice point is (magnitude - shrink[min(magnitude, 3)]) x scale with its sign, 0 stays 0.
struct Dequantiser {
  std::array<float, 4> shrink{};  ///< in steps; [0] is not used
  float scale = 1;                ///< metres of a detail for each step
};

/// The details of `count` coefficients in a row; |points| < 2^31.
void dequantise_row(const Dequantiser& dequantiser, const std::int32_t* points, float* details, std::int64_t count);

}  // namespace arete
