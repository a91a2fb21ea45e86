#include "gis/mesh/mesh_plane.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "gis/crs.h"
#include "gis/gdal_errors.h"
#include "gis/geodesy.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/raster_plane.h"

namespace arete {
namespace {

/// The CRS that is drawn in.
std::string drawing_crs(const std::string& wkt) {
  const GdalErrors quiet;
  OGRSpatialReference crs;
  const bool geocentric = !wkt.empty() && crs.importFromWkt(wkt.c_str()) == OGRERR_NONE && crs.IsGeocentric();
  return geocentric ? crs_wkt("EPSG:4326") : wkt;
}

/// Where the vertices lie in that CRS.
MeshBounds drawn_bounds(const MeshSource& mesh, const MeshFrame& frame, const std::string& crs) {
  GeoReference units;
  units.transform = {0, 1, 0, 0, 0, -1};
  units.crs_wkt = crs;
  const RasterPlane plane(frame, units);
  std::vector<RasterPoint> placed;
  std::array<std::int64_t, 4> sides{};  // left, right, top, bottom
  for_vertex_blocks(mesh, [&](std::int64_t first, std::span<const MeshVertex> vertices) {
    placed.resize(vertices.size());
    plane.place(first, vertices, placed);
    if (first == 0) sides = {placed[0].column, placed[0].column, placed[0].row, placed[0].row};
    for (const RasterPoint& p : placed)
      sides = {std::min(sides[0], p.column), std::max(sides[1], p.column), std::min(sides[2], p.row), std::max(sides[3], p.row)};
  });
  const auto at = [](std::int64_t units_of_cell) { return static_cast<double>(units_of_cell) / static_cast<double>(cell_units) + 0.5; };
  return {{at(sides[0]), -at(sides[3]), 0}, {at(sides[1]), -at(sides[2]), 0}};
}

}  // namespace

MeshPlane mesh_plane(const MeshSource& mesh, const MeshFrame& frame) {
  MeshPlane plane;
  plane.geo.crs_wkt = drawing_crs(frame.crs_wkt);
  const MeshBounds bounds = drawn_bounds(mesh, frame, plane.geo.crs_wkt);
  const double across = bounds.high.x - bounds.low.x, down = bounds.high.y - bounds.low.y;
  if (!(across > 0 && down > 0)) throw Error(ErrorKind::input, "the mesh has no extent from west to east and from south to north: there is nothing to draw");
  // The length of a thousandth at the centre counts for all.
  constexpr std::int64_t parts = 1001;
  plane.size = {parts, parts};
  plane.geo.transform = {bounds.low.x, across / parts, 0, bounds.high.y, 0, -down / parts};
  plane.cell = cell_size(plane.geo, plane.size);
  return plane;
}

}  // namespace arete
