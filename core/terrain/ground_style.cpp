#include "core/terrain/ground_style.h"

#include <cmath>
#include <initializer_list>

namespace arete {

double contour_interval(double relief_m) {
  if (!(relief_m > 0) || !std::isfinite(relief_m)) return 1;
  const double wanted = relief_m / 24, power = std::pow(10, std::floor(std::log10(wanted)));
  const double digit = wanted / power;
  // Half way between two of them by ratio.
  return power * (digit < std::sqrt(2) ? 1 : digit < std::sqrt(10) ? 2 : digit < std::sqrt(50) ? 5 : 10);
}

GroundStyle settle(GroundStyle style, double relief_m) {
  if (style.contour_interval_m < 0) style.contour_interval_m = contour_interval(relief_m);
  return style;
}

double slope_scale_deg(double steep_deg) {
  for (const double end : {2.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 75.0})
    if (steep_deg <= end) return end;
  return 90;
}

}  // namespace arete
