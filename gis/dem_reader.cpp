#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <vector>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "gis/dem_file.h"
#include "gis/gdal_errors.h"
#include "gis/geodesy.h"
#include "gis/vertical_unit.h"

namespace arete {
namespace {

constexpr double huge_nodata = 1e30;         // beyond it a declared value may be rounded: 1.70141e+38 stands for 2^127
constexpr double huge_nodata_share = 2e-6;   // six significant digits
constexpr double exact_integers = 9007199254740992.0;  // 2^53: from here on doubles skip integers
constexpr std::int64_t strip_cells = 1 << 20;
constexpr double void_number = std::numeric_limits<double>::quiet_NaN();

/// Which stored values are void.
struct NodataTest {
  bool declared = false;
  double value = 0;
  bool as_float = false;  // the file holds floats: compare what the declared value becomes as one

  bool operator()(double stored) const {
    if (!declared) return false;
    if (std::fabs(value) >= huge_nodata) return std::fabs(stored - value) <= huge_nodata_share * std::fabs(value);
    return as_float ? static_cast<float>(stored) == static_cast<float>(value) : stored == value;
  }
};

GDALDatasetUniquePtr open_raster(const std::string& path) {
  // A GeoTIFF of version 1.0 may hold a vertical CRS, which GDAL then leaves out unless told.
  const CPLConfigOptionSetter keep_vertical("GTIFF_REPORT_COMPD_CS", "YES", true);
  const GdalErrors errors;
  GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
  if (dataset) return dataset;
  VSIStatBufL status;
  const bool is_there = VSIStatL(path.c_str(), &status) == 0;
  if (!is_there && path.find(':') == std::string::npos)
    throw Error(ErrorKind::input, "cannot read '" + path + "': no such file");
  if (is_there && VSI_ISDIR(status.st_mode) && errors.message().find("not recognized") != std::string::npos)
    throw Error(ErrorKind::input, "cannot read '" + path + "': it is a folder, not a raster");
  if (errors.message().find("not recognized") != std::string::npos)
    throw Error(ErrorKind::input, "cannot read '" + path + "': not a raster in a format that GDAL knows, or damaged at its beginning");
  throw Error(ErrorKind::input, "cannot read '" + path + "' as a raster" + errors.suffix());
}

/// Refuses what has no cells, and names the parts of a container that holds several rasters.
void check_cells(GDALDataset& dataset, const std::string& path) {
  if (dataset.GetRasterCount() > 0 && dataset.GetRasterXSize() > 0 && dataset.GetRasterYSize() > 0) return;
  const CPLStringList parts(dataset.GetMetadata("SUBDATASETS"), FALSE);
  if (const char* first = parts.FetchNameValue("SUBDATASET_1_NAME"))
    throw Error(ErrorKind::input, "'" + path + "' holds several rasters; name one of them, as '" + first + "'");
  throw Error(ErrorKind::input, "'" + path + "' holds no raster: " + std::to_string(dataset.GetRasterXSize()) + " x " +
                                    std::to_string(dataset.GetRasterYSize()) + " cells, " +
                                    std::to_string(dataset.GetRasterCount()) + " bands");
}

void check_block(GDALDataset& dataset, GDALRasterBand& band, const std::string& path, std::int64_t max_bytes) {
  int width = 0, height = 0;
  band.GetBlockSize(&width, &height);
  const char* interleave = dataset.GetMetadataItem("INTERLEAVE", "IMAGE_STRUCTURE");
  const double bands = interleave != nullptr && EQUAL(interleave, "PIXEL") ? dataset.GetRasterCount() : 1;
  const double bytes = static_cast<double>(width) * height * GDALGetDataTypeSizeBytes(band.GetRasterDataType()) * bands;
  if (bytes <= static_cast<double>(max_bytes)) return;
  throw Error(ErrorKind::memory, "'" + path + "' can only be read in blocks of " + std::to_string(width) + " x " +
                                     std::to_string(height) + " cells, " + std::to_string(std::llround(bytes / 1e6)) +
                                     " MB each, more than the " + std::to_string(max_bytes / 1000000) +
                                     " MB allowed; rewrite it in tiles (gdal_translate -co TILED=YES)");
}

/// GDAL reads the missing end of a raw raster (ENVI, EHdr...) as zeros: sea level.
void check_raw_length(GDALDataset& dataset, const std::string& path) {
  GDALDataset::RawBinaryLayout raw;
  VSIStatBufL status;
  if (!dataset.GetRawBinaryLayout(raw) || VSIStatL(raw.osRawFilename.c_str(), &status) != 0) return;
  if (raw.nPixelOffset < 0 || raw.nLineOffset < 0 || raw.nBandOffset < 0) return;
  const auto last = [](std::int64_t count, GIntBig step) { return static_cast<double>(count - 1) * static_cast<double>(step); };
  const double expected = static_cast<double>(raw.nImageOffset) + last(dataset.GetRasterCount(), raw.nBandOffset) +
                          last(dataset.GetRasterYSize(), raw.nLineOffset) + last(dataset.GetRasterXSize(), raw.nPixelOffset) +
                          GDALGetDataTypeSizeBytes(raw.eDataType);
  if (static_cast<double>(status.st_size) >= expected) return;
  throw Error(ErrorKind::input, "'" + path + "' is cut short: " + std::to_string(std::llround(expected)) + " bytes expected in '" +
                                    raw.osRawFilename + "', " + std::to_string(status.st_size) + " found");
}

NodataTest nodata_test(GDALRasterBand& band) {
  NodataTest test;
  int declared = FALSE;
  const GDALDataType type = band.GetRasterDataType();
  if (type == GDT_Int64)
    test.value = static_cast<double>(band.GetNoDataValueAsInt64(&declared));
  else if (type == GDT_UInt64)
    test.value = static_cast<double>(band.GetNoDataValueAsUInt64(&declared));
  else
    test.value = band.GetNoDataValue(&declared);
  test.declared = declared != FALSE;
  test.as_float = type == GDT_Float32;
  return test;
}

/// The transform, or nothing where the file has none (GDAL then gives the identity).
std::optional<std::array<double, 6>> transform_of(GDALDataset& dataset) {
  std::array<double, 6> t{};
  if (dataset.GetGeoTransform(t.data()) != CE_None) return std::nullopt;
  if (t == std::array<double, 6>{0, 1, 0, 0, 0, 1}) return std::nullopt;
  for (double v : t)
    if (!std::isfinite(v)) return std::nullopt;
  return t;
}

std::string wkt_of(const OGRSpatialReference* crs) {
  if (crs == nullptr) return "";
  // What GDAL makes of a GeoTIFF that is tagged pixel-is-point and has no CRS.
  if (crs->IsLocal() && crs->GetName() != nullptr && EQUAL(crs->GetName(), "unnamed") && crs->GetLinearUnits() == 1) return "";
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  char* text = nullptr;
  std::string wkt;
  if (crs->exportToWkt(&text, options) == OGRERR_NONE && text != nullptr) wkt = text;
  CPLFree(text);
  return wkt;
}

std::map<std::string, std::string> metadata_of(GDALMajorObject& object) {
  std::map<std::string, std::string> items;
  for (CSLConstList item = object.GetMetadata(); item != nullptr && *item != nullptr; ++item) {
    const std::string text = *item;
    const auto equals = text.find('=');
    if (equals != std::string::npos) items[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return items;
}

/// Without the statistics of programs that looked at the file: they are of its cells, and a copy's cells may be others.
std::map<std::string, std::string> metadata_of_band(GDALRasterBand& band) {
  std::map<std::string, std::string> items = metadata_of(band);
  std::erase_if(items, [](const auto& item) { return item.first.rfind("STATISTICS_", 0) == 0; });
  return items;
}

/// GDAL up to 3.6 calls signed bytes "Byte" and gives them without their sign.
bool holds_signed_bytes(GDALRasterBand& band) {
  const char* kind = band.GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
  return band.GetRasterDataType() == GDT_Byte && kind != nullptr && EQUAL(kind, "SIGNEDBYTE");
}

}  // namespace

struct DemReader::Impl {
  std::string path;
  DemReadOptions options;
  GDALDatasetUniquePtr dataset;
  GDALRasterBand* band = nullptr;
  Size size;
  GeoReference geo;
  DemDescription about;
  NodataTest is_nodata;
  bool signed_bytes = false;
  bool wide_integers = false;  // 64 bits
  mutable std::mutex one_at_a_time;

  void choose_band();
  void describe();
  void georeference();
  void fetch(GDALRasterBand& from, const Window& window, void* to, GDALDataType type) const;
  std::vector<double> fetch_numbers(const Window& window) const;
  std::vector<double> stored(const Window& window) const;
  double metres(double number) const { return (number * about.scale + about.offset) * geo.metres_per_unit; }
  double checked(double number) const;
  template <typename T, typename Convert>
  void read(const Window& window, RasterView<T> out, const Convert& convert) const;
  ValueType narrowest_type() const;
};

void DemReader::Impl::choose_band() {
  const int count = dataset->GetRasterCount();
  if (options.terrain_rgb) {
    if (count < 3)
      throw Error(ErrorKind::input, "'" + path + "' is no terrain-RGB picture: 3 bands of 8 bits expected, " + std::to_string(count) +
                                        " found");
    for (int i = 1; i <= 3; ++i)
      if (dataset->GetRasterBand(i)->GetRasterDataType() != GDT_Byte)
        throw Error(ErrorKind::input, "'" + path + "' is no terrain-RGB picture: 8-bit bands expected, band " + std::to_string(i) +
                                          " is " + GDALGetDataTypeName(dataset->GetRasterBand(i)->GetRasterDataType()));
    options.band = 1;
  }
  if (options.band < 1 || options.band > count)
    throw Error(ErrorKind::input, "'" + path + "' has no band " + std::to_string(options.band) + ": it has " +
                                      std::to_string(count) + (count == 1 ? " band" : " bands, counted from 1"));
  band = dataset->GetRasterBand(options.band);
  if (GDALDataTypeIsComplex(band->GetRasterDataType()))
    throw Error(ErrorKind::format, "band " + std::to_string(options.band) + " of '" + path + "' holds complex numbers (" +
                                       GDALGetDataTypeName(band->GetRasterDataType()) + "), not elevations");
}

void DemReader::Impl::describe() {
  about.driver = dataset->GetDriver() != nullptr ? dataset->GetDriver()->GetDescription() : "";
  about.data_type = GDALGetDataTypeName(band->GetRasterDataType());
  about.bands = dataset->GetRasterCount();
  for (int i = 1; i <= about.bands; ++i) about.band_names.emplace_back(dataset->GetRasterBand(i)->GetDescription());
  about.metadata = metadata_of(*dataset);
  about.band_metadata = metadata_of_band(*band);
  about.unit = options.terrain_rgb ? "m" : band->GetUnitType();
  signed_bytes = holds_signed_bytes(*band);
  wide_integers = band->GetRasterDataType() == GDT_Int64 || band->GetRasterDataType() == GDT_UInt64;
  // A mask that GDAL derives from the nodata value is ours to test; only a stored one is read.
  about.masked = (band->GetMaskFlags() & (GMF_ALL_VALID | GMF_NODATA)) == 0;
  if (options.terrain_rgb) return;
  is_nodata = nodata_test(*band);
  about.nodata_declared = is_nodata.declared;
  int given = FALSE;
  const double scale = band->GetScale(&given);
  if (given && std::isfinite(scale) && scale != 0) about.scale = scale;
  const double offset = band->GetOffset(&given);
  if (given && std::isfinite(offset)) about.offset = offset;
}

void DemReader::Impl::georeference() {
  size = {dataset->GetRasterXSize(), dataset->GetRasterYSize()};
  geo.transform = transform_of(*dataset);
  if (geo.transform) {
    auto& t = *geo.transform;
    about.south_up = t[2] == 0 && t[4] == 0 && t[5] > 0;
    if (about.south_up) {
      t[3] += static_cast<double>(size.height) * t[5];
      t[5] = -t[5];
    }
  }
  geo.crs_wkt = wkt_of(dataset->GetSpatialRef());
  const char* registration = dataset->GetMetadataItem("AREA_OR_POINT");
  if (registration != nullptr && EQUAL(registration, "Point")) geo.registration = Registration::point;
  if (is_nodata.declared) geo.nodata = is_nodata.value;
  about.unit_stated = options.terrain_rgb;  // its formula gives metres
  if (options.terrain_rgb) return;
  const VerticalUnit unit = vertical_unit(band->GetUnitType(), geo.crs_wkt);
  geo.vertical_unit = unit.name;
  geo.metres_per_unit = unit.metres;
  about.unit_known = unit.known;
  about.unit_stated = unit.stated;
}

void DemReader::Impl::fetch(GDALRasterBand& from, const Window& w, void* to, GDALDataType type) const {
  const GdalErrors errors;
  const CPLErr status = from.RasterIO(GF_Read, static_cast<int>(w.x), static_cast<int>(w.y), static_cast<int>(w.width),
                                      static_cast<int>(w.height), to, static_cast<int>(w.width), static_cast<int>(w.height), type,
                                      0, 0, nullptr);
  if (status == CE_None && !errors.failed()) return;
  throw Error(ErrorKind::input, "cannot read rows " + std::to_string(w.y) + " to " + std::to_string(w.y + w.height - 1) + " of '" +
                                    path + "', which may be damaged or cut short" + errors.suffix());
}

/// The numbers of the band, or the metres of a terrain-RGB picture; the file's rows in its own order.
std::vector<double> DemReader::Impl::fetch_numbers(const Window& window) const {
  const auto cells = static_cast<std::size_t>(window.size().cells());
  std::vector<double> numbers(cells);
  fetch(*band, window, numbers.data(), GDT_Float64);
  if (signed_bytes)
    for (double& number : numbers) number = number > 127 ? number - 256 : number;
  if (!options.terrain_rgb) return numbers;
  std::vector<double> green(cells), blue(cells);
  fetch(*dataset->GetRasterBand(2), window, green.data(), GDT_Float64);
  fetch(*dataset->GetRasterBand(3), window, blue.data(), GDT_Float64);
  for (std::size_t i = 0; i < cells; ++i) numbers[i] = -10000 + (numbers[i] * 65536 + green[i] * 256 + blue[i]) * 0.1;
  return numbers;
}

/// The same, with NaN for all that is void.
std::vector<double> DemReader::Impl::stored(const Window& window) const {
  std::vector<double> numbers = fetch_numbers(window);
  for (double& number : numbers)
    if (is_nodata(number) || !(std::fabs(metres(number)) <= std::numeric_limits<float>::max())) number = void_number;
  if (!about.masked) return numbers;
  std::vector<std::uint8_t> valid(numbers.size());
  fetch(*band->GetMaskBand(), window, valid.data(), GDT_Byte);
  for (std::size_t i = 0; i < valid.size(); ++i)
    if (valid[i] == 0) numbers[i] = void_number;
  return numbers;
}

/// What a number of 64 bits is, if that is certain.
double DemReader::Impl::checked(double number) const {
  if (options.terrain_rgb) return hold_to(ValueType::float32, number);
  if (!wide_integers || !(std::fabs(number) >= exact_integers)) return number;
  throw Error(ErrorKind::format, "'" + path + "' holds integers of 2^53 or more (" + about.data_type +
                                     "), which cannot be kept exactly; convert it to Float64 first (gdal_translate -ot Float64)");
}

/// By strips of about a million cells, ended where the file's blocks end so that no block is decoded twice.
template <typename T, typename Convert>
void DemReader::Impl::read(const Window& window, RasterView<T> out, const Convert& convert) const {
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  int block_width = 1, block_height = 1;
  band->GetBlockSize(&block_width, &block_height);
  std::int64_t rows = std::max<std::int64_t>(1, strip_cells / std::max<std::int64_t>(1, window.width));
  if (rows > block_height) rows -= rows % block_height;
  const bool turned = about.south_up;
  const std::int64_t first = turned ? size.height - window.y - window.height : window.y;
  for (std::int64_t done = 0; done < window.height;) {
    const std::int64_t y = first + done;
    const std::int64_t height = std::min(window.height - done, rows - y % rows);
    const std::vector<double> numbers = stored({window.x, y, window.width, height});
    for (std::int64_t row = 0; row < height; ++row) {
      const double* from = numbers.data() + row * window.width;
      T* to = out.row(turned ? window.height - 1 - done - row : done + row);
      std::transform(from, from + window.width, to, convert);
    }
    done += height;
  }
}

/// Of a band of 64-bit integers: looks at all its cells.
ValueType DemReader::Impl::narrowest_type() const {
  double lowest = 0, highest = 0;
  bool any = false, voids = false;
  const std::int64_t rows = std::max<std::int64_t>(1, strip_cells / size.width);
  Raster<double> strip(size.width, std::min(rows, size.height));
  for (std::int64_t y = 0; y < size.height; y += rows) {
    const std::int64_t height = std::min(rows, size.height - y);
    read({0, y, size.width, height}, strip.view(), [this](double number) { return checked(number); });
    for (std::int64_t i = 0; i < size.width * height; ++i) {
      const double number = strip.data()[i];
      voids = voids || std::isnan(number);
      if (std::isnan(number)) continue;
      lowest = any ? std::min(lowest, number) : number;
      highest = any ? std::max(highest, number) : number;
      any = true;
    }
  }
  for (const ValueType type : {ValueType::uint8, ValueType::int16, ValueType::uint16, ValueType::int32, ValueType::uint32}) {
    const ValueRange range = range_of(type);
    const bool room = !voids || (is_nodata.declared && holds(type, is_nodata.value)) || range.lowest < lowest;
    if (room && range.lowest <= lowest && highest <= range.highest) return type;
  }
  return ValueType::float64;
}

DemReader::DemReader(const std::string& path, const DemReadOptions& options) : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  impl_->options = options;
  impl_->dataset = open_raster(path);
  const GdalErrors quiet;
  check_cells(*impl_->dataset, path);
  impl_->choose_band();
  check_raw_length(*impl_->dataset, path);
  check_block(*impl_->dataset, *impl_->band, path, options.max_block_bytes);
  impl_->describe();
  impl_->georeference();
}

DemReader::~DemReader() {
  const GdalErrors quiet;
  impl_.reset();
}

Size DemReader::size() const { return impl_->size; }
const GeoReference& DemReader::georeference() const { return impl_->geo; }
CellSize DemReader::cell_size() const { return arete::cell_size(impl_->geo, impl_->size); }
const std::string& DemReader::path() const { return impl_->path; }
std::string DemReader::data_type() const { return impl_->about.data_type; }
const DemDescription& DemReader::description() const { return impl_->about; }

ValueType DemReader::value_type() const {
  if (impl_->options.terrain_rgb) return ValueType::float32;
  if (impl_->signed_bytes) return ValueType::int16;
  if (impl_->wide_integers) return impl_->narrowest_type();
  if (const auto type = value_type_named(impl_->about.data_type)) return *type;
  throw Error(ErrorKind::format, "'" + impl_->path + "' stores its elevations as " + impl_->about.data_type +
                                     ", a type that is not known here; convert it first (gdal_translate -ot Float32)");
}

void DemReader::read(const Window& window, RasterView<float> out) const {
  const Impl& impl = *impl_;
  impl.read(window, out, [&](double number) { return static_cast<float>(impl.metres(number)); });
}

void DemReader::read_stored(const Window& window, RasterView<double> out) const {
  const Impl& impl = *impl_;
  impl.read(window, out, [&](double number) { return impl.checked(number); });
}

void limit_block_cache(std::int64_t bytes) {
  GDALSetCacheMax64(std::min<GIntBig>(GDALGetCacheMax64(), std::max<GIntBig>(bytes, 1 << 20)));
}

}  // namespace arete
