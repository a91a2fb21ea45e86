// OGR reads the file, GEOS unites polygons.
#include "gis/tin/read_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include <gdal_priv.h>
#include <ogr_geometry.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "core/support/error.h"
#include "gis/alignment.h"
#include "gis/gdal_errors.h"

namespace arete {
namespace {

constexpr int deepest_collection = 32;

/// "path|layer", but for a path that has such a name.
std::pair<std::string, std::string> split_source(const std::string& source) {
  const std::size_t bar = source.rfind('|');
  if (bar == std::string::npos) return {source, ""};
  std::string layer = source.substr(bar + 1);
  const std::string key = "layername=";
  if (layer.rfind(key, 0) == 0) layer = layer.substr(key.size());
  return {source.substr(0, bar), layer};
}

/// Takes places of a layer to columns and rows from the centre of the first cell.
class ToRaster {
 public:
  ToRaster(const GeoReference& geo, const OGRSpatialReference* layer_crs, const std::string& path) : transform_(geo.transform.value_or(std::array<double, 6>{0, 1, 0, 0, 0, -1})) {
    determinant_ = transform_[1] * transform_[5] - transform_[2] * transform_[4];
    if (!(std::abs(determinant_) > 0)) throw Error(ErrorKind::input, "the raster has cells without area: lines cannot be placed in it");
    unknown_ = (layer_crs == nullptr) != geo.crs_wkt.empty();
    if (layer_crs == nullptr || geo.crs_wkt.empty()) return;
    const GdalErrors errors;
    std::unique_ptr<OGRSpatialReference> from(layer_crs->Clone());
    OGRSpatialReference to;
    if (to.importFromWkt(geo.crs_wkt.c_str()) != OGRERR_NONE) throw Error(ErrorKind::input, "the CRS of the raster cannot be read" + errors.suffix());
    if (from->IsCompound()) from->StripVertical();
    if (to.IsCompound()) to.StripVertical();
    from->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    to.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    char* wkt = nullptr;
    from->exportToWkt(&wkt);
    const std::string from_wkt = wkt == nullptr ? "" : wkt;
    CPLFree(wkt);
    if (same_horizontal_crs(from_wkt, geo.crs_wkt)) return;
    change_.reset(OGRCreateCoordinateTransformation(from.get(), &to));
    if (!change_) throw Error(ErrorKind::input, "the CRS of '" + path + "' cannot be related to that of the raster" + errors.suffix());
  }

  bool crs_unknown() const { return unknown_; }

  /// Places that have none are NaN.
  RasterLine place(const OGRSimpleCurve& curve) const {
    const auto count = static_cast<std::size_t>(curve.getNumPoints());
    std::vector<double> x(count), y(count);
    std::vector<int> succeeded(count, 1);
    for (std::size_t i = 0; i < count; ++i) x[i] = curve.getX(static_cast<int>(i)), y[i] = curve.getY(static_cast<int>(i));
    if (change_ && count > 0) {
      const GdalErrors errors;
      change_->Transform(static_cast<int>(count), x.data(), y.data(), nullptr, succeeded.data());
    }
    RasterLine line;
    line.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double dx = x[i] - transform_[0], dy = y[i] - transform_[3];
      const RasterPlace p{(transform_[5] * dx - transform_[2] * dy) / determinant_ - 0.5, (transform_[1] * dy - transform_[4] * dx) / determinant_ - 0.5};
      const bool placed = succeeded[i] && std::isfinite(p[0]) && std::isfinite(p[1]);
      line.push_back(placed ? p : RasterPlace{std::nan(""), std::nan("")});
    }
    return line;
  }

