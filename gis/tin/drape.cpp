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

constexpr double most_relief_pixels = 2048, most_picture_pixels = 8192;

std::array<double, 6> transform_of(const GeoReference& geo) { return geo.transform.value_or(std::array<double, 6>{0, 1, 0, 0, 0, -1}); }

MeshBounds extent_of(const std::array<double, 6>& t, Size size) {
  return {{t[0], t[3] + static_cast<double>(size.height) * t[5], 0}, {t[0] + static_cast<double>(size.width) * t[1], t[3], 0}};
}

/// Whether rows of the raster run along x and its columns down y in the plane of the mesh.
bool is_north_up(const PlacedMesh& mesh, const std::array<double, 6>& t) {
  return mesh.is_in_plane_of_raster() && t[2] == 0 && t[4] == 0 && t[1] > 0 && t[5] < 0;
}

void check_plane(const PlacedMesh& mesh) {
  if (mesh.is_geocentric()) throw Error(ErrorKind::usage, "--drape needs a mesh in a map plane: geocentric coordinates have none; leave --crs out or name a projected CRS");
}

/// A grid with square cells of this size, or larger ones where they were more than so many along a side, north up, over the mesh and half a
/// cell of the raster around it.
GeoReference grid_over(const PlacedMesh& mesh, double cell, double most, Size& size) {
  const MeshBounds bounds = mesh.bounds_of_raster(0, 0);
  const double margin = mesh.cell_units() / 2;
  const double width = bounds.high.x - bounds.low.x + 2 * margin, height = bounds.high.y - bounds.low.y + 2 * margin;
  cell = std::max(cell, std::max(width, height) / most);
  size = {static_cast<std::int64_t>(std::ceil(width / cell)), static_cast<std::int64_t>(std::ceil(height / cell))};
  GeoReference grid;
  grid.transform = {bounds.low.x - margin, cell, 0, bounds.high.y + margin, 0, -cell};
  grid.crs_wkt = mesh.frame().crs_wkt;
  return grid;
}

/// One channel of a picture; colours multiplied by the opacity, so that hidden ones do not mix into others.
class Channel final : public RasterSource {
 public:
  Channel(const Picture& picture, std::size_t channel) : picture_(picture), channel_(channel) {}
  Size size() const override { return {picture_.width(), picture_.height()}; }
  void read(const Window& window, RasterView<float> out) const override {
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) {
        const Colour& colour = picture_(window.x + x, window.y + y);
        out(x, y) = channel_ == 3 ? colour[3] : static_cast<float>(colour[channel_]) * static_cast<float>(colour[3]) / 255.0f;
      }
  }

 private:
  const Picture& picture_;
  std::size_t channel_;
};

Picture warp_picture(const Picture& picture, const GeoReference& from, const GeoReference& to, Size size) {
  Picture warped(size.width, size.height, {0, 0, 0, 0});
  Raster<float> opacity(size.width, size.height), row(size.width, 1);
  WarpedSource(Channel(picture, 3), from, to, size).read({0, 0, size.width, size.height}, opacity.view());
  for (std::size_t channel = 0; channel < 4; ++channel) {
    const Channel source(picture, channel);
    const WarpedSource plane(source, from, to, size);
    for (std::int64_t y = 0; y < size.height; ++y) {
      plane.read({0, y, size.width, 1}, row.view());
      for (std::int64_t x = 0; x < size.width; ++x) {
        if (is_void(row(x, 0)) || !(opacity(x, y) > 0)) continue;
        const float value = channel == 3 ? row(x, 0) : row(x, 0) * 255.0f / std::min(opacity(x, y), 255.0f);
        warped(x, y)[channel] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 255.0f)));
      }
    }
  }
  return warped;
}

}  // namespace

Drape draw_drape(const RasterSource& raster, const GeoReference& geo, const PlacedMesh& mesh, int threads, Progress& progress) {
  check_plane(mesh);
  ReliefOptions options;
  options.legend = false;
  options.threads = threads;
  const std::array<double, 6> own = transform_of(geo);
  if (is_north_up(mesh, own)) return {draw_relief(raster, cell_size(geo, raster.size()), options, progress).picture, extent_of(own, raster.size())};
  Size size;
  const GeoReference grid = grid_over(mesh, mesh.cell_units(), most_relief_pixels, size);
  const WarpedSource warped(raster, geo, grid, size);
  return {draw_relief(warped, cell_size(grid, size), options, progress).picture, extent_of(*grid.transform, size)};
}

Drape drape_picture(const Picture& picture, const GeoReference& geo, Size raster, const PlacedMesh& mesh) {
  check_plane(mesh);
  const std::array<double, 6> own = transform_of(geo);
  if (is_north_up(mesh, own)) return {picture, extent_of(own, raster)};
  const double columns = static_cast<double>(raster.width) / static_cast<double>(picture.width()), rows = static_cast<double>(raster.height) / static_cast<double>(picture.height());
  GeoReference from = geo;
  from.transform = {own[0], own[1] * columns, own[2] * rows, own[3], own[4] * columns, own[5] * rows};
  Size size;
  const GeoReference grid = grid_over(mesh, mesh.cell_units() * std::min(columns, rows), most_picture_pixels, size);
  return {warp_picture(picture, from, grid, size), extent_of(*grid.transform, size)};
}

}  // namespace arete
