#include "gis/crs.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "gis/gdal_errors.h"

namespace arete {
namespace {

std::string authority_of(const OGRSpatialReference& crs, const char* part) {
  const char* name = crs.GetAuthorityName(part);
  const char* code = crs.GetAuthorityCode(part);
  return name != nullptr && code != nullptr ? std::string(name) + ":" + code : "";
}

std::string text(const char* value) { return value == nullptr ? "" : value; }

}  // namespace

CrsSummary summarise_crs(const std::string& wkt) {
  const GdalErrors quiet;
  OGRSpatialReference crs;
  if (wkt.empty() || crs.importFromWkt(wkt.c_str()) != OGRERR_NONE) return {};
  CrsSummary summary;
  if (crs.IsCompound() || crs.IsVertical()) {
    summary.vertical_name = text(crs.GetAttrValue("VERT_CS"));
    summary.vertical_authority = authority_of(crs, crs.IsCompound() ? "COMPD_CS|VERT_CS" : "VERT_CS");
  }
  if (crs.IsCompound()) crs.StripVertical();
  summary.name = text(crs.GetName());
  if (authority_of(crs, nullptr).empty()) crs.AutoIdentifyEPSG();
  summary.authority = authority_of(crs, nullptr);
  summary.geographic = crs.IsGeographic() != FALSE;
  const char* unit = nullptr;
  if (summary.geographic)
    crs.GetAngularUnits(&unit);
  else
    crs.GetLinearUnits(&unit);
  summary.unit = text(unit);
  return summary;
}

std::string crs_wkt(const std::string& definition) {
  const GdalErrors errors;
  OGRSpatialReference crs;
  if (crs.SetFromUserInput(definition.c_str()) != OGRERR_NONE)
    throw Error(ErrorKind::usage, definition + ": no such coordinate reference system" + errors.suffix());
  char* wkt = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  crs.exportToWkt(&wkt, options);
  const std::string result = wkt == nullptr ? "" : wkt;
  CPLFree(wkt);
  return result;
}

std::string shorten_crs(const std::string& wkt) {
  const CrsSummary summary = summarise_crs(wkt);
  const std::string name =
      summary.vertical_authority.empty() ? summary.authority : summary.authority + "+" + summary.vertical_authority.substr(summary.vertical_authority.find(':') + 1);
  return name.rfind("EPSG:", 0) == 0 && expand_crs(name) == wkt ? name : wkt;
}

std::string expand_crs(const std::string& text) {
  if (text.rfind("EPSG:", 0) != 0) return text;
  try {
    return crs_wkt(text);
  } catch (const Error&) {
    return text;
  }
}

std::vector<std::array<double, 2>> from_longitude_latitude(std::vector<std::array<double, 2>> places, const std::string& wkt, const std::string& name) {
  const GdalErrors errors;
  OGRSpatialReference from, to;
  if (wkt.empty() || to.importFromWkt(wkt.c_str()) != OGRERR_NONE)
    throw Error(ErrorKind::input, "'" + name + "' has no CRS that is known: longitudes and latitudes cannot be placed on it");
  if (to.IsCompound()) to.StripVertical();
  from.SetWellKnownGeogCS("WGS84");
  from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  to.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> change(OGRCreateCoordinateTransformation(&from, &to));
  if (!change) throw Error(ErrorKind::input, "the CRS of '" + name + "' cannot be related to WGS 84" + errors.suffix());
  for (std::array<double, 2>& place : places)
    if (!change->Transform(1, &place[0], &place[1])) place = {std::nan(""), std::nan("")};
  return places;
}

std::optional<GeographicExtent> geographic_extent(const GeoReference& geo, Size size) {
  const GdalErrors quiet;
  OGRSpatialReference from, to;
  if (!geo.transform || geo.crs_wkt.empty() || from.importFromWkt(geo.crs_wkt.c_str()) != OGRERR_NONE) return std::nullopt;
  if (from.IsCompound()) from.StripVertical();
  if (to.SetWellKnownGeogCS("WGS84") != OGRERR_NONE) return std::nullopt;
  from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  to.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> change(OGRCreateCoordinateTransformation(&from, &to));
  if (!change) return std::nullopt;

  const auto& t = *geo.transform;
  const auto width = static_cast<double>(size.width), height = static_cast<double>(size.height);
  const auto [left, right] = std::minmax({t[0], t[0] + width * t[1], t[0] + height * t[2], t[0] + width * t[1] + height * t[2]});
  const auto [bottom, top] = std::minmax({t[3], t[3] + width * t[4], t[3] + height * t[5], t[3] + width * t[4] + height * t[5]});
  GeographicExtent extent;
  if (!change->TransformBounds(left, bottom, right, top, &extent.west, &extent.south, &extent.east, &extent.north, 20))
    return std::nullopt;
  if (!std::isfinite(extent.west + extent.south + extent.east + extent.north)) return std::nullopt;
  return extent;
}

}  // namespace arete
