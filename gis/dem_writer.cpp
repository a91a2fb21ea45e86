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

bool writes(GDALDriver& driver, ValueType type) {
  const bool makes = driver.GetMetadataItem(GDAL_DCAP_CREATECOPY) != nullptr || driver.GetMetadataItem(GDAL_DCAP_CREATE) != nullptr;
  return driver.GetMetadataItem(GDAL_DCAP_RASTER) != nullptr && makes &&
         has_word(driver.GetMetadataItem(GDAL_DMD_CREATIONDATATYPES), std::string(name_of(type)));
}

GDALDriver* driver_of_extension(const std::string& extension, ValueType type) {
  GDALDriverManager& drivers = *GetGDALDriverManager();
  if (extension == "tif" || extension == "tiff") return drivers.GetDriverByName("COG");
  for (int i = 0; i < drivers.GetDriverCount(); ++i) {
    GDALDriver& driver = *drivers.GetDriver(i);
    const char* extensions = driver.GetMetadataItem(GDAL_DMD_EXTENSIONS);
    if (extensions == nullptr) extensions = driver.GetMetadataItem(GDAL_DMD_EXTENSION);
    if (has_word(extensions, extension) && writes(driver, type)) return &driver;
  }
  return nullptr;
}

GDALDriver& choose_driver(const std::string& path, const std::string& format, ValueType type) {
  const std::string type_name(name_of(type));
  if (!format.empty()) {
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(format.c_str());
    if (driver == nullptr)
      throw Error(ErrorKind::format, "cannot write '" + path + "': there is no format '" + format +
                                         "'; use GDAL's short names, as COG, GTiff, AAIGrid, ENVI, HFA");
    if (!writes(*driver, type))
      throw Error(ErrorKind::format, "cannot write '" + path + "': the format " + format + " holds no elevations as " + type_name);
    return *driver;
  }
  GDALDriver* driver = extension_of(path).empty() ? nullptr : driver_of_extension(extension_of(path), type);
  if (driver == nullptr)
    throw Error(ErrorKind::format, "cannot write '" + path + "': no format that holds " + type_name + " has the extension '." +
                                       extension_of(path) + "'; use .tif, .asc, .img, or name a format");
  return *driver;
}

/// What a void becomes in the file.
struct VoidCode {
  double value = void_value;
  bool ours = false;  ///< chosen here for want of a usable nodata value: a valid cell may have it as long as nothing is void
};

VoidCode void_code(const GeoReference& geo, const GDALDriver& driver, ValueType type) {
  const ValueRange range = range_of(type);
  if (is_integer(type)) {
    if (geo.nodata && holds(type, *geo.nodata)) return {*geo.nodata, false};
    return {range.lowest, true};
  }
  if (geo.nodata && *geo.nodata >= range.lowest && *geo.nodata <= range.highest) return {hold_to(type, *geo.nodata), false};
  const bool ascii = EQUAL(driver.GetDescription(), "AAIGrid") || EQUAL(driver.GetDescription(), "GRASSASCIIGrid");
  return {ascii ? ascii_nodata : double{void_value}, false};
}

/// Whether GDAL may be told this value: to a nodata value that is infinite in the band's type it finds every cell equal.
bool can_declare(ValueType type, double nodata) {
  if (is_integer(type) || std::isnan(nodata)) return !std::isinf(nodata);
  const ValueRange range = range_of(type);
  return nodata >= range.lowest && nodata <= range.highest;
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
  void set_elevation_band(GDALRasterBand& band) const;
  double in_file(double number);
  template <typename T, typename Convert>
  void write(int band, const Window& window, RasterView<const T> cells, const Convert& to_stored);
  void settle_nodata();
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
  VoidCode code;
  bool stored_numbers = false;    // write_stored was used: the nodata tag is to be the source's
  bool any_void = false;
  bool code_is_valid = false;     // a valid cell has the void code that was chosen here
  std::int64_t cells_written = 0;
};