 private:
  std::array<double, 6> transform_;
  double determinant_;
  bool unknown_ = false;
  std::unique_ptr<OGRCoordinateTransformation> change_;
};

/// What is done with a geometry of straight parts; `feature` is for messages.
using Take = std::function<void(const OGRGeometry&, const ToRaster&, GIntBig feature)>;

LinesInRaster read(const std::string& source, const GeoReference& geo, const Take& take) {
  const auto [path, wanted] = split_source(source);
  const GdalErrors errors;
  const GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
  if (dataset == nullptr) throw Error(ErrorKind::input, "cannot read lines of '" + path + "'" + errors.suffix());
  LinesInRaster result;
  bool any_layer = false;
  for (OGRLayer* layer : dataset->GetLayers()) {
    if (!wanted.empty() && wanted != layer->GetName()) continue;
    any_layer = true;
    const ToRaster to_raster(geo, layer->GetSpatialRef(), path);
    for (const OGRFeatureUniquePtr& feature : *layer) {
      const OGRGeometry* geometry = feature->GetGeometryRef();
      if (geometry == nullptr || geometry->IsEmpty()) continue;
      const std::unique_ptr<OGRGeometry> straight(geometry->hasCurveGeometry() ? geometry->getLinearGeometry() : geometry->clone());
      if (straight == nullptr) continue;
      ++result.features;
      result.crs_unknown |= to_raster.crs_unknown();
      take(*straight, to_raster, feature->GetFID());
    }
  }
  if (!any_layer) throw Error(ErrorKind::input, wanted.empty() ? "'" + path + "' has no layer of lines" : "'" + path + "' has no layer '" + wanted + "'");
  if (errors.failed()) throw Error(ErrorKind::input, "cannot read all lines of '" + path + "'" + errors.suffix());
  return result;
}

bool is_placed(const RasterPlace& p) { return std::isfinite(p[0]) && std::isfinite(p[1]); }

/// A line without the vertices that have no place.
void append_parts(const RasterLine& line, std::vector<RasterLine>& lines) {
  RasterLine part;
  const auto end_part = [&] {
    if (part.size() > 1) lines.push_back(std::move(part));
    part = {};
  };
  for (const RasterPlace& p : line) {
    if (is_placed(p)) part.push_back(p);
    else end_part();
  }
  end_part();
}

void append_curves(const OGRGeometry& geometry, const ToRaster& to_raster, int depth, std::vector<RasterLine>& lines) {
  switch (wkbFlatten(geometry.getGeometryType())) {
    case wkbLineString:
    case wkbLinearRing: append_parts(to_raster.place(*geometry.toSimpleCurve()), lines); return;
    case wkbPolygon:
    case wkbTriangle:
      for (const OGRLinearRing* ring : *geometry.toPolygon()) append_parts(to_raster.place(*ring), lines);
      return;
    case wkbPolyhedralSurface:
    case wkbTIN:
      for (const OGRPolygon* face : *geometry.toPolyhedralSurface())
        for (const OGRLinearRing* ring : *face) append_parts(to_raster.place(*ring), lines);
      return;
    case wkbMultiLineString:
    case wkbMultiPolygon:
    case wkbGeometryCollection:
      if (depth > deepest_collection) return;
      for (const OGRGeometry* part : *geometry.toGeometryCollection()) append_curves(*part, to_raster, depth + 1, lines);
      return;
    default: return;
  }
}

std::unique_ptr<OGRLinearRing> ring_in_raster(const OGRLinearRing& ring, const ToRaster& to_raster, const std::string& source, GIntBig feature) {
  auto placed = std::make_unique<OGRLinearRing>();
  for (const RasterPlace& p : to_raster.place(ring)) {
    if (!is_placed(p)) throw Error(ErrorKind::input, "a vertex of feature " + std::to_string(feature) + " of '" + source + "' has no place in the CRS of the raster");
    placed->addPoint(p[0], p[1]);
  }
  placed->closeRings();
  return placed;
}

void append_polygons(const OGRGeometry& geometry, const ToRaster& to_raster, int depth, const std::string& source, GIntBig feature, OGRMultiPolygon& all) {
  const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbPolygon || type == wkbTriangle) {
    auto polygon = std::make_unique<OGRPolygon>();
    for (const OGRLinearRing* ring : *geometry.toPolygon()) polygon->addRingDirectly(ring_in_raster(*ring, to_raster, source, feature).release());
    all.addGeometryDirectly(polygon.release());
  } else if ((type == wkbMultiPolygon || type == wkbGeometryCollection) && depth <= deepest_collection) {
    for (const OGRGeometry* part : *geometry.toGeometryCollection()) append_polygons(*part, to_raster, depth + 1, source, feature, all);
  }
}

