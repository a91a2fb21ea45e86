#pragma once

#include <cmath>
#include <cstdint>

#include <Eigen/Core>

#include "core/support/random.h"

namespace arete {

/// Independent normal values (Box & Muller 1958); the same for the same seed.
inline Eigen::MatrixXf random_matrix(std::int64_t rows, std::int64_t columns, std::uint64_t seed) {
  Eigen::MatrixXf values(rows, columns);
  for (std::int64_t j = 0; j < columns; ++j)
    for (std::int64_t i = 0; i < rows; ++i) {
      const auto x = static_cast<std::uint64_t>(i), y = static_cast<std::uint64_t>(j);
      const double radius = std::sqrt(-2 * std::log(1 - uniform_at(seed, x, y, 0)));
      values(i, j) = static_cast<float>(radius * std::cos(6.283185307179586 * uniform_at(seed, x, y, 1)));
    }
  return values;
}

inline Eigen::MatrixXf random_dictionary(std::int64_t samples, std::int64_t atoms, std::uint64_t seed) {
  return random_matrix(samples, atoms, seed).colwise().normalized();
}

}  // namespace arete
