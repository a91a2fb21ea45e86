#pragma once

#include <cmath>

namespace arete {

/// The multiple of the step nearest to an elevation; the greatest not above it; the least not below it.
inline double round_height(double z, double step) { return std::nearbyint(z / step) * step; }
inline double floor_height(double z, double step) { return std::floor(z / step) * step; }
inline double ceil_height(double z, double step) { return std::ceil(z / step) * step; }

}  // namespace arete