void append_rings(const OGRGeometry& geometry, int depth, std::vector<RasterLine>& rings) {
  const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbPolygon) {
    for (const OGRLinearRing* ring : *geometry.toPolygon()) {
      RasterLine& line = rings.emplace_back();
      for (int i = 0; i < ring->getNumPoints(); ++i) line.push_back({ring->getX(i), ring->getY(i)});
    }
  } else if ((type == wkbMultiPolygon || type == wkbGeometryCollection) && depth <= deepest_collection) {
    for (const OGRGeometry* part : *geometry.toGeometryCollection()) append_rings(*part, depth + 1, rings);
  }
}

std::unique_ptr<OGRGeometry> unite(const OGRMultiPolygon& all, const std::string& source) {
  const GdalErrors errors;
  OGRMultiPolygon valid;
  const auto append = [&](const auto& self, const OGRGeometry& geometry) -> void {
    const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
    if (type == wkbPolygon) valid.addGeometry(&geometry);
    else if (type == wkbMultiPolygon || type == wkbGeometryCollection)
      for (const OGRGeometry* part : *geometry.toGeometryCollection()) self(self, *part);
  };
  for (const OGRGeometry* polygon : all) {
    const std::unique_ptr<OGRGeometry> made(polygon->MakeValid());
    if (made == nullptr) throw Error(ErrorKind::input, "a polygon of '" + source + "' crosses itself and cannot be made valid" + errors.suffix());
    append(append, *made);
  }
  std::unique_ptr<OGRGeometry> united(valid.UnionCascaded());
  if (united == nullptr) throw Error(ErrorKind::input, "the polygons of '" + source + "' cannot be united" + errors.suffix());
  return united;
}

bool meets(const RasterLine& line, Size size) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  RasterPlace low{infinity, infinity}, high{-infinity, -infinity};
  for (const RasterPlace& p : line)
    for (std::size_t k = 0; k < 2; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
  return high[0] >= 0 && high[1] >= 0 && low[0] <= static_cast<double>(size.width - 1) && low[1] <= static_cast<double>(size.height - 1);
}

}  // namespace

LinesInRaster read_breaklines(const std::string& source, const GeoReference& geo, Size size) {
  std::vector<RasterLine> lines;
  std::int64_t inside = 0, found = 0;
  LinesInRaster result = read(source, geo, [&](const OGRGeometry& geometry, const ToRaster& to_raster, GIntBig) {
    std::vector<RasterLine> of_feature;
    append_curves(geometry, to_raster, 0, of_feature);
    found += static_cast<std::int64_t>(of_feature.size());
    bool any = false;
    for (RasterLine& line : of_feature)
      if (meets(line, size)) lines.push_back(std::move(line)), any = true;
    inside += any;
  });
  if (found == 0) throw Error(ErrorKind::input, "'" + source + "' has no lines: expected lines or polygons, found " + std::to_string(result.features) + " other features");
  result.lines = std::move(lines);
  result.features_inside = inside;
  return result;
}

LinesInRaster read_boundary(const std::string& source, const GeoReference& geo, Size size) {
  OGRMultiPolygon all;
  LinesInRaster result = read(source, geo, [&](const OGRGeometry& geometry, const ToRaster& to_raster, GIntBig feature) {
    append_polygons(geometry, to_raster, 0, source, feature, all);
  });
  if (all.IsEmpty()) throw Error(ErrorKind::input, "'" + source + "' has no polygons: a boundary needs one at least");
  append_rings(*unite(all, source), 0, result.lines);
  for (const RasterLine& ring : result.lines) result.features_inside += meets(ring, size);
  return result;
}

}  // namespace arete
