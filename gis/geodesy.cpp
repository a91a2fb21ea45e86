#include "gis/geodesy.h"

#include <cmath>
#include <optional>

#include <GeographicLib/Geodesic.hpp>
#include <ogr_spatialref.h>

#include "gis/gdal_errors.h"

namespace arete {
namespace {

/// How places of a CRS are measured.
struct Ground {
  double metres = 1;   // per unit of x and y, where there is no ellipsoid
  double degrees = 1;  // per unit, on the ellipsoid
  std::optional<GeographicLib::Geodesic> ellipsoid;

  double distance(double x, double y, double to_x, double to_y) const {
    if (!ellipsoid) return std::hypot(to_x - x, to_y - y) * metres;
    double length = 0;
    ellipsoid->Inverse(y * degrees, x * degrees, to_y * degrees, to_x * degrees, length);
    return length;
  }
};

Ground ground_of(const GeoReference& geo) {
  const GdalErrors quiet;
  OGRSpatialReference crs;
  if (!geo.transform || geo.crs_wkt.empty() || crs.importFromWkt(geo.crs_wkt.c_str()) != OGRERR_NONE) return {};
  if (crs.IsGeographic()) {
    const double inverse_flattening = crs.GetInvFlattening();
    return {1, crs.GetAngularUnits(nullptr) * 180 / M_PI, GeographicLib::Geodesic(crs.GetSemiMajor(), inverse_flattening == 0 ? 0 : 1 / inverse_flattening)};
  }
  return {crs.IsProjected() ? crs.GetLinearUnits() : 1, 1, std::nullopt};
}

}  // namespace

CellSize cell_size(const GeoReference& geo, Size size) {
  if (!geo.transform) return {1, 1};
  const auto& t = *geo.transform;
  const double column = static_cast<double>(size.width) / 2, row = static_cast<double>(size.height) / 2;
  const Ground ground = ground_of(geo);
  if (!ground.ellipsoid) return {std::hypot(t[1], t[4]) * ground.metres, std::hypot(t[2], t[5]) * ground.metres};
  const double x = t[0] + column * t[1] + row * t[2], y = t[3] + column * t[4] + row * t[5];
  const auto length = [&](double dx, double dy) { return ground.distance(x - dx / 2, y - dy / 2, x + dx / 2, y + dy / 2); };
  return {length(t[1], t[4]), length(t[2], t[5])};
}

std::vector<double> distances_along(const GeoReference& geo, const std::vector<std::array<double, 2>>& places) {
  const Ground ground = ground_of(geo);
  std::vector<double> distances(places.size(), 0.0);
  for (std::size_t i = 1; i < places.size(); ++i) {
    const auto &from = places[i - 1], &to = places[i];
    distances[i] = distances[i - 1] + ground.distance(from[0], from[1], to[0], to[1]);
  }
  return distances;
}

}  // namespace arete
