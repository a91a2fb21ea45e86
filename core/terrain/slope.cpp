#include "core/terrain/slope.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/support/parallel.h"

namespace arete {
namespace {

constexpr double degrees_per_radian = 180 / std::numbers::pi;

/// The 3x3 neighbourhood, row-major from the north-west; NaN where there is no elevation.
struct Neighbourhood {
  double z[3][3];
};

Neighbourhood neighbourhood(RasterView<const float> cells, std::int64_t x, std::int64_t y) {
  Neighbourhood n;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      const bool inside = x + i >= 0 && x + i < cells.width && y + j >= 0 && y + j < cells.height;
      n.z[j + 1][i + 1] = inside ? static_cast<double>(cells(x + i, y + j)) : std::nan("");
    }
  return n;
}

/// Difference per cell along a line of three, central where possible; NaN where there is none.
double difference(double before, double middle, double after) {
  if (!std::isnan(before) && !std::isnan(after)) return (after - before) / 2;
  const double forward = after - middle;
  return std::isnan(forward) ? middle - before : forward;
}

/// The mean with weights 1, 2, 1 of those that exist; NaN when none does.
double weighted_mean(double first, double second, double third) {
  const double value[3] = {first, second, third}, weight[3] = {1, 2, 1};
  double sum = 0, total = 0;
  for (int i = 0; i < 3; ++i)
    if (!std::isnan(value[i])) {
      sum += weight[i] * value[i];
      total += weight[i];
    }
  return sum / total;
}

std::optional<Gradient> interior_gradient(RasterView<const float> cells, std::int64_t x, std::int64_t y, CellSize cell) {
  const float *n = cells.row(y - 1) + x, *c = cells.row(y) + x, *s = cells.row(y + 1) + x;
  const double nw = n[-1], nn = n[0], ne = n[1], w = c[-1], e = c[1], sw = s[-1], ss = s[0], se = s[1];
  const double east = ((ne + 2 * e + se) - (nw + 2 * w + sw)) / (8 * cell.x_m);
  const double north = ((nw + 2 * nn + ne) - (sw + 2 * ss + se)) / (8 * cell.y_m);
  if (std::isnan(east) || std::isnan(north) || is_void(c[0])) return std::nullopt;
  return Gradient{east, north};
}

}  // namespace

double slope_deg(const Gradient& gradient) { return std::atan(std::hypot(gradient.east, gradient.north)) * degrees_per_radian; }

double aspect_deg(const Gradient& gradient) {
  if (gradient.east == 0 && gradient.north == 0) return 0;
  const double angle = std::atan2(-gradient.east, -gradient.north) * degrees_per_radian;
  return angle < 0 ? angle + 360 : angle;
}

std::optional<Gradient> complete_gradient(RasterView<const float> cells, std::int64_t x, std::int64_t y, CellSize cell) {
  if (x < 1 || y < 1 || x + 1 >= cells.width || y + 1 >= cells.height) return std::nullopt;
  return interior_gradient(cells, x, y, cell);
}

std::optional<Gradient> horn_gradient(RasterView<const float> cells, std::int64_t x, std::int64_t y, CellSize cell) {
  if (const auto gradient = complete_gradient(cells, x, y, cell)) return gradient;
  if (is_void(cells(x, y))) return std::nullopt;
  const auto& z = neighbourhood(cells, x, y).z;
  const double east = weighted_mean(difference(z[0][0], z[0][1], z[0][2]), difference(z[1][0], z[1][1], z[1][2]),
                                    difference(z[2][0], z[2][1], z[2][2]));
  const double north = weighted_mean(difference(z[2][0], z[1][0], z[0][0]), difference(z[2][1], z[1][1], z[0][1]),
                                     difference(z[2][2], z[1][2], z[0][2]));
  if (std::isnan(east) || std::isnan(north)) return std::nullopt;
  return Gradient{east / cell.x_m, north / cell.y_m};
}

double exaggeration_for(double slope, double looks_like_deg, double most) {
  const double wanted = slope > 0 ? std::tan(looks_like_deg / degrees_per_radian) / slope : 1;
  double chosen = 1;
  for (const double step : {1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0})
    if (step <= std::min(wanted, most)) chosen = step;
  return chosen;
}

void slope(RasterView<const float> cells, const Window& part, CellSize cell, RasterView<float> out, int threads) {
  assert(out.size() == part.size());
  parallel_for(part.height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < part.width; ++x) {
      const auto gradient = horn_gradient(cells, part.x + x, part.y + y, cell);
      out(x, y) = gradient ? static_cast<float>(slope_deg(*gradient)) : void_value;
    }
  });
}

}  // namespace arete
