#include "core/terrain/surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace arete {
namespace {

constexpr std::int64_t tile_side = 256;
constexpr std::int64_t margin = 2;  // of the interpolation's neighbours

// Keys's cubic for the four samples around, and its derivative; t from the second sample.
std::array<double, 4> weights(double t) {
  return {((-0.5 * t + 1) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1, ((-1.5 * t + 2) * t + 0.5) * t, (0.5 * t - 0.5) * t * t};
}
std::array<double, 4> slopes(double t) {
  return {(-1.5 * t + 2) * t - 0.5, (4.5 * t - 5) * t, (-4.5 * t + 4) * t + 0.5, (1.5 * t - 1) * t};
}

}  // namespace

const SurfaceSampler::Tile& SurfaceSampler::tile_of(std::int64_t column, std::int64_t row) {
  const Size size = source_.size();
  const std::int64_t wide = (size.width + tile_side - 1) / tile_side;
  const std::int64_t x = column / tile_side, y = row / tile_side, number = y * wide + x;
  if (const auto found = by_number_.find(number); found != by_number_.end()) {
    tiles_.splice(tiles_.begin(), tiles_, found->second);
    return tiles_.front();
  }
  const std::int64_t x0 = std::max<std::int64_t>(0, x * tile_side - margin), x1 = std::min(size.width, (x + 1) * tile_side + margin);
  const std::int64_t y0 = std::max<std::int64_t>(0, y * tile_side - margin), y1 = std::min(size.height, (y + 1) * tile_side + margin);
  Tile tile{number, {x0, y0, x1 - x0, y1 - y0}, Raster<float>(x1 - x0, y1 - y0)};
  source_.read(tile.window, tile.cells.view());
  if (tiles_.size() >= kept_tiles_) {
    by_number_.erase(tiles_.back().number);
    tiles_.pop_back();
  }
  tiles_.push_front(std::move(tile));
  by_number_[number] = tiles_.begin();
  return tiles_.front();
}

SurfacePoint SurfaceSampler::at(double x, double y) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const Size size = source_.size();
  if (!(x >= 0 && y >= 0 && x <= static_cast<double>(size.width) && y <= static_cast<double>(size.height))) return {none, none, none};
  const std::int64_t column = std::min(static_cast<std::int64_t>(x), size.width - 1), row = std::min(static_cast<std::int64_t>(y), size.height - 1);
  const Tile& tile = tile_of(column, row);
  const float own = tile.cells(column - tile.window.x, row - tile.window.y);
  if (is_void(own)) return {none, none, none};
  const double fx = std::floor(x - 0.5), fy = std::floor(y - 0.5);
  const std::array<double, 4> wx = weights(x - 0.5 - fx), wy = weights(y - 0.5 - fy), sx = slopes(x - 0.5 - fx), sy = slopes(y - 0.5 - fy);
  SurfacePoint point;
  for (std::size_t j = 0; j < 4; ++j)
    for (std::size_t i = 0; i < 4; ++i) {
      const std::int64_t cx = std::clamp<std::int64_t>(static_cast<std::int64_t>(fx) - 1 + static_cast<std::int64_t>(i), 0, size.width - 1);
      const std::int64_t cy = std::clamp<std::int64_t>(static_cast<std::int64_t>(fy) - 1 + static_cast<std::int64_t>(j), 0, size.height - 1);
      const float cell = tile.cells(cx - tile.window.x, cy - tile.window.y);
      // Relative to the point's own cell, so that a constant stays one to the last bit.
      const double value = is_void(cell) ? 0 : static_cast<double>(cell) - static_cast<double>(own);
      point.elevation_m += wx[i] * wy[j] * value;
      point.per_cell_x += sx[i] * wy[j] * value;
      point.per_cell_y += wx[i] * sy[j] * value;
    }
  point.elevation_m += static_cast<double>(own);
  return point;
}

}  // namespace arete