DemWriter::Impl::Impl(const std::string& to, Size cells, const GeoReference& where, const DemWriteOptions& how)
    : path(to), size(cells), geo(where), options(how) {
  assert(!options.bands.empty());
  assert(std::isfinite(options.scale) && options.scale != 0 && std::isfinite(options.offset));
  assert(options.band_units.empty() || options.band_units.size() == options.bands.size());
  const GdalErrors quiet;
  if (path.rfind("/vsi", 0) == 0)
    throw Error(ErrorKind::usage, "cannot write '" + path + "': outputs go to local folders only");
  const std::int64_t most = std::numeric_limits<int>::max();
  if (size.width < 1 || size.height < 1 || size.width > most || size.height > most)
    throw Error(ErrorKind::format, "cannot write '" + path + "': no raster has " + std::to_string(size.width) + " x " +
                                       std::to_string(size.height) + " cells");
  driver = &choose_driver(path, options.format, options.type);
  code = void_code(geo, *driver, options.type);
  files = std::make_unique<StagedFiles>(path, options.overwrite);
  limit_block_cache(options.memory_bytes);
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
  // Cells that are never written read as nodata. Blocks of it are left out, unless they may turn out to be elevations.
  layout.SetNameValue("SPARSE_OK", code.ours ? "FALSE" : "TRUE");
  GDALDriver* tiff = GetGDALDriverManager()->GetDriverByName("GTiff");
  const GDALDataType type = GDALGetDataTypeByName(std::string(name_of(options.type)).c_str());
  work.reset(tiff->Create(files->scratch("work.tif").c_str(), static_cast<int>(size.width), static_cast<int>(size.height),
                          static_cast<int>(options.bands.size()), type, layout.List()));
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
  for (const auto& [name, value] : options.metadata)
    if (name != "AREA_OR_POINT") work->SetMetadataItem(name.c_str(), value.c_str());
  if (options.metadata.count("TIFFTAG_SOFTWARE") == 0) work->SetMetadataItem("TIFFTAG_SOFTWARE", "arete " ARETE_VERSION);
}

void DemWriter::Impl::set_bands() {
  for (std::size_t i = 0; i < options.bands.size(); ++i) {
    GDALRasterBand& band = *work->GetRasterBand(static_cast<int>(i) + 1);
    band.SetNoDataValue(code.value);
    band.SetDescription(options.bands[i].c_str());
    if (is_elevation(i))
      set_elevation_band(band);
    else
      band.SetUnitType(options.band_units[i].c_str());
  }
  for (const auto& [name, value] : options.band_metadata) work->GetRasterBand(1)->SetMetadataItem(name.c_str(), value.c_str());
}

void DemWriter::Impl::set_elevation_band(GDALRasterBand& band) const {
  band.SetUnitType(options.unit.value_or(geo.vertical_unit).c_str());
  if (options.scale == 1 && options.offset == 0) return;
  band.SetScale(options.scale);
  band.SetOffset(options.offset);
}

/// The value of the file's type that a stored number becomes.
double DemWriter::Impl::in_file(double number) {
  if (!std::isfinite(number)) {
    any_void = true;
    return code.value;
  }
  const double held = hold_to(options.type, number);
  if (held != code.value) return held;
  if (!code.ours) return next_value(options.type, held);
  code_is_valid = true;
  return held;
}

