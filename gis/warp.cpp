#include "gis/warp.h"

#include <algorithm>
#include <array>
#include <exception>
#include <limits>
#include <mutex>
#include <utility>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <gdalwarper.h>
#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "gis/alignment.h"
#include "gis/gdal_errors.h"

namespace arete {
namespace {

constexpr int block_side = 512;

/// Lets GDAL read a RasterSource as one band of floats.
class SourceBand final : public GDALRasterBand {
 public:
  SourceBand(const RasterSource& source, std::exception_ptr& failure) : source_(source), failure_(failure) {
    const Size size = source.size();
    eDataType = GDT_Float32;
    nBlockXSize = static_cast<int>(std::min<std::int64_t>(block_side, size.width));
    nBlockYSize = static_cast<int>(std::min<std::int64_t>(block_side, size.height));
  }
  double GetNoDataValue(int* declared) override {
    if (declared != nullptr) *declared = TRUE;
    return std::numeric_limits<double>::quiet_NaN();
  }

 protected:
  CPLErr IReadBlock(int column, int row, void* cells) override {
    const Size size = source_.size();
    const std::int64_t x = static_cast<std::int64_t>(column) * nBlockXSize, y = static_cast<std::int64_t>(row) * nBlockYSize;
    const Window window{x, y, std::min<std::int64_t>(nBlockXSize, size.width - x), std::min<std::int64_t>(nBlockYSize, size.height - y)};
    try {
      source_.read(window, {static_cast<float*>(cells), window.width, window.height, nBlockXSize});
    } catch (...) {
      // No exception may cross GDAL.
      failure_ = std::current_exception();
      return CE_Failure;
    }
    return CE_None;
  }

 private:
  const RasterSource& source_;
  std::exception_ptr& failure_;
};

class SourceDataset final : public GDALDataset {
 public:
  SourceDataset(const RasterSource& source, const GeoReference& geo, std::exception_ptr& failure) : transform_(*geo.transform) {
    nRasterXSize = static_cast<int>(source.size().width);
    nRasterYSize = static_cast<int>(source.size().height);
    SetBand(1, new SourceBand(source, failure));
  }
  CPLErr GetGeoTransform(double* transform) override {
    std::copy(transform_.begin(), transform_.end(), transform);
    return CE_None;
  }

 private:
  std::array<double, 6> transform_;
};

/// What the warper needs, as long as it needs it.
struct WarpSettings {
  GDALWarpOptions* options = GDALCreateWarpOptions();
  ~WarpSettings() { GDALDestroyWarpOptions(options); }
};

}  // namespace

struct WarpedSource::Impl {
  Size size;
  std::exception_ptr failure;
  std::unique_ptr<SourceDataset> from;
  GDALDatasetUniquePtr warped;
  mutable std::mutex one_at_a_time;

  // The warped dataset holds a reference to the other: it goes first.
  ~Impl() { warped.reset(); }
};

WarpedSource::WarpedSource(const RasterSource& source, const GeoReference& from, const GeoReference& to, Size size)
    : impl_(std::make_unique<Impl>()) {
  const GdalErrors errors;
  impl_->size = size;
  impl_->from = std::make_unique<SourceDataset>(source, from, impl_->failure);
  CPLStringList how;
  const bool transform_crs =
      !from.crs_wkt.empty() && !to.crs_wkt.empty() && !same_horizontal_crs(from.crs_wkt, to.crs_wkt);
  if (transform_crs) {
    how.SetNameValue("SRC_SRS", from.crs_wkt.c_str());
    how.SetNameValue("DST_SRS", to.crs_wkt.c_str());
    // Heights stay as they are.
    how.SetNameValue("STRIP_VERT_CS", "YES");
  }
  WarpSettings settings;
  GDALWarpOptions& w = *settings.options;
  w.eResampleAlg = GRA_Cubic;
  w.eWorkingDataType = GDT_Float32;
  w.hSrcDS = GDALDataset::ToHandle(impl_->from.get());
  GDALWarpInitDefaultBandMapping(&w, 1);
  GDALWarpInitSrcNoDataReal(&w, std::numeric_limits<double>::quiet_NaN());
  GDALWarpInitDstNoDataReal(&w, std::numeric_limits<double>::quiet_NaN());
  w.papszWarpOptions = CSLSetNameValue(w.papszWarpOptions, "INIT_DEST", "NO_DATA");
  w.pfnTransformer = GDALGenImgProjTransform;
  w.pTransformerArg = GDALCreateGenImgProjTransformer2(w.hSrcDS, nullptr, how.List());
  if (w.pTransformerArg == nullptr)
    throw Error(ErrorKind::input, "cannot relate the CRS of the result to that of the reference" + errors.suffix());
  std::array<double, 6> transform = *to.transform;
  GDALSetGenImgProjTransformerDstGeoTransform(w.pTransformerArg, transform.data());
  impl_->warped.reset(GDALDataset::FromHandle(GDALCreateWarpedVRT(w.hSrcDS, static_cast<int>(size.width),
                                                                  static_cast<int>(size.height), transform.data(), &w)));
  if (!impl_->warped) throw Error(ErrorKind::input, "cannot resample the result onto the reference's grid" + errors.suffix());
}

WarpedSource::~WarpedSource() = default;

Size WarpedSource::size() const { return impl_->size; }

void WarpedSource::read(const Window& window, RasterView<float> out) const {
  const std::lock_guard lock(impl_->one_at_a_time);
  const GdalErrors errors;
  const CPLErr status = impl_->warped->GetRasterBand(1)->RasterIO(
      GF_Read, static_cast<int>(window.x), static_cast<int>(window.y), static_cast<int>(window.width),
      static_cast<int>(window.height), out.data, static_cast<int>(window.width), static_cast<int>(window.height), GDT_Float32,
      sizeof(float), out.stride * static_cast<GSpacing>(sizeof(float)), nullptr);
  if (impl_->failure) std::rethrow_exception(std::exchange(impl_->failure, nullptr));
  if (status != CE_None) throw Error(ErrorKind::input, "cannot resample the result" + errors.suffix());
}

}  // namespace arete
