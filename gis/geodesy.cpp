#include "gis/geodesy.h"

#include <cmath>

#include <GeographicLib/Geodesic.hpp>
#include <ogr_spatialref.h>

#include "gis/gdal_errors.h"

namespace arete {

CellSize cell_size(const GeoReference& geo, Size size) {
  if (!geo.transform) return {1, 1};
  const GdalErrors quiet;
  const auto& t = *geo.transform;
  OGRSpatialReference crs;
  const bool known = !geo.crs_wkt.empty() && crs.importFromWkt(geo.crs_wkt.c_str()) == OGRERR_NONE;
  if (known && crs.IsGeographic()) {
    const double degrees = crs.GetAngularUnits(nullptr) * 180 / M_PI;
    const double column = static_cast<double>(size.width) / 2, row = static_cast<double>(size.height) / 2;
    const double lon = (t[0] + column * t[1] + row * t[2]) * degrees, lat = (t[3] + column * t[4] + row * t[5]) * degrees;
    const double inverse_flattening = crs.GetInvFlattening();
    const GeographicLib::Geodesic ellipsoid(crs.GetSemiMajor(), inverse_flattening == 0 ? 0 : 1 / inverse_flattening);
    const auto length = [&](double dx, double dy) {
      double metres = 0;
      ellipsoid.Inverse(lat - dy / 2, lon - dx / 2, lat + dy / 2, lon + dx / 2, metres);
      return metres;
    };
    return {length(t[1] * degrees, t[4] * degrees), length(t[2] * degrees, t[5] * degrees)};
  }
  const double unit = known && crs.IsProjected() ? crs.GetLinearUnits() : 1;
  return {std::hypot(t[1], t[4]) * unit, std::hypot(t[2], t[5]) * unit};
}

}  // namespace arete
