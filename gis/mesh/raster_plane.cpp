#include "gis/mesh/raster_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "gis/alignment.h"
#include "gis/crs.h"
#include "gis/gdal_errors.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/vertical_unit.h"

namespace arete {
namespace {

// PROJ's way back from geocentric coordinates is exact to 1.3e-7 m at 4000 m (Bowring's formula, one step).
constexpr double geocentric_noise_m = 1e-6, unit_noise_m = 1e-9, farthest_cells = 0x1p31;

OGRSpatialReference known_crs(const std::string& wkt, const char* whose) {
  OGRSpatialReference crs;
  if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE)
    throw Error(ErrorKind::input, std::string("the CRS of the ") + whose + " cannot be read: expected WKT, found '" + wkt.substr(0, 60) + "'");
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

/// How coordinates of a mesh become those of the raster's CRS.
struct ChangeOfCrs {
  std::unique_ptr<OGRCoordinateTransformation> change;  // from the mesh to the raster; null: none
  std::unique_ptr<OGRCoordinateTransformation> making;  // from the raster to the mesh, as the mesh was made
  bool with_height = false;
  double metres_per_unit = 1;  // of the heights that come out, where they take part
};

ChangeOfCrs relate(const std::string& from_wkt, const std::string& to_wkt) {
  if (from_wkt.empty() || to_wkt.empty()) return {};
  const GdalErrors errors;
  OGRSpatialReference from = known_crs(from_wkt, "mesh"), to = known_crs(to_wkt, "raster");
  const std::string from_height = summarise_crs(from_wkt).vertical_name, to_height = summarise_crs(to_wkt).vertical_name;
  ChangeOfCrs relation;
  const bool geocentric = from.IsGeocentric() && !to.IsGeocentric();
  relation.with_height = geocentric || (!from_height.empty() && !to_height.empty() && from_height != to_height);
  if (!relation.with_height) {
    if (same_horizontal_crs(from_wkt, to_wkt)) return {};
    if (from.IsCompound()) from.StripVertical();
    if (to.IsCompound()) to.StripVertical();
  } else if (to.IsCompound()) {
    relation.metres_per_unit = vertical_unit("", to_wkt).metres;
  } else {
    to.PromoteTo3D(nullptr);
  }
  relation.change.reset(OGRCreateCoordinateTransformation(&from, &to));
  relation.making.reset(OGRCreateCoordinateTransformation(&to, &from));
  if (!relation.change || !relation.making) throw Error(ErrorKind::input, "the CRS of the mesh cannot be related to that of the raster" + errors.suffix());
  return relation;
}

struct Places {
  std::vector<double> x, y, z;
};

std::int64_t to_units(double cells, double snap) {
  const double half = std::round(2 * cells) / 2;
  return std::llround((std::fabs(cells - half) <= snap ? half : cells) * static_cast<double>(cell_units));
}

}  // namespace

struct RasterPlane::Impl {
  std::array<double, 6> transform;
  double determinant;
  double snap;
  double metres_per_unit;
  ChangeOfCrs relation;
  double height_noise_m;  // within which a height is the float beside it

