#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/terrain/georeference.h"

namespace arete {

/// A coordinate reference system in words. Empty strings where unknown.
struct CrsSummary {
  std::string name;                ///< "WGS 84 / UTM zone 32N"; without the vertical part
  std::string authority;           ///< "EPSG:32632"
  std::string unit;                ///< of the horizontal coordinates: "degree", "metre"
  std::string vertical_name;       ///< "EGM96 height"
  std::string vertical_authority;  ///< "EPSG:5773"
  bool geographic = false;         ///< coordinates are longitude and latitude
};

/// Empty for an empty or unreadable WKT.
CrsSummary summarise_crs(const std::string& wkt);

/// WKT2 of what a user calls a CRS: "EPSG:32632", WKT, a PROJ string. Throws Error{usage} where no such CRS is known.
std::string crs_wkt(const std::string& definition);

/// The shortest text from which expand_crs makes the same WKT, letter for letter: "EPSG:32632", or the WKT itself.
std::string shorten_crs(const std::string& wkt);
/// The inverse. What names no known CRS comes back as it is.
std::string expand_crs(const std::string& text);

/// Places given as longitude and latitude in degrees on WGS 84, in the coordinates of a CRS (east, north). Throws Error{input} where
/// the CRS is unknown or cannot be related to WGS 84, `name` being the raster; a place without image is NaN.
std::vector<std::array<double, 2>> from_longitude_latitude(std::vector<std::array<double, 2>> places, const std::string& wkt, const std::string& name);

/// Longitudes and latitudes in degrees on WGS 84. West is larger than east where the antimeridian lies between.
struct GeographicExtent {
  double west = 0, south = 0, east = 0, north = 0;
};

/// What a raster covers, its border followed with 20 points on each side. Nullopt where it has no transform or no CRS, or where
/// the CRS cannot be related to WGS 84.
std::optional<GeographicExtent> geographic_extent(const GeoReference& geo, Size size);

}  // namespace arete
