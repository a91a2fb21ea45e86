#include "gis/contour_lines.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/support/parallel.h"

namespace arete {
namespace {

constexpr Colour ink = {82, 51, 31, 255};
constexpr double opacity = 0.62, thin_px = 1.0, thick_px = 1.9;
// Of an interval: ground that is level at just a multiple has no line all over it.
constexpr double aside = 1.0 / 1024;

/// How much of a pixel the line covers where the level (1 from line to line) changes by `change` from pixel to pixel.
double line_share(double level, double change, double width_px) {
  const double apart = std::abs(level - std::round(level)) / std::max(change, 1e-9);
  const double t = std::clamp((change - 0.2) / 0.2, 0.0, 1.0);
  return std::clamp(width_px / 2 + 0.5 - apart, 0.0, 1.0) * (1 - t * t * (3 - 2 * t));
}

}  // namespace

void draw_contours(Picture& map, RasterView<const float> heights, RasterView<const std::uint8_t> bare, double interval_m,
                   int threads) {
  assert(interval_m > 0 && heights.width == bare.width && heights.height == bare.height);
  const double across = static_cast<double>(heights.width) / static_cast<double>(map.width()),
               down = static_cast<double>(heights.height) / static_cast<double>(map.height());
  parallel_for(map.height(), threads, [&](std::int64_t y) {
    const double row = (static_cast<double>(y) + 0.5) * down;
    for (std::int64_t x = 0; x < map.width(); ++x) {
      const double column = (static_cast<double>(x) + 0.5) * across;
      if (bare(std::min(static_cast<std::int64_t>(column), heights.width - 1),
               std::min(static_cast<std::int64_t>(row), heights.height - 1)) != 0)
        continue;
      const double u = std::clamp(column - 0.5, 0.0, static_cast<double>(heights.width - 1)),
                   v = std::clamp(row - 0.5, 0.0, static_cast<double>(heights.height - 1));
      const std::int64_t x0 = std::min(static_cast<std::int64_t>(u), std::max<std::int64_t>(0, heights.width - 2)),
                         x1 = std::min(x0 + 1, heights.width - 1);
      const std::int64_t y0 = std::min(static_cast<std::int64_t>(v), std::max<std::int64_t>(0, heights.height - 2)),
                         y1 = std::min(y0 + 1, heights.height - 1);
      const double a = heights(x0, y0), b = heights(x1, y0), c = heights(x0, y1), d = heights(x1, y1);
      const double s = u - static_cast<double>(x0), t = v - static_cast<double>(y0);
      const double height = (a * (1 - s) + b * s) * (1 - t) + (c * (1 - s) + d * s) * t;
      if (std::isnan(height)) continue;
      const double level = height / interval_m + aside;
      // Between the outermost centres and the border heights go on level.
      const double east = u == column - 0.5 ? ((b - a) * (1 - t) + (d - c) * t) * across : 0;
      const double south = v == row - 0.5 ? ((c - a) * (1 - s) + (d - b) * s) * down : 0;
      const double change = std::hypot(east, south) / interval_m;
      const double share = opacity * std::max(line_share(level, change, thin_px), line_share(level / 5, change / 5, thick_px));
      Colour& pixel = map(x, y);
      for (std::size_t i = 0; i < 3; ++i)
        pixel[i] = static_cast<std::uint8_t>(std::lround(pixel[i] + share * (ink[i] - pixel[i])));
    }
  });
}

}  // namespace arete
