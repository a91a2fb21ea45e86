#include "gis/tin/placed_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include <ogr_spatialref.h>

#include <GeographicLib/UTMUPS.hpp>

#include "core/support/error.h"
#include "gis/alignment.h"
#include "gis/crs.h"
#include "gis/gdal_errors.h"
#include "gis/vertical_unit.h"

namespace arete {
namespace {

OGRSpatialReference parse_crs(const std::string& wkt) {
  OGRSpatialReference crs;
  if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE) throw Error(ErrorKind::usage, "the CRS '" + wkt.substr(0, 60) + "' cannot be read");
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

/// The UTM (or UPS) zone of the middle of the raster.
std::string utm_zone_of(const GeoReference& geo, Size size) {
  const std::optional<GeographicExtent> extent = geographic_extent(geo, size);
  if (!extent) throw Error(ErrorKind::usage, "the raster lies nowhere on Earth (it has no CRS): give --crs a CRS that it can be in, or give the raster one");
  const double east = extent->east < extent->west ? extent->east + 360 : extent->east;
  const double latitude = (extent->south + extent->north) / 2, longitude = std::remainder((extent->west + east) / 2, 360);
  const int zone = GeographicLib::UTMUPS::StandardZone(latitude, longitude);
  return crs_wkt("EPSG:" + std::to_string(GeographicLib::UTMUPS::EncodeEPSG(zone, latitude >= 0)));
}

bool is_utm(const std::string& wkt) { return !wkt.empty() && parse_crs(wkt).GetUTMZone() != 0; }

/// From the raster's CRS to the mesh's. Heights take part only where the mesh is geocentric.
struct ChangeOfPlane {
  std::unique_ptr<OGRCoordinateTransformation> change;  // null: none
  bool with_height = false;
  double metres_per_unit = 1;  // of the heights that go in, where they take part
};

ChangeOfPlane relate(const GeoReference& geo, const std::string& to_wkt) {
  if (same_horizontal_crs(geo.crs_wkt, to_wkt)) return {};
  if (geo.crs_wkt.empty()) throw Error(ErrorKind::usage, "the raster has no CRS: the mesh cannot be placed in another; leave --crs out, or give the raster its CRS");
  const GdalErrors errors;
  OGRSpatialReference from = parse_crs(geo.crs_wkt), to = parse_crs(to_wkt);
  ChangeOfPlane plane;
  plane.with_height = to.IsGeocentric();
  if (plane.with_height) {
    if (from.IsCompound()) plane.metres_per_unit = vertical_unit("", geo.crs_wkt).metres;
    else from.PromoteTo3D(nullptr);
  } else {
    if (from.IsCompound()) from.StripVertical();
    if (to.IsCompound()) to.StripVertical();
  }
  plane.change.reset(OGRCreateCoordinateTransformation(&from, &to));
  if (!plane.change) throw Error(ErrorKind::usage, "the CRS of the mesh cannot be related to that of the raster" + errors.suffix());
  return plane;
}

}  // namespace

struct PlacedMesh::Impl {
  Size size;
  std::array<double, 6> transform;
  MeshFrame frame;
  ChangeOfPlane plane;
  bool turned = false;  // the triangles face the ground where x is east and y north
  mutable std::mutex mutex;  // of the transformation, which serves one thread at a time

  void place(std::span<MeshVertex> vertices, std::int64_t first) const {
    for (MeshVertex& v : vertices) {
      const double column = v.x + 0.5, row = v.y + 0.5;
      v.x = transform[0] + column * transform[1] + row * transform[2];
      v.y = transform[3] + column * transform[4] + row * transform[5];
    }
    if (!plane.change) {
      for (MeshVertex& v : vertices) v.z /= frame.metres_per_unit;
      return;
    }
    std::vector<double> x, y, z;
    for (const MeshVertex& v : vertices) x.push_back(v.x), y.push_back(v.y), z.push_back(v.z / plane.metres_per_unit);
    std::vector<int> succeeded(vertices.size());
    const std::lock_guard lock(mutex);
    const GdalErrors errors;
    plane.change->Transform(static_cast<int>(x.size()), x.data(), y.data(), plane.with_height ? z.data() : nullptr, succeeded.data());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (!succeeded[i] || !std::isfinite(x[i]) || !std::isfinite(y[i]))
        throw Error(ErrorKind::input, "vertex " + std::to_string(first + static_cast<std::int64_t>(i)) + " of the mesh has no place in the CRS of --crs" + errors.suffix());
      vertices[i] = {x[i], y[i], plane.with_height ? z[i] : vertices[i].z / frame.metres_per_unit};
    }
  }
};