  void change_crs(Places& places, std::int64_t first) const;
  RasterPoint place(double x, double y, double z, std::int64_t index) const;
};

RasterPlane::RasterPlane(const MeshFrame& frame, const GeoReference& geo, double snap) : impl_(std::make_unique<Impl>()) {
  impl_->transform = geo.transform.value_or(std::array<double, 6>{0, 1, 0, 0, 0, -1});
  const auto& t = impl_->transform;
  impl_->determinant = t[1] * t[5] - t[2] * t[4];
  if (!(std::fabs(impl_->determinant) > 0)) throw Error(ErrorKind::input, "the raster's transform cannot be inverted: its cells have no area");
  impl_->snap = snap;
  impl_->relation = relate(frame.crs_wkt, geo.crs_wkt);
  impl_->metres_per_unit = impl_->relation.with_height ? impl_->relation.metres_per_unit : frame.metres_per_unit;
  impl_->height_noise_m = impl_->relation.with_height ? geocentric_noise_m : impl_->metres_per_unit != 1 ? unit_noise_m : 0;
}

RasterPlane::~RasterPlane() = default;

int RasterPlane::orientation() const { return impl_->determinant > 0 ? 1 : -1; }

void RasterPlane::Impl::change_crs(Places& places, std::int64_t first) const {
  const GdalErrors errors;
  const auto transform_all = [&](OGRCoordinateTransformation& change, Places& all) {
    std::vector<int> succeeded(all.x.size());
    change.Transform(static_cast<int>(all.x.size()), all.x.data(), all.y.data(), relation.with_height ? all.z.data() : nullptr, succeeded.data());
    const auto failed = std::find(succeeded.begin(), succeeded.end(), 0);
    if (failed != succeeded.end())
      throw Error(ErrorKind::input, "vertex " + std::to_string(first + (failed - succeeded.begin())) + " of the mesh has no place in the CRS of the raster" +
                                        errors.suffix());
  };
  // Datum shifts are inverted only to 1e-4 of a cell or so (PROJ's Helmert, and heights that are left behind): there and back again from
  // the place found shows by how much, and the shift is the same at so small a distance.
  transform_all(*relation.change, places);
  Places again = places;
  transform_all(*relation.making, again);
  transform_all(*relation.change, again);
  for (std::size_t i = 0; i < places.x.size(); ++i) {
    places.x[i] += places.x[i] - again.x[i];
    places.y[i] += places.y[i] - again.y[i];
    if (relation.with_height) places.z[i] += places.z[i] - again.z[i];
  }
}

RasterPoint RasterPlane::Impl::place(double x, double y, double z, std::int64_t index) const {
  const auto& t = transform;
  const double dx = x - t[0], dy = y - t[3];
  const double column = (t[5] * dx - t[2] * dy) / determinant - 0.5, row = (t[1] * dy - t[4] * dx) / determinant - 0.5;
  double height = z * metres_per_unit;
  if (!(std::fabs(column) < farthest_cells && std::fabs(row) < farthest_cells && std::isfinite(height)))
    throw Error(ErrorKind::input, "vertex " + std::to_string(index) + " of the mesh lies nowhere near the raster (column " + std::to_string(column) + ", row " +
                                      std::to_string(row) + ", " + std::to_string(height) + " m): is the mesh of another DEM or CRS?");
  const auto as_read = static_cast<double>(static_cast<float>(height));
  if (std::fabs(height - as_read) <= height_noise_m) height = as_read;
  return {to_units(column, snap), to_units(row, snap), height};
}

void RasterPlane::place(std::int64_t first, std::span<const MeshVertex> vertices, std::span<RasterPoint> out) const {
  Places places;
  for (const MeshVertex& v : vertices) places.x.push_back(v.x), places.y.push_back(v.y), places.z.push_back(v.z);
  if (impl_->relation.change && !vertices.empty()) impl_->change_crs(places, first);
  for (std::size_t i = 0; i < vertices.size(); ++i) out[i] = impl_->place(places.x[i], places.y[i], places.z[i], first + static_cast<std::int64_t>(i));
}

RasterPoints::RasterPoints(const MeshSource& mesh, const RasterPlane& plane, const Scratch& scratch, std::int64_t limit_bytes, Progress& progress)
    : size_(mesh.vertices()),
      bytes_(scratch, limit_bytes),
      blocks_((size_ + block_points - 1) / block_points, std::max<std::int64_t>(64, limit_bytes / 4 / (block_points * static_cast<std::int64_t>(sizeof(RasterPoint)))),
              [this](std::int64_t index, Block& block) {
                const std::int64_t first = index * block_points;
                block.points.resize(static_cast<std::size_t>(std::min(block_points, size_ - first)));
                read(first, block.points);
              }) {
  bytes_.resize(static_cast<std::uint64_t>(size_) * sizeof(RasterPoint));
  progress.begin("Placing vertices", size_);
  std::vector<RasterPoint> placed;
  for_vertex_blocks(mesh, [&](std::int64_t first, std::span<const MeshVertex> vertices) {
    placed.resize(vertices.size());
    plane.place(first, vertices, placed);
    bytes_.write(static_cast<std::uint64_t>(first) * sizeof(RasterPoint), std::as_bytes(std::span<const RasterPoint>(placed)));
    progress.advance(static_cast<std::int64_t>(placed.size()));
  });
  progress.end();
}

void RasterPoints::read(std::int64_t first, std::span<RasterPoint> out) const {
  bytes_.read(static_cast<std::uint64_t>(first) * sizeof(RasterPoint), std::as_writable_bytes(out));
}

std::array<RasterPoint, 3> corners_of(const MeshTriangle& triangle, std::int64_t index, RasterPoints& points) {
  std::array<RasterPoint, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    if (triangle[k] < 0 || triangle[k] >= points.size())
      throw Error(ErrorKind::input, "triangle " + std::to_string(index) + " of the mesh names vertex " + std::to_string(triangle[k]) + ", but there are only " +
                                        std::to_string(points.size()));
    corners[k] = points.at(triangle[k]);
  }
  return corners;
}

}  // namespace arete
