#pragma once

#include <cstdint>
#include <vector>

namespace arete {

/// The weights of a patch as integers: floor(2^16 (1 - r^2)^3), row by row, where r is the distance of the sample from the centre
/// in radii; 0 outside the disc. In integers, r^2 = (dx^2 + dy^2) / m^2 with odd dx and dy.
std::vector<std::int32_t> integer_disc_weights(int side);

}  // namespace arete