PlacedMesh::PlacedMesh(const MeshSource& mesh, const GeoReference& geo, Size size, const MeshPlacement& placement)
    : mesh_(mesh), impl_(std::make_unique<Impl>()) {
  const bool in_utm = placement.utm ? !is_utm(geo.crs_wkt) : placement.metric && placement.crs_wkt.empty() && summarise_crs(geo.crs_wkt).geographic;
  const std::string wkt = in_utm ? utm_zone_of(geo, size) : placement.crs_wkt.empty() ? geo.crs_wkt : placement.crs_wkt;
  impl_->size = size;
  impl_->transform = geo.transform.value_or(std::array<double, 6>{0, 1, 0, 0, 0, -1});
  impl_->frame = {wkt, geo.vertical_unit, geo.metres_per_unit};
  if (!wkt.empty()) {
    impl_->plane = relate(geo, wkt);
    OGRSpatialReference crs = parse_crs(wkt);
    if (impl_->plane.with_height) {
      impl_->frame.vertical_unit = "m", impl_->frame.metres_per_unit = 1;
    } else if (placement.metric) {
      const char* name = nullptr;
      impl_->frame.metres_per_unit = crs.GetLinearUnits(&name);
      impl_->frame.vertical_unit = impl_->frame.metres_per_unit == 1 || name == nullptr ? "m" : name;
    }
  }
  const auto& t = impl_->transform;
  impl_->turned = t[1] * t[5] - t[2] * t[4] > 0;
}

PlacedMesh::~PlacedMesh() = default;

void PlacedMesh::read_vertices(std::int64_t first, std::span<MeshVertex> out) const {
  mesh_.read_vertices(first, out);
  impl_->place(out, first);
}

void PlacedMesh::read_triangles(std::int64_t first, std::span<MeshTriangle> out) const {
  mesh_.read_triangles(first, out);
  if (impl_->turned)
    for (MeshTriangle& t : out) std::swap(t[1], t[2]);
}

const MeshFrame& PlacedMesh::frame() const { return impl_->frame; }
bool PlacedMesh::is_in_plane_of_raster() const { return !impl_->plane.change; }
bool PlacedMesh::is_geocentric() const { return impl_->plane.with_height; }

MeshBounds PlacedMesh::bounds_of_raster(double low_m, double high_m) const {
  constexpr int points = 20;
  const double right = static_cast<double>(impl_->size.width - 1), bottom = static_cast<double>(impl_->size.height - 1);
  std::vector<MeshVertex> border;
  for (const double z : {low_m, high_m})
    for (int i = 0; i <= points; ++i) {
      const double s = static_cast<double>(i) / points;
      for (const MeshVertex& v : {MeshVertex{s * right, 0, z}, {s * right, bottom, z}, {0, s * bottom, z}, {right, s * bottom, z}}) border.push_back(v);
    }
  impl_->place(border, 0);
  MeshBounds bounds{border.front(), border.front()};
  for (const MeshVertex& v : border) {
    bounds.low = {std::min(bounds.low.x, v.x), std::min(bounds.low.y, v.y), std::min(bounds.low.z, v.z)};
    bounds.high = {std::max(bounds.high.x, v.x), std::max(bounds.high.y, v.y), std::max(bounds.high.z, v.z)};
  }
  return bounds;
}

double PlacedMesh::cell_units() const {
  const double x = static_cast<double>(impl_->size.width / 2), y = static_cast<double>(impl_->size.height / 2);
  std::array<MeshVertex, 3> corner{MeshVertex{x, y, 0}, {x + 1, y, 0}, {x, y + 1, 0}};
  impl_->place(corner, 0);
  const auto distance = [](const MeshVertex& a, const MeshVertex& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); };
  return std::min(distance(corner[0], corner[1]), distance(corner[0], corner[2]));
}

Displacement PlacedMesh::displacement() const {
  Displacement moved;
  if (!impl_->plane.change) return moved;
  constexpr double safety = 1.5;
  const double width = static_cast<double>(impl_->size.width - 1), height = static_cast<double>(impl_->size.height - 1);
  const double cell = cell_units();
  for (const double s : {0.0, 0.5, 1.0})
    for (const double t : {0.0, 0.5, 1.0})
      for (const auto& [right, down] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}}) {
        const double length = std::min(128.0, right > 0 && down > 0 ? std::min(width, height) : right > 0 ? width : height);
        const double x = s * (width - right * length), y = t * (height - down * length);
        std::array<MeshVertex, 3> line{MeshVertex{x, y, 0}, {x + right * length / 2, y + down * length / 2, 0}, {x + right * length, y + down * length, 0}};
        impl_->place(line, 0);
        const double dx = line[1].x - (line[0].x + line[2].x) / 2, dy = line[1].y - (line[0].y + line[2].y) / 2, dz = line[1].z - (line[0].z + line[2].z) / 2;
        const double cells2 = (right + down) * length * length;
        double aside = std::hypot(dx, dy), sag = 0;
        if (impl_->plane.with_height) {  // up is away from the Earth's centre, near enough
          const double radius = std::hypot(line[1].x, line[1].y, line[1].z);
          sag = std::abs(dx * line[1].x + dy * line[1].y + dz * line[1].z) / radius;
          aside = std::sqrt(std::max(0.0, dx * dx + dy * dy + dz * dz - sag * sag));
        }
        moved.bend_cells = std::max(moved.bend_cells, safety * aside / cell / cells2);
        moved.sag_m = std::max(moved.sag_m, safety * sag / cells2);
      }
  if (moved.bend_cells > 0) moved.longest_cells = std::max(least_length, std::min(any_length, std::sqrt(0.25 / moved.bend_cells)));
  return moved;
}

double PlacedMesh::height_noise_m() const {
  if (impl_->plane.with_height) return 2e-6;
  return impl_->frame.metres_per_unit == 1 ? 0 : 2e-9;
}

}  // namespace arete
