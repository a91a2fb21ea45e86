#include "core/terrain/hillshade.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/support/parallel.h"
#include "core/terrain/slope.h"

namespace arete {
namespace {

struct Light {
  double east, north, up;
};

Light light_from(double azimuth_deg, double altitude_deg) {
  const double azimuth = azimuth_deg * std::numbers::pi / 180, altitude = altitude_deg * std::numbers::pi / 180;
  return {std::sin(azimuth) * std::cos(altitude), std::cos(azimuth) * std::cos(altitude), std::sin(altitude)};
}

/// The normal of z(x, y) is (-dz/dx, -dz/dy, 1), not yet of unit length.
double shade(const Light& light, const Gradient& g, double normal_length) {
  return std::max(0.0, (light.up - light.east * g.east - light.north * g.north) / normal_length);
}

double shade_all(const std::array<Light, 4>& lights, const std::array<Light, 4>& horizon, const Gradient& g) {
  const double steepness2 = g.east * g.east + g.north * g.north;
  if (steepness2 == 0) return lights[0].up;
  const double normal_length = std::sqrt(1 + steepness2);
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    // sin(aspect - azimuth) is the cross product of the two horizontal directions; the four squares add up to 2.
    const double cross = g.east * horizon[i].north - g.north * horizon[i].east;
    sum += cross * cross / steepness2 * shade(lights[i], g, normal_length);
  }
  return sum / 2;
}

}  // namespace

void hillshade(RasterView<const float> cells, const Window& part, CellSize cell, const HillshadeOptions& options,
               RasterView<float> out, int threads) {
  assert(out.size() == part.size());
  constexpr std::array<double, 4> azimuths = {225, 270, 315, 360};
  std::array<Light, 4> lights, horizon;
  for (std::size_t i = 0; i < 4; ++i) {
    lights[i] = light_from(azimuths[i], options.altitude_deg);
    horizon[i] = light_from(azimuths[i], 0);
  }
  const Light single = light_from(options.azimuth_deg.value_or(315), options.altitude_deg);
  parallel_for(part.height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < part.width; ++x) {
      if (is_void(cells(part.x + x, part.y + y))) {
        out(x, y) = void_value;
        continue;
      }
      Gradient g = horn_gradient(cells, part.x + x, part.y + y, cell).value_or(Gradient{});
      g.east *= options.exaggeration;
      g.north *= options.exaggeration;
      const double light = options.azimuth_deg ? shade(single, g, std::sqrt(1 + g.east * g.east + g.north * g.north))
                                               : shade_all(lights, horizon, g);
      out(x, y) = static_cast<float>(light);
    }
  });
}

}  // namespace arete
