#include "gis/tin/drape.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/support/error.h"
#include "gis/geodesy.h"
#include "gis/relief.h"
#include "gis/warp.h"

namespace arete {
namespace {

constexpr double most_pixels = 2048;

MeshBounds extent_of(const std::array<double, 6>& t, Size size) {
  return {{t[0], t[3] + static_cast<double>(size.height) * t[5], 0}, {t[0] + static_cast<double>(size.width) * t[1], t[3], 0}};
}

/// A grid with square cells, north up, over the mesh and half a cell of the raster around it.
GeoReference grid_over(const PlacedMesh& mesh, Size& size) {
  const MeshBounds bounds = mesh.bounds_of_raster(0, 0);
  const double margin = mesh.cell_units() / 2;
  const double width = bounds.high.x - bounds.low.x + 2 * margin, height = bounds.high.y - bounds.low.y + 2 * margin;
  const double cell = std::max(mesh.cell_units(), std::max(width, height) / most_pixels);
  size = {static_cast<std::int64_t>(std::ceil(width / cell)), static_cast<std::int64_t>(std::ceil(height / cell))};
  GeoReference grid;
  grid.transform = {bounds.low.x - margin, cell, 0, bounds.high.y + margin, 0, -cell};
  grid.crs_wkt = mesh.frame().crs_wkt;
  return grid;
}

}  // namespace

Drape draw_drape(const RasterSource& raster, const GeoReference& geo, const PlacedMesh& mesh, int threads, Progress& progress) {
  if (mesh.is_geocentric()) throw Error(ErrorKind::usage, "--drape needs a mesh in a map plane: geocentric coordinates have none; leave --crs out or name a projected CRS");
  ReliefOptions options;
  options.legend = false;
  options.threads = threads;
  const std::array<double, 6> own = geo.transform.value_or(std::array<double, 6>{0, 1, 0, 0, 0, -1});
  if (mesh.is_in_plane_of_raster() && own[2] == 0 && own[4] == 0 && own[1] > 0 && own[5] < 0)
    return {draw_relief(raster, cell_size(geo, raster.size()), options, progress).picture, extent_of(own, raster.size())};
  Size size;
  const GeoReference grid = grid_over(mesh, size);
  const WarpedSource warped(raster, geo, grid, size);
  return {draw_relief(warped, cell_size(grid, size), options, progress).picture, extent_of(*grid.transform, size)};
}

}  // namespace arete
