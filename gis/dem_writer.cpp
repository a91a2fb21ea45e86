#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <vector>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "core/support/parallel.h"
#include "gis/dem_file.h"
#include "gis/gdal_errors.h"
#include "gis/staged_files.h"

namespace arete {
namespace {

constexpr double ascii_nodata = -9999;

std::string extension_of(const std::string& path) {
  const char* extension = CPLGetExtension(path.c_str());
  std::string lower = extension == nullptr ? "" : extension;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

bool has_word(const char* list, const std::string& word) {
  const CPLStringList words(CSLTokenizeString2(list == nullptr ? "" : list, " ", 0));
  return words.FindString(word.c_str()) >= 0;
}

bool writes_floats(GDALDriver& driver) {
  const bool writes = driver.GetMetadataItem(GDAL_DCAP_CREATECOPY) != nullptr || driver.GetMetadataItem(GDAL_DCAP_CREATE) != nullptr;
  return driver.GetMetadataItem(GDAL_DCAP_RASTER) != nullptr && writes &&
         has_word(driver.GetMetadataItem(GDAL_DMD_CREATIONDATATYPES), "Float32");
}

GDALDriver* driver_of_extension(const std::string& extension) {
  GDALDriverManager& drivers = *GetGDALDriverManager();
  if (extension == "tif" || extension == "tiff") return drivers.GetDriverByName("COG");
  for (int i = 0; i < drivers.GetDriverCount(); ++i) {
    GDALDriver& driver = *drivers.GetDriver(i);
    const char* extensions = driver.GetMetadataItem(GDAL_DMD_EXTENSIONS);
    if (extensions == nullptr) extensions = driver.GetMetadataItem(GDAL_DMD_EXTENSION);
    if (has_word(extensions, extension) && writes_floats(driver)) return &driver;
  }
  return nullptr;
}

GDALDriver& choose_driver(const std::string& path, const std::string& format) {
  if (!format.empty()) {
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(format.c_str());
    if (driver == nullptr)
      throw Error(ErrorKind::format, "cannot write '" + path + "': there is no format '" + format +
                                         "'; use GDAL's short names, as COG, GTiff, AAIGrid, ENVI, HFA");
    if (!writes_floats(*driver))
      throw Error(ErrorKind::format, "cannot write '" + path + "': the format " + format + " holds no elevations as 32-bit floats");
    return *driver;
  }
  GDALDriver* driver = extension_of(path).empty() ? nullptr : driver_of_extension(extension_of(path));
  if (driver == nullptr)
    throw Error(ErrorKind::format, "cannot write '" + path + "': no format with 32-bit floats has the extension '." +
                                       extension_of(path) + "'; use .tif, .asc, .img, or name a format");
  return *driver;
}

/// What a void becomes in the file.
float void_in_file(const GeoReference& geo, const GDALDriver& driver) {
  const double widest = std::numeric_limits<float>::max();
  if (geo.nodata && std::isfinite(*geo.nodata) && std::fabs(*geo.nodata) <= widest) return static_cast<float>(*geo.nodata);
  const bool ascii = EQUAL(driver.GetDescription(), "AAIGrid") || EQUAL(driver.GetDescription(), "GRASSASCIIGrid");
  return ascii ? static_cast<float>(ascii_nodata) : void_value;
}

/// The next float, away from the subnormal numbers, which some readers take for zero.
float beside_nodata(float nodata) {
  return nodata == 0 ? std::numeric_limits<float>::min() : std::nextafterf(nodata, std::numeric_limits<float>::max());
}

/// Shows GDAL's progress; an exception of the watcher stops GDAL and is kept.
struct WatchedProgress {
  Progress* progress = nullptr;
  std::int64_t shown = 0;
  std::exception_ptr stopped;

  static int CPL_STDCALL step(double share, const char*, void* data) {
    auto& watched = *static_cast<WatchedProgress*>(data);
    if (watched.progress == nullptr) return TRUE;
    const std::int64_t now = std::clamp<std::int64_t>(std::llround(share * 1000), watched.shown, 1000);
    try {
      watched.progress->advance(now - watched.shown);
    } catch (...) {
      watched.stopped = std::current_exception();
      return FALSE;
    }
    watched.shown = now;
    return TRUE;
  }
};

}  // namespace

struct DemWriter::Impl {
  Impl(const std::string& to, Size cells, const GeoReference& where, const DemWriteOptions& how);
  ~Impl() {
    const GdalErrors quiet;
    work.reset();
  }

