#include "gis/page_heights.h"

#include <algorithm>
#include <cmath>

#include "core/support/deflate.h"

namespace arete {
namespace {

constexpr double wanted_steps = 16384;

/// The least of 1, 2 and 5 times a power of ten that is not below `value`, but for rounding.
double round_up(double value) {
  const int exponent = static_cast<int>(std::floor(std::log10(value)));
  const double power = std::pow(10.0, std::abs(exponent));
  for (const double digit : {1.0, 2.0, 5.0, 10.0}) {
    const double step = exponent < 0 ? digit / power : digit * power;  // 2 / 10 is the double next to 0.2
    if (step >= value * (1 - 1e-9)) return step;
  }
  return 10 * value;
}

}  // namespace

PageHeights quantise_heights(RasterView<const float> cells) {
  PageHeights heights;
  heights.size = cells.size();
  double low = INFINITY, high = -INFINITY;
  for (std::int64_t y = 0; y < cells.height; ++y)
    for (std::int64_t x = 0; x < cells.width; ++x)
      if (const auto z = static_cast<double>(cells(x, y)); !is_void(cells(x, y))) low = std::min(low, z), high = std::max(high, z);
  if (low <= high) heights.low_m = low;
  if (low < high) heights.step_m = round_up((high - low) / wanted_steps);
  const double step = heights.step_m, below = step > 0 ? std::floor(low / step) : 0;
  if (step > 0) heights.low_m = below * step;
  heights.steps.reserve(static_cast<std::size_t>(cells.size().cells()));
  for (std::int64_t y = 0; y < cells.height; ++y)
    for (std::int64_t x = 0; x < cells.width; ++x) {
      if (is_void(cells(x, y)))
        heights.steps.push_back(PageHeights::void_step);
      else
        heights.steps.push_back(step > 0 ? static_cast<std::uint16_t>(std::round(static_cast<double>(cells(x, y)) / step) - below) : 0);
    }
  return heights;
}

std::vector<std::byte> pack_heights(const PageHeights& heights) {
  const auto width = static_cast<std::size_t>(heights.size.width), count = heights.steps.size();
  std::vector<std::int32_t> known(count);
  std::vector<std::byte> bytes(2 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const bool west = i % width > 0, north = i >= width;
    std::int32_t foretold = (west ? known[i - 1] : 0) + (north ? known[i - width] : 0) - (west && north ? known[i - width - 1] : 0);
    foretold = std::clamp<std::int32_t>(foretold, 0, PageHeights::max_step);
    const bool is_known = heights.steps[i] != PageHeights::void_step;
    known[i] = is_known ? heights.steps[i] : foretold;
    const std::int32_t rest = known[i] - foretold, code = !is_known ? 0 : rest >= 0 ? 1 + 2 * rest : -2 * rest;
    bytes[i] = static_cast<std::byte>(code & 255);
    bytes[count + i] = static_cast<std::byte>(code >> 8);
  }
  return deflate_bytes(bytes);
}

}  // namespace arete
