#include "gis/alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "gis/gdal_errors.h"

namespace arete {
namespace {

constexpr double tolerance_cells = 1e-6;

std::string crs_name(const std::string& wkt) {
  if (wkt.empty()) return "no CRS";
  OGRSpatialReference crs;
  if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE) return "an unreadable CRS";
  const char* name = crs.GetName();
  return name != nullptr ? name : "a CRS without a name";
}

std::string describe(const Placed& raster) {
  char text[256];
  std::snprintf(text, sizeof text, "%lld x %lld cells", static_cast<long long>(raster.size.width),
                static_cast<long long>(raster.size.height));
  std::string line = "'" + raster.name + "' (" + text;
  if (raster.geo.transform) {
    const auto& t = *raster.geo.transform;
    std::snprintf(text, sizeof text, " of %.10g x %.10g from (%.10g, %.10g)", t[1], t[5], t[0], t[3]);
    line += text;
  } else {
    line += " without georeference";
  }
  return line + ", " + crs_name(raster.geo.crs_wkt) + ")";
}

[[noreturn]] void refuse(const Placed& reference, const Placed& result, const std::string& why) {
  throw Error(ErrorKind::input, "cannot compare " + describe(reference) + " with " + describe(result) + ": " + why +
                                    "; give --resample to bring the result onto the grid of the reference");
}

/// Cells of the reference at column and row (x, y) of the result.
std::array<double, 2> to_reference_cells(const std::array<double, 6>& reference, const std::array<double, 6>& result, double x,
                                         double y) {
  // Differences of origins first: coordinates are large, cells are small.
  const double dx = result[0] - reference[0] + x * result[1] + y * result[2];
  const double dy = result[3] - reference[3] + x * result[4] + y * result[5];
  const double determinant = reference[1] * reference[5] - reference[2] * reference[4];
  return {(dx * reference[5] - dy * reference[2]) / determinant, (dy * reference[1] - dx * reference[4]) / determinant};
}

/// Whole cells from the reference's origin to that of the result; nullopt where the lattices differ.
std::optional<std::array<std::int64_t, 2>> lattice_offset(const Placed& reference, const Placed& result) {
  const auto &a = *reference.geo.transform, &b = *result.geo.transform;
  const auto origin = to_reference_cells(a, b, 0, 0);
  const std::array<double, 2> whole = {std::round(origin[0]), std::round(origin[1])};
  const double width = static_cast<double>(result.size.width), height = static_cast<double>(result.size.height);
  for (const auto& [x, y] : {std::array<double, 2>{0, 0}, {width, 0}, {0, height}, {width, height}}) {
    const auto cell = to_reference_cells(a, b, x, y);
    if (!(std::abs(cell[0] - x - whole[0]) <= tolerance_cells && std::abs(cell[1] - y - whole[1]) <= tolerance_cells))
      return std::nullopt;
  }
  return std::array<std::int64_t, 2>{static_cast<std::int64_t>(whole[0]), static_cast<std::int64_t>(whole[1])};
}

std::string size_text(Size size) { return std::to_string(size.width) + " x " + std::to_string(size.height); }

}  // namespace

bool same_horizontal_crs(const std::string& a, const std::string& b) {
  const GdalErrors quiet;
  OGRSpatialReference first, second;
  if (first.importFromWkt(a.c_str()) != OGRERR_NONE || second.importFromWkt(b.c_str()) != OGRERR_NONE) return a == b;
  first.StripVertical();
  second.StripVertical();
  const char* const options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES", "CRITERION=EQUIVALENT", nullptr};
  return first.IsSame(&second, options) != FALSE;
}

Alignment align_grids(const Placed& reference, const Placed& result) {
  Alignment alignment{{0, 0, reference.size.width, reference.size.height}, {0, 0, result.size.width, result.size.height}, {}};
  const bool known_reference = !reference.geo.crs_wkt.empty(), known_result = !result.geo.crs_wkt.empty();
  if (known_reference && known_result && !same_horizontal_crs(reference.geo.crs_wkt, result.geo.crs_wkt))
    refuse(reference, result, "the CRS differ");
  if (!reference.geo.transform || !result.geo.transform) {
    if (reference.size != result.size) refuse(reference, result, "without a georeference both must have the same size");
    alignment.notes.push_back("'" + (result.geo.transform ? reference : result).name +
                              "' has no georeference: compared cell on cell");
    return alignment;
  }
  if (known_reference != known_result)
    alignment.notes.push_back("'" + (known_result ? reference : result).name + "' has no CRS: taken to be in that of the other");
  const auto offset = lattice_offset(reference, result);
  if (!offset) refuse(reference, result, "their cells do not coincide");
  const std::int64_t x0 = std::max<std::int64_t>(0, (*offset)[0]), y0 = std::max<std::int64_t>(0, (*offset)[1]);
  const std::int64_t x1 = std::min(reference.size.width, (*offset)[0] + result.size.width);
  const std::int64_t y1 = std::min(reference.size.height, (*offset)[1] + result.size.height);
  if (x1 <= x0 || y1 <= y0) refuse(reference, result, "they have no cell in common");
  alignment.reference = {x0, y0, x1 - x0, y1 - y0};
  alignment.result = {x0 - (*offset)[0], y0 - (*offset)[1], x1 - x0, y1 - y0};
  if (alignment.reference.size() != reference.size || alignment.result.size() != result.size)
    alignment.notes.push_back("the extents differ: compared on the common " + size_text(alignment.reference.size()) + " cells of " +
                              size_text(reference.size) + " (reference) and " + size_text(result.size) + " (result)");
  return alignment;
}

std::array<double, 6> place_in_cells(const Placed& reference, const Placed& other) {
  const auto fail = [&](const std::string& why) {
    throw Error(ErrorKind::input, "cannot lay '" + other.name + "' over '" + reference.name + "': " + why);
  };
  const std::string &a = reference.geo.crs_wkt, &b = other.geo.crs_wkt;
  if (!a.empty() && !b.empty() && !same_horizontal_crs(a, b))
    fail("they lie in different coordinate systems; bring one into that of the other (gdalwarp -t_srs)");
  if (!reference.geo.transform || !other.geo.transform) {
    if (reference.size != other.size) fail("one has no georeference, and they are not of the same size");
    return {0, 1, 0, 0, 0, 1};
  }
  const auto cell = [&](double x, double y) { return to_reference_cells(*reference.geo.transform, *other.geo.transform, x, y); };
  const double width = static_cast<double>(other.size.width), height = static_cast<double>(other.size.height);
  double west = INFINITY, east = -INFINITY, north = INFINITY, south = -INFINITY;
  for (const auto& [column, row] : {cell(0, 0), cell(width, 0), cell(0, height), cell(width, height)})
    west = std::min(west, column), east = std::max(east, column), north = std::min(north, row), south = std::max(south, row);
  if (!(west < static_cast<double>(reference.size.width) && east > 0 && north < static_cast<double>(reference.size.height) && south > 0)) fail("they share no ground");
  const auto origin = cell(0, 0), right = cell(width, 0), below = cell(0, height);
  return {origin[0], (right[0] - origin[0]) / width, (below[0] - origin[0]) / height, origin[1], (right[1] - origin[1]) / width, (below[1] - origin[1]) / height};
}

}  // namespace arete