  void create_work();
  void set_georeference();
  void set_bands();
  CPLStringList creation_options() const;
  void make_output(Progress* progress);
  [[noreturn]] void fail(const GdalErrors& errors, const std::string& what) const {
    throw Error(ErrorKind::disk, "cannot write '" + path + "': " + what + errors.suffix());
  }
  bool is_elevation(std::size_t band) const { return options.band_units.empty() || options.band_units[band] == "m"; }

  std::string path;
  Size size;
  GeoReference geo;
  DemWriteOptions options;
  GDALDriver* driver = nullptr;
  std::unique_ptr<StagedFiles> files;
  GDALDatasetUniquePtr work;  // uncompressed tiles, copied into the output's format at the end
  float nodata = void_value;
};

DemWriter::Impl::Impl(const std::string& to, Size cells, const GeoReference& where, const DemWriteOptions& how)
    : path(to), size(cells), geo(where), options(how) {
  assert(!options.bands.empty());
  assert(options.band_units.empty() || options.band_units.size() == options.bands.size());
  const GdalErrors quiet;
  if (path.rfind("/vsi", 0) == 0)
    throw Error(ErrorKind::usage, "cannot write '" + path + "': outputs go to local folders only");
  const std::int64_t most = std::numeric_limits<int>::max();
  if (size.width < 1 || size.height < 1 || size.width > most || size.height > most)
    throw Error(ErrorKind::format, "cannot write '" + path + "': no raster has " + std::to_string(size.width) + " x " +
                                       std::to_string(size.height) + " cells");
  driver = &choose_driver(path, options.format);
  nodata = void_in_file(geo, *driver);
  files = std::make_unique<StagedFiles>(path, options.overwrite);
  GDALSetCacheMax64(std::min<GIntBig>(GDALGetCacheMax64(), std::max<GIntBig>(options.memory_bytes, 1 << 20)));
  create_work();
}

void DemWriter::Impl::create_work() {
  const GdalErrors errors;
  CPLStringList layout;
  layout.SetNameValue("TILED", "YES");
  layout.SetNameValue("BLOCKXSIZE", "512");
  layout.SetNameValue("BLOCKYSIZE", "512");
  layout.SetNameValue("INTERLEAVE", "BAND");
  layout.SetNameValue("BIGTIFF", "IF_SAFER");
  layout.SetNameValue("SPARSE_OK", "TRUE");  // cells that are never written read as nodata
  GDALDriver* tiff = GetGDALDriverManager()->GetDriverByName("GTiff");
  work.reset(tiff->Create(files->scratch("work.tif").c_str(), static_cast<int>(size.width), static_cast<int>(size.height),
                          static_cast<int>(options.bands.size()), GDT_Float32, layout.List()));
  if (!work) fail(errors, "its temporary copy cannot be made");
  set_georeference();
  set_bands();
  if (errors.failed()) fail(errors, "its temporary copy cannot be made");
}

void DemWriter::Impl::set_georeference() {
  if (geo.registration == Registration::point) work->SetMetadataItem("AREA_OR_POINT", "Point");
  if (geo.transform) {
    std::array<double, 6> t = *geo.transform;
    work->SetGeoTransform(t.data());
  }
  if (!geo.crs_wkt.empty()) {
    OGRSpatialReference crs;
    if (crs.importFromWkt(geo.crs_wkt.c_str()) != OGRERR_NONE)
      throw Error(ErrorKind::input, "cannot write '" + path + "': its coordinate system is not valid WKT");
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    work->SetSpatialRef(&crs);
  }
  for (const auto& [name, value] : options.metadata) work->SetMetadataItem(name.c_str(), value.c_str());
  if (options.metadata.count("TIFFTAG_SOFTWARE") == 0) work->SetMetadataItem("TIFFTAG_SOFTWARE", "arete " ARETE_VERSION);
}

void DemWriter::Impl::set_bands() {
  for (std::size_t i = 0; i < options.bands.size(); ++i) {
    GDALRasterBand& band = *work->GetRasterBand(static_cast<int>(i) + 1);
    band.SetNoDataValue(static_cast<double>(nodata));
    band.SetDescription(options.bands[i].c_str());
    band.SetUnitType((is_elevation(i) ? geo.vertical_unit : options.band_units[i]).c_str());
  }
}

CPLStringList DemWriter::Impl::creation_options() const {
  CPLStringList list;
  const bool cog = EQUAL(driver->GetDescription(), "COG");
  if (!cog && !EQUAL(driver->GetDescription(), "GTiff")) return list;
  list.SetNameValue("COMPRESS", "DEFLATE");
  list.SetNameValue("PREDICTOR", cog ? "YES" : "3");
  list.SetNameValue("BIGTIFF", "IF_SAFER");
  list.SetNameValue("NUM_THREADS", std::to_string(resolve_threads(options.threads)).c_str());
  if (cog)
    list.SetNameValue("OVERVIEW_RESAMPLING", "AVERAGE");
  else
    list.SetNameValue("TILED", "YES");
  return list;
}

/// Copies the work into the output's format, in the staging folder.
void DemWriter::Impl::make_output(Progress* progress) {
  {
    const GdalErrors errors;
    work->FlushCache(true);
    work.reset();
    if (errors.failed()) fail(errors, "writing failed; is the disk full?");
  }
  const GdalErrors errors;
  const GDALDatasetUniquePtr source(GDALDataset::Open(files->scratch("work.tif").c_str(), GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR));
  if (!source) fail(errors, "its temporary copy cannot be read back");
  WatchedProgress watched{progress, 0, nullptr};
  if (progress != nullptr) progress->begin("writing", 1000);
  GDALDatasetUniquePtr output(driver->CreateCopy(files->staged().c_str(), source.get(), FALSE, creation_options().List(),
                                                 WatchedProgress::step, &watched));
  if (output) output->FlushCache(true);
  const bool made = output != nullptr;
  output.reset();
  if (watched.stopped) std::rethrow_exception(watched.stopped);
  if (progress != nullptr) progress->end();
  if (made && !errors.failed()) return;
  const bool refused = errors.number() == CPLE_NotSupported || errors.number() == CPLE_IllegalArg;
  if (refused)
    throw Error(ErrorKind::format, "cannot write '" + path + "' as " + driver->GetDescription() + errors.suffix());
  fail(errors, "writing failed; is the disk full?");
}

DemWriter::DemWriter(const std::string& path, Size size, const GeoReference& geo, const DemWriteOptions& options)
    : impl_(std::make_unique<Impl>(path, size, geo, options)) {}

DemWriter::~DemWriter() = default;

void DemWriter::write(int band, const Window& window, RasterView<const float> cells) {
  Impl& impl = *impl_;
  assert(impl.work && band >= 0 && static_cast<std::size_t>(band) < impl.options.bands.size());
  assert(window.x >= 0 && window.y >= 0 && window.x + window.width <= impl.size.width &&
         window.y + window.height <= impl.size.height && cells.width == window.width && cells.height == window.height);
  const double unit = impl.is_elevation(static_cast<std::size_t>(band)) ? impl.geo.metres_per_unit : 1;
  const float instead = beside_nodata(impl.nodata);
  const std::int64_t strip = std::max<std::int64_t>(1, (1 << 20) / std::max<std::int64_t>(1, window.width));
  std::vector<float> stored;
  for (std::int64_t y = 0; y < window.height; y += strip) {
    const std::int64_t rows = std::min(strip, window.height - y);
    stored.resize(static_cast<std::size_t>(rows * window.width));
    for (std::int64_t row = 0; row < rows; ++row) {
      const float* from = cells.row(y + row);
      float* to = stored.data() + row * window.width;
      for (std::int64_t x = 0; x < window.width; ++x) {
        const float value = unit == 1 ? from[x] : static_cast<float>(static_cast<double>(from[x]) / unit);
        to[x] = !std::isfinite(value) ? impl.nodata : value == impl.nodata ? instead : value;
      }
    }
    const GdalErrors errors;
    const CPLErr status = impl.work->GetRasterBand(band + 1)->RasterIO(
        GF_Write, static_cast<int>(window.x), static_cast<int>(window.y + y), static_cast<int>(window.width),
        static_cast<int>(rows), stored.data(), static_cast<int>(window.width), static_cast<int>(rows), GDT_Float32, 0, 0, nullptr);
    if (status != CE_None || errors.failed()) impl.fail(errors, "writing failed; is the disk full?");
  }
}

void DemWriter::commit(Progress* progress) {
  assert(impl_->work);
  impl_->make_output(progress);
  impl_->files->publish();
}

}  // namespace arete
