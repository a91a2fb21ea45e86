#include "core/codec/patch_weights.h"

namespace arete {

std::vector<std::int32_t> integer_disc_weights(int side) {
  std::vector<std::int32_t> weights;
  weights.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  const std::uint64_t whole = static_cast<std::uint64_t>(side) * static_cast<std::uint64_t>(side);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const std::int64_t dx = 2 * x + 1 - side, dy = 2 * y + 1 - side;
      const std::int64_t inside = static_cast<std::int64_t>(whole) - dx * dx - dy * dy;
      const auto t = static_cast<std::uint64_t>(inside > 0 ? inside : 0);
      weights.push_back(static_cast<std::int32_t>((t * t * t << 16) / (whole * whole * whole)));
    }
  return weights;
}

}  // namespace arete
