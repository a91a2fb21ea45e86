#include "core/terrain/sky_light.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/support/parallel.h"

namespace arete {
namespace {

struct ProfilePoint {
  double along, height;
};

double rise(const ProfilePoint& from, const ProfilePoint& to) { return (to.height - from.height) / (from.along - to.along); }

/// Parallel rays over the raster: along the major axis one cell per step, along the minor axis `shift` cells.
struct Rays {
  bool by_columns;      // the major axis is x
  bool forward;         // the horizon lies towards growing major coordinates
  std::int64_t length;  // cells along the major axis
  std::int64_t breadth; // along the minor one
  double shift;         // minor cells per major step
  double step_m;        // ground length of a step
};

Rays plan_rays(Size size, CellSize cell, double azimuth_deg) {
  const double azimuth = azimuth_deg * M_PI / 180;
  const double columns = std::sin(azimuth) / cell.x_m, rows = -std::cos(azimuth) / cell.y_m;
  const bool by_columns = std::abs(columns) >= std::abs(rows);
  const double major = by_columns ? columns : rows, minor = by_columns ? rows : columns;
  return {by_columns, major > 0, by_columns ? size.width : size.height, by_columns ? size.height : size.width, minor / major,
          1 / std::abs(major)};
}

/// The ray whose minor coordinate is `start` where the major one is 0, walked from the far end of its direction.
void scan_ray(RasterView<const float> elevation, const Rays& rays, std::int64_t start, std::vector<ProfilePoint>& hull, RasterView<float> out) {
  hull.clear();
  const auto last = static_cast<double>(rays.breadth - 1);
  const auto at = [&](std::int64_t major, std::int64_t minor) {
    return static_cast<double>(rays.by_columns ? elevation(major, minor) : elevation(minor, major));
  };
  for (std::int64_t i = 0; i < rays.length; ++i) {
    const std::int64_t major = rays.forward ? rays.length - 1 - i : i;
    const double shift = rays.shift * static_cast<double>(major), minor = static_cast<double>(start) + shift;
    const std::int64_t cell = start + std::llround(shift);
    if (cell < 0 || cell >= rays.breadth) continue;
    const double inside = std::clamp(minor, 0.0, last);
    const auto below = std::min(static_cast<std::int64_t>(inside), std::max<std::int64_t>(0, rays.breadth - 2));
    const double t = inside - static_cast<double>(below);
    const double height = t > 0 ? (1 - t) * at(major, below) + t * at(major, below + 1) : at(major, below);
    const ProfilePoint here{static_cast<double>(i) * rays.step_m, height};
    while (hull.size() > 1 && rise(here, hull[hull.size() - 2]) >= rise(here, hull.back())) hull.pop_back();
    const float tangent = hull.empty() ? 0.0f : static_cast<float>(std::max(0.0, rise(here, hull.back())));
    (rays.by_columns ? out(major, cell) : out(cell, major)) = tangent;
    hull.push_back(here);
  }
}

}  // namespace

Raster<float> horizon(RasterView<const float> elevation, CellSize cell, double azimuth_deg, int threads) {
  const Rays rays = plan_rays(elevation.size(), cell, azimuth_deg);
  Raster<float> out(elevation.width, elevation.height);
  // Each cell belongs to exactly one ray: on every step the rays are whole cells apart.
  const std::int64_t end = std::llround(rays.shift * static_cast<double>(rays.length - 1));
  const std::int64_t first = std::min<std::int64_t>(0, -end), count = rays.breadth + std::abs(end);
  constexpr std::int64_t part = 64;
  parallel_for((count + part - 1) / part, threads, [&](std::int64_t p) {
    std::vector<ProfilePoint> hull;
    for (std::int64_t i = p * part; i < std::min(count, (p + 1) * part); ++i) scan_ray(elevation, rays, first + i, hull, out.view());
  });
  return out;
}

SkyLight measure_sky_light(RasterView<const float> elevation, CellSize cell, const SkyLightOptions& options) {
  // Exaggerated heights are heights over a ground as many times smaller.
  const CellSize ground{cell.x_m / options.exaggeration, cell.y_m / options.exaggeration};
  SkyLight light{Raster<float>(elevation.width, elevation.height, 0.0f), horizon(elevation, ground, options.sun_azimuth_deg, options.threads)};
  const std::int64_t cells = elevation.size().cells();
  for (int d = 0; d < options.directions; ++d) {
    const Raster<float> tangent = horizon(elevation, ground, 360.0 * d / options.directions, options.threads);
    for (std::int64_t i = 0; i < cells; ++i) light.sky.data()[i] += 1 / (1 + tangent.data()[i] * tangent.data()[i]);
  }
  const double low = options.sun_elevation_deg - options.sun_width_deg / 2;
  for (std::int64_t i = 0; i < cells; ++i) {
    light.sky.data()[i] /= static_cast<float>(options.directions);
    const double hidden = std::clamp((std::atan(light.sun.data()[i]) * 180 / M_PI - low) / options.sun_width_deg, 0.0, 1.0);
    light.sun.data()[i] = static_cast<float>(1 - hidden * hidden * (3 - 2 * hidden));
  }
  return light;
}

}  // namespace arete
