#include "gis/globe_placement.h"

#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "gis/alignment.h"
#include "gis/crs.h"
#include "gis/gdal_errors.h"
#include "gis/vertical_unit.h"

namespace arete {
namespace {

constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();

using Change = std::unique_ptr<OGRCoordinateTransformation>;

/// One transformation for each thread that needs one at a time: PROJ's objects serve one thread.
class Changes {
 public:
  Changes() = default;
  explicit Changes(Change first) { free_.push_back(std::move(first)); }

  void apply(std::vector<double>& x, std::vector<double>& y, std::vector<double>* z) const {
    Change change = take();
    std::vector<int> succeeded(x.size());
    {
      const GdalErrors quiet;
      change->Transform(static_cast<int>(x.size()), x.data(), y.data(), z == nullptr ? nullptr : z->data(), succeeded.data());
    }
    for (std::size_t i = 0; i < x.size(); ++i)
      if (!succeeded[i] || !std::isfinite(x[i]) || !std::isfinite(y[i])) {
        x[i] = y[i] = nowhere;
        if (z != nullptr) (*z)[i] = nowhere;
      }
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(change));
  }

 private:
  Change take() const {
    const std::lock_guard lock(mutex_);
    // The last one stays here, for others to be copied from.
    if (free_.size() > 1) {
      Change change = std::move(free_.back());
      free_.pop_back();
      return change;
    }
    return Change(free_.front()->Clone());
  }

  mutable std::mutex mutex_;
  mutable std::vector<Change> free_;
};

OGRSpatialReference parse(const std::string& wkt) {
  OGRSpatialReference crs;
  crs.importFromWkt(wkt.c_str());
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

std::unique_ptr<Changes> relate(const OGRSpatialReference& from, const OGRSpatialReference& to) {
  const GdalErrors errors;
  Change change(OGRCreateCoordinateTransformation(&from, &to));
  if (!change) throw Error(ErrorKind::input, "the CRS of the raster cannot be related to WGS 84" + errors.suffix());
  return std::make_unique<Changes>(std::move(change));
}

/// Null where nothing is known of what heights refer to.
std::unique_ptr<Changes> relate_heights(const OGRSpatialReference& from, const OGRSpatialReference& globe) {
  if (!from.IsCompound() && from.GetAxesCount() < 3) return nullptr;
  const GdalErrors quiet;
  OGRCoordinateTransformationOptions options;
  options.SetBallparkAllowed(false);
  Change change(OGRCreateCoordinateTransformation(&from, &globe, options));
  return change ? std::make_unique<Changes>(std::move(change)) : nullptr;
}

}  // namespace

struct GlobePlacement::Impl {
  std::array<double, 6> transform, inverse;
  std::unique_ptr<Changes> forth, back;  // null: the raster lies in WGS 84
  std::unique_ptr<Changes> heights;      // null: heights stay as they are
  double metres_per_unit = 1;            // of heights in the CRS
  double middle = 0;
  double turn = 0;                       // what a raster in degrees adds to longitudes near the middle

  double near_middle(double longitude) const { return longitude + 360 * std::round((middle - longitude) / 360); }
};

GlobePlacement::GlobePlacement(const GeoReference& geo, Size size) : impl_(std::make_unique<Impl>()) {
  if (!geo.transform) throw Error(ErrorKind::input, "the raster has no transform: nobody knows where on Earth its cells lie");
  if (geo.crs_wkt.empty()) throw Error(ErrorKind::input, "the raster has no CRS: nobody knows where on Earth it lies; give it one (gdal_translate -a_srs)");
  const auto& t = impl_->transform = *geo.transform;
  const double area = t[1] * t[5] - t[2] * t[4];
  if (!(std::abs(area) > 0)) throw Error(ErrorKind::input, "the transform of the raster cannot be inverted");
  impl_->inverse = {0, t[5] / area, -t[2] / area, 0, -t[4] / area, t[1] / area};

  OGRSpatialReference own = parse(geo.crs_wkt), flat = own, globe;
  globe.importFromEPSG(4326);
  globe.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (own.IsCompound()) flat.StripVertical();
  else if (own.GetAxesCount() == 3) flat.DemoteTo2D(nullptr);
  if (!same_horizontal_crs(geo.crs_wkt, crs_wkt("EPSG:4326"))) {
    impl_->forth = relate(flat, globe);
    impl_->back = relate(globe, flat);
  }
  OGRSpatialReference high;
  high.importFromEPSG(4979);
  high.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  impl_->metres_per_unit = vertical_unit("", geo.crs_wkt).metres;
  std::array<CellPlace, 1> middle{{{(static_cast<double>(size.width) - 1) / 2, (static_cast<double>(size.height) - 1) / 2, 0}}};
  std::array<GlobePlace, 1> place;
  impl_->heights = relate_heights(own, high);
  to_globe(middle, place);
  if (impl_->heights && !std::isfinite(place[0].height_m)) {
    impl_->heights.reset();
    to_globe(middle, place);
  }
  if (!std::isfinite(place[0].longitude)) throw Error(ErrorKind::input, "the middle of the raster has no place on WGS 84: its CRS or transform is wrong");
  impl_->middle = std::remainder(place[0].longitude, 360);
  if (!impl_->forth) {
    const double stated = t[0] + static_cast<double>(size.width) / 2 * t[1] + static_cast<double>(size.height) / 2 * t[2];
    impl_->turn = 360 * std::round((stated - impl_->middle) / 360);
  }
}

GlobePlacement::~GlobePlacement() = default;

bool GlobePlacement::ellipsoidal() const { return impl_->heights != nullptr; }

void GlobePlacement::to_globe(std::span<const CellPlace> from, std::span<GlobePlace> to) const {
  const auto& t = impl_->transform;
  std::vector<double> x(from.size()), y(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double column = from[i].column + 0.5, row = from[i].row + 0.5;
    x[i] = t[0] + column * t[1] + row * t[2];
    y[i] = t[3] + column * t[4] + row * t[5];
  }
  std::vector<double> z;
  if (impl_->heights) {
    std::vector<double> east = x, north = y;
    for (const CellPlace& place : from) z.push_back((std::isnan(place.height_m) ? 0 : place.height_m) / impl_->metres_per_unit);
    impl_->heights->apply(east, north, &z);
  }
  if (impl_->forth) impl_->forth->apply(x, y, nullptr);
  for (std::size_t i = 0; i < from.size(); ++i)
    to[i] = {impl_->near_middle(x[i]), y[i], std::isnan(from[i].height_m) || !impl_->heights ? from[i].height_m : z[i]};
}

void GlobePlacement::to_cells(std::span<const GlobePlace> from, std::span<CellPlace> to) const {
  std::vector<double> x(from.size()), y(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) x[i] = impl_->back ? std::remainder(from[i].longitude, 360) : from[i].longitude, y[i] = from[i].latitude;
  if (impl_->back) impl_->back->apply(x, y, nullptr);
  const auto &t = impl_->transform, &inverse = impl_->inverse;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double dx = x[i] + impl_->turn - t[0], dy = y[i] - t[3];
    to[i] = {dx * inverse[1] + dy * inverse[2] - 0.5, dx * inverse[4] + dy * inverse[5] - 0.5, from[i].height_m};
  }
}

}  // namespace arete
