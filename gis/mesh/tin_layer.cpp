// OGR's drivers, https://gdal.org/drivers/vector/gpkg.html and flatgeobuf.html.
#include "gis/mesh/tin_layer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_geometry.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "core/support/error.h"
#include "gis/gdal_errors.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/mesh_builder.h"
#include "gis/mesh/output_file.h"
#include "gis/mesh/vertex_cache.h"
#include "gis/mesh/weld_vertices.h"
#include "gis/vertical_unit.h"

namespace arete {
namespace {

constexpr std::int64_t block_triangles = 10000;
constexpr int deepest_collection = 32;

/// While it lives, what OGR writes has one date.
class FixedDate {
 public:
  FixedDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z"); }
  ~FixedDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", nullptr); }
  FixedDate(const FixedDate&) = delete;
  FixedDate& operator=(const FixedDate&) = delete;
};

[[noreturn]] void fail_writing(const std::string& path, const GdalErrors& errors) {
  throw Error(ErrorKind::disk, "cannot write '" + path + "'" + errors.suffix());
}

void add_fields(OGRLayer& layer, const std::string& path, const GdalErrors& errors) {
  OGRFieldDefn fields[] = {{"block", OFTInteger64}, {"triangles", OFTInteger64}, {"z_unit", OFTString}, {"z_low", OFTReal}, {"z_high", OFTReal}};
  for (OGRFieldDefn& field : fields)
    if (layer.CreateField(&field) != OGRERR_NONE) fail_writing(path, errors);
}

std::unique_ptr<OGRTriangle> triangle_of(const std::array<MeshVertex, 3>& v) {
  return std::make_unique<OGRTriangle>(OGRPoint(v[0].x, v[0].y, v[0].z), OGRPoint(v[1].x, v[1].y, v[1].z), OGRPoint(v[2].x, v[2].y, v[2].z));
}

void write_layer(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options, const char* driver_name,
                 const char* const* creation) {
  const GdalErrors errors;
  const FixedDate date;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(driver_name);
  if (driver == nullptr) throw Error(ErrorKind::format, "cannot write '" + path + "': this GDAL has no driver " + driver_name);
  OGRSpatialReference crs;
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const bool known = !frame.crs_wkt.empty() && crs.importFromWkt(frame.crs_wkt.c_str()) == OGRERR_NONE;
  GDALDatasetUniquePtr dataset(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (dataset == nullptr) fail_writing(path, errors);
  const std::string title = one_line(options.title);
  OGRLayer* layer = dataset->CreateLayer("tin", known ? &crs : nullptr, wkbTINZ, const_cast<char**>(creation));
  if (layer == nullptr) fail_writing(path, errors);
  if (!title.empty()) layer->SetMetadataItem("DESCRIPTION", title.c_str());
  add_fields(*layer, path, errors);
  if (dataset->TestCapability(ODsCTransactions)) dataset->StartTransaction();

  VertexCache vertices(mesh);
  std::vector<MeshTriangle> block;
  for (std::int64_t first = 0; first < mesh.triangles(); first += block_triangles) {
    block.resize(static_cast<std::size_t>(std::min(block_triangles, mesh.triangles() - first)));
    mesh.read_triangles(first, block);
    auto tin = std::make_unique<OGRTriangulatedSurface>();
    double low = vertices[block[0][0]].z, high = low;
    for (const MeshTriangle& t : block) {
      const std::array<MeshVertex, 3> v{vertices[t[0]], vertices[t[1]], vertices[t[2]]};
      for (const MeshVertex& corner : v) low = std::min(low, corner.z), high = std::max(high, corner.z);
      // The surface takes the triangle.
      if (tin->addGeometryDirectly(triangle_of(v).release()) != OGRERR_NONE) fail_writing(path, errors);
    }
    OGRFeature feature(layer->GetLayerDefn());
    feature.SetField("block", static_cast<GIntBig>(first / block_triangles));
    feature.SetField("triangles", static_cast<GIntBig>(block.size()));
    feature.SetField("z_unit", frame.vertical_unit.c_str());
    feature.SetField("z_low", low);
    feature.SetField("z_high", high);
    feature.SetGeometryDirectly(tin.release());
    if (layer->CreateFeature(&feature) != OGRERR_NONE) fail_writing(path, errors);
  }
  if (dataset->TestCapability(ODsCTransactions) && dataset->CommitTransaction() != OGRERR_NONE) fail_writing(path, errors);
  dataset.reset();
  if (errors.failed()) fail_writing(path, errors);
}

class LayerReader {
 public:
  LayerReader(const std::string& path, const Scratch& scratch) : path_(path), mesh_(scratch), welder_(mesh_) {}

  MeshFile read(const char* driver) {
    const GdalErrors errors;
    const char* const drivers[] = {driver, nullptr};
    const GDALDatasetUniquePtr dataset(GDALDataset::Open(path_.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, drivers, nullptr, nullptr));
    if (dataset == nullptr) throw Error(ErrorKind::input, "cannot read '" + path_ + "' as " + driver + errors.suffix());
    MeshFile file;
    for (OGRLayer* layer : dataset->GetLayers()) read_layer(*layer, file.frame);
    if (errors.failed()) throw Error(ErrorKind::input, "'" + path_ + "' is damaged" + errors.suffix() + "; get it again");
    if (mesh_.triangles() == 0) throw Error(ErrorKind::format, "cannot read '" + path_ + "': it holds no triangles");
    file.format = driver;
    file.mesh = mesh_.finish(path_);
    return file;
  }

 private:
  void read_layer(OGRLayer& layer, MeshFrame& frame) {
    std::string unit;
    if (const OGRSpatialReference* crs = layer.GetSpatialRef(); crs != nullptr && frame.crs_wkt.empty()) {
      char* wkt = nullptr;
      const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
      if (crs->exportToWkt(&wkt, options) == OGRERR_NONE) frame.crs_wkt = wkt;
      CPLFree(wkt);
      geocentric_ = crs->IsGeocentric();
    }
    const int unit_field = layer.GetLayerDefn()->GetFieldIndex("z_unit");
    for (const auto& feature : layer) {
      if (unit_field >= 0 && unit.empty()) unit = feature->GetFieldAsString(unit_field);
      if (feature->GetGeometryRef() != nullptr) add(*feature->GetGeometryRef(), 0);
    }
    const VerticalUnit vertical = vertical_unit(unit, frame.crs_wkt);
    frame.vertical_unit = vertical.name;
    frame.metres_per_unit = vertical.metres;
  }

  void add(const OGRGeometry& geometry, int depth) {
    if (depth > deepest_collection) throw Error(ErrorKind::input, "'" + path_ + "' is damaged: a geometry is nested more than 32 deep");
    switch (wkbFlatten(geometry.getGeometryType())) {
      case wkbTIN:
      case wkbPolyhedralSurface:
        for (const auto* part : *geometry.toPolyhedralSurface()) add(*part);
        break;
      case wkbMultiPolygon:
      case wkbGeometryCollection:
        for (const auto* part : *geometry.toGeometryCollection()) add(*part, depth + 1);
        break;
      case wkbTriangle:
      case wkbPolygon:
        add(*geometry.toPolygon());
        break;
      default:
        refuse(geometry.getGeometryName());
    }
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorKind::format, "cannot read '" + path_ + "' as a mesh: expected triangles, found " + what);
  }

  void add(const OGRPolygon& polygon) {
    const OGRLinearRing* ring = polygon.getExteriorRing();
    if (ring == nullptr || ring->getNumPoints() == 0) return;
    if (polygon.getNumInteriorRings() > 0 || ring->getNumPoints() != 4 || ring->getX(0) != ring->getX(3) || ring->getY(0) != ring->getY(3))
      refuse("a polygon of " + std::to_string(ring->getNumPoints() - 1) + " corners or with holes");
    std::array<MeshVertex, 3> v;
    for (int i = 0; i < 3; ++i) {
      v[static_cast<std::size_t>(i)] = {ring->getX(i), ring->getY(i), ring->getZ(i)};
      if (!std::isfinite(ring->getX(i)) || !std::isfinite(ring->getY(i)) || !std::isfinite(ring->getZ(i)))
        throw Error(ErrorKind::input, "'" + path_ + "' is damaged: a vertex is no number");
    }
    const double area = (v[1].x - v[0].x) * (v[2].y - v[0].y) - (v[2].x - v[0].x) * (v[1].y - v[0].y);
    if (area < 0 && !geocentric_) std::swap(v[1], v[2]);
    mesh_.add(MeshTriangle{welder_.index_of(v[0]), welder_.index_of(v[1]), welder_.index_of(v[2])});
  }

  std::string path_;
  bool geocentric_ = false;
  MeshBuilder mesh_;
  VertexWelder welder_;
};

}  // namespace

MeshRounding tin_layer_rounding(const MeshBounds&, const MeshWriteOptions&) { return {}; }

void write_geopackage(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options) {
  const char* const creation[] = {"GEOMETRY_NAME=geom", "FID=fid", nullptr};
  write_layer(mesh, frame, path, options, "GPKG", creation);
}

void write_flatgeobuf(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options) {
  const char* const creation[] = {"SPATIAL_INDEX=YES", nullptr};
  write_layer(mesh, frame, path, options, "FlatGeobuf", creation);
}

MeshFile read_geopackage(const std::string& path, const Scratch& scratch) { return LayerReader(path, scratch).read("GPKG"); }

MeshFile read_flatgeobuf(const std::string& path, const Scratch& scratch) { return LayerReader(path, scratch).read("FlatGeobuf"); }

}  // namespace arete
