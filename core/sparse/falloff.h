#pragma once

namespace arete {

/// The weight of a disc at distance `r` from its centre, in radii: g(r) = (1 - r^2)^3 inside, 0 from r = 1 on (Wyvill, McPheeters &
/// Wyvill 1986). g and its first two derivatives vanish at r = 1; g(1/2) = 27/64.
inline double falloff(double r) {
  const double inside = 1 - r * r;
  return inside > 0 ? inside * inside * inside : 0;
}

}  // namespace arete
