#pragma once

#include <cmath>

namespace arete {

/// From sRGB to linear light and back, both 0 to 1 (IEC 61966-2-1).
inline double srgb_to_linear(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
inline double linear_to_srgb(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }

}  // namespace arete