template <typename T, typename Convert>
void DemWriter::Impl::write(int band, const Window& window, RasterView<const T> cells, const Convert& to_stored) {
  assert(work && band >= 0 && static_cast<std::size_t>(band) < options.bands.size());
  assert(window.x >= 0 && window.y >= 0 && window.x + window.width <= size.width && window.y + window.height <= size.height &&
         cells.width == window.width && cells.height == window.height);
  const std::int64_t strip = std::max<std::int64_t>(1, (1 << 20) / std::max<std::int64_t>(1, window.width));
  std::vector<double> stored;
  for (std::int64_t y = 0; y < window.height; y += strip) {
    const std::int64_t rows = std::min(strip, window.height - y);
    stored.resize(static_cast<std::size_t>(rows * window.width));
    for (std::int64_t row = 0; row < rows; ++row) {
      const T* from = cells.row(y + row);
      double* to = stored.data() + row * window.width;
      for (std::int64_t x = 0; x < window.width; ++x) to[x] = in_file(to_stored(from[x]));
    }
    const GdalErrors errors;
    const CPLErr status = work->GetRasterBand(band + 1)->RasterIO(
        GF_Write, static_cast<int>(window.x), static_cast<int>(window.y + y), static_cast<int>(window.width),
        static_cast<int>(rows), stored.data(), static_cast<int>(window.width), static_cast<int>(rows), GDT_Float64, 0, 0, nullptr);
    if (status != CE_None || errors.failed()) fail(errors, "writing failed; is the disk full?");
  }
  cells_written += window.size().cells();
}

/// Now it is known whether anything is void: gives the file the nodata value that it needs, or the source's own.
void DemWriter::Impl::settle_nodata() {
  const bool voids = any_void || cells_written < size.cells() * static_cast<std::int64_t>(options.bands.size());
  if (voids && code.ours && code_is_valid)
    throw Error(ErrorKind::format, "cannot write '" + path + "' as " + std::string(name_of(options.type)) +
                                       ": it has voids, no usable nodata value, and elevations of " +
                                       std::to_string(std::llround(code.value)) +
                                       ", the lowest of its type; declare a nodata value that no cell has, or write a wider type");
  if (!stored_numbers && !code.ours) return;
  const bool exact = geo.nodata && can_declare(options.type, *geo.nodata) &&
                     (!voids || (!code.ours && hold_to(options.type, *geo.nodata) == code.value));
  const GdalErrors errors;
  // Closed first: GDAL fills blocks that it left out with the nodata value that it has then.
  work.reset();
  work.reset(GDALDataset::Open(files->scratch("work.tif").c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE | GDAL_OF_VERBOSE_ERROR));
  if (!work || errors.failed()) fail(errors, "writing failed; is the disk full?");
  for (int band = 1; band <= work->GetRasterCount(); ++band) {
    if (exact) work->GetRasterBand(band)->SetNoDataValue(*geo.nodata);
    if (!exact && !voids) work->GetRasterBand(band)->DeleteNoDataValue();
  }
  if (errors.failed()) fail(errors, "its nodata value cannot be set");
}

CPLStringList DemWriter::Impl::creation_options() const {
  CPLStringList list;
  const bool cog = EQUAL(driver->GetDescription(), "COG");
  if (!cog && !EQUAL(driver->GetDescription(), "GTiff")) return list;
  list.SetNameValue("COMPRESS", "DEFLATE");
  list.SetNameValue("PREDICTOR", cog ? "YES" : is_integer(options.type) ? "2" : "3");
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
  if (!impl.is_elevation(static_cast<std::size_t>(band)))
    return impl.write(band, window, cells, [](float value) { return double{value}; });
  const double unit = impl.geo.metres_per_unit, scale = impl.options.scale, offset = impl.options.offset;
  const double most = range_of(impl.options.type).highest;
  const bool integer = is_integer(impl.options.type);
  impl.write(band, window, cells, [=](float metres) {
    const double number = (static_cast<double>(metres) / unit - offset) / scale;
    return integer || std::fabs(number) <= most ? number : double{void_value};  // no float holds it
  });
}

void DemWriter::write_stored(const Window& window, RasterView<const double> cells) {
  impl_->stored_numbers = true;
  impl_->write(0, window, cells, [](double number) { return number; });
}

void DemWriter::commit(Progress* progress) {
  assert(impl_->work);
  impl_->settle_nodata();
  impl_->make_output(progress);
  impl_->files->publish();
}

}  // namespace arete
