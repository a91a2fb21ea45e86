#pragma once

#include <span>

namespace arete {

/// Holds twice the area of any triangle whose corners are integers below 2^62.
__extension__ typedef __int128 Int128;

/// The sign (-1, 0, 1) of the sum of weights[i] x values[i], without any rounding: J. R. Shewchuk, "Adaptive Precision
/// Floating-Point Arithmetic and Fast Robust Geometric Predicates" (1997), GROW-EXPANSION and TWO-PRODUCT. Values are finite, their
/// products neither overflow nor fall below 2^-1000. As many weights as values, 8 at most; |weight| < 2^126.
int exact_sign(std::span<const Int128> weights, std::span<const double> values);

}  // namespace arete
