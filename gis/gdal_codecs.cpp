// The codecs that are reached through GDAL: its drivers JP2OpenJPEG and GTiff, encoding to memory and decoding from it.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>

#include "core/support/error.h"
#include "gis/gdal_errors.h"
#include "gis/peer_codecs.h"

namespace arete {
namespace {

constexpr std::int32_t highest_16_bits = 65535;

// Of the relief; finer ones give files of more than 8 bits per sample on any terrain.
constexpr double finest_bound = 2e-5;

double relief_of(const TestedTerrain& terrain) { return static_cast<double>(terrain.high) - static_cast<double>(terrain.low); }

/// A file of GDAL's in memory, under a name of its own, gone with this.
class MemoryName {
 public:
  explicit MemoryName(const std::string& extension) {
    static std::atomic<int> count{0};
    name_ = "/vsimem/arete-codec-" + std::to_string(++count) + extension;
  }
  ~MemoryName() { VSIUnlink(name_.c_str()); }
  MemoryName(const MemoryName&) = delete;
  MemoryName& operator=(const MemoryName&) = delete;
  const char* c_str() const { return name_.c_str(); }

 private:
  std::string name_;
};

/// While it lives GDAL's codecs called from this thread use so many threads.
class GdalThreads {
 public:
  explicit GdalThreads(int threads) { CPLSetThreadLocalConfigOption("GDAL_NUM_THREADS", std::to_string(threads).c_str()); }
  ~GdalThreads() { CPLSetThreadLocalConfigOption("GDAL_NUM_THREADS", nullptr); }
  GdalThreads(const GdalThreads&) = delete;
  GdalThreads& operator=(const GdalThreads&) = delete;
};

/// Cells as a driver takes them.
struct DriverInput {
  void* cells = nullptr;
  GDALDataType type = GDT_Float32;
  Size size;
  std::optional<double> nodata = std::nullopt;
};

GDALDatasetUniquePtr wrap_cells(const DriverInput& input) {
  GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
  GDALDatasetUniquePtr data(memory->Create("", static_cast<int>(input.size.width), static_cast<int>(input.size.height), 0, input.type, nullptr));
  char pointer[64] = {};
  pointer[CPLPrintPointer(pointer, input.cells, sizeof pointer - 1)] = '\0';
  CPLStringList options;
  options.SetNameValue("DATAPOINTER", pointer);
  data->AddBand(input.type, options.List());
  if (input.nodata) data->GetRasterBand(1)->SetNoDataValue(*input.nodata);
  return data;
}

std::vector<std::byte> encode_with(const char* driver_name, const char* extension, const DriverInput& input, const CPLStringList& options, int threads) {
  const GdalErrors errors;
  const GdalThreads held(threads);
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(driver_name);
  if (driver == nullptr) throw Error(ErrorKind::format, std::string("this GDAL has no driver ") + driver_name + "; leave that codec out with --peers");
  const MemoryName name(extension);
  const GDALDatasetUniquePtr source = wrap_cells(input);
  GDALDatasetUniquePtr made(driver->CreateCopy(name.c_str(), source.get(), FALSE, options.List(), nullptr, nullptr));
  const bool opened = made != nullptr;
  made.reset();
  vsi_l_offset length = 0;
  const GByte* bytes = opened ? VSIGetMemFileBuffer(name.c_str(), &length, FALSE) : nullptr;
  if (bytes == nullptr || errors.failed()) throw Error(ErrorKind::format, std::string("GDAL's driver ") + driver_name + " cannot encode" + errors.suffix());
  const auto* from = reinterpret_cast<const std::byte*>(bytes);
  return {from, from + length};
}

struct DriverOutput {
  std::optional<double> nodata;
};

DriverOutput decode_with(const char* driver_name, const char* extension, std::span<const std::byte> bytes, void* cells, GDALDataType type, Size size,
                         int threads) {
  const GdalErrors errors;
  const GdalThreads held(threads);
  const MemoryName name(extension);
  // GDAL does not write to a file that it opens for reading.
  auto* data = reinterpret_cast<GByte*>(const_cast<std::byte*>(bytes.data()));
  VSILFILE* file = VSIFileFromMemBuffer(name.c_str(), data, bytes.size(), FALSE);
  if (file != nullptr) VSIFCloseL(file);
  const char* const drivers[] = {driver_name, nullptr};
  const GDALDatasetUniquePtr opened(GDALDataset::Open(name.c_str(), GDAL_OF_RASTER, drivers));
  const auto fail = [&] { throw Error(ErrorKind::format, std::string("GDAL's driver ") + driver_name + " cannot decode" + errors.suffix()); };
  if (opened == nullptr || opened->GetRasterXSize() != size.width || opened->GetRasterYSize() != size.height) fail();
  GDALRasterBand& band = *opened->GetRasterBand(1);
  const int width = static_cast<int>(size.width), height = static_cast<int>(size.height);
  if (band.RasterIO(GF_Read, 0, 0, width, height, cells, width, height, type, 0, 0, nullptr) != CE_None || errors.failed()) fail();
  int has_nodata = FALSE;
  const double nodata = band.GetNoDataValue(&has_nodata);
  return {has_nodata != FALSE ? std::optional(nodata) : std::nullopt};
}

/// Codes back to elevations; those that equal nodata to voids.
void rebuild(const Raster<std::int32_t>& codes, const LinearMap& map, const std::optional<double>& nodata, RasterView<float> out) {
  for (std::int64_t y = 0; y < out.height; ++y)
    for (std::int64_t x = 0; x < out.width; ++x)
      out(x, y) = nodata && codes(x, y) == *nodata ? void_value : map.elevation(codes(x, y));
}

void copy_cells(const Raster<float>& from, RasterView<float> out) {
  for (std::int64_t y = 0; y < out.height; ++y) std::copy_n(from.view().row(y), out.width, out.row(y));
}

class GdalJpeg2000Codec final : public CodecUnderTest {
 public:
  std::string name() const override { return "gdal-jp2"; }
  std::string title() const override { return "JPEG 2000 (GDAL default)"; }
  std::string description() const override {
    return "GDAL's JP2OpenJPEG as it comes, which is what most people get: whole metres from 0, tiles of 1024, its own number of resolutions, "
           "QUALITY set for the size. One thread decodes. It is not JPEG 2000's ability.";
  }
  bool keeps_voids() const override { return false; }
  std::int64_t bytes_per_cell() const override { return 32; }
  bool can(const TestedTerrain& terrain, CodingTarget target) const override {
    return target.kind == CodingTarget::Kind::bytes && static_cast<double>(terrain.high) - static_cast<double>(terrain.low) < highest_16_bits - 1;
  }
  std::optional<SettingsRange> settings_range(const TestedTerrain&) const override { return std::nullopt; }

  std::vector<std::byte> encode(const TestedTerrain& terrain, CodingTarget target, int threads) const override {
    const LinearMap map{std::floor(static_cast<double>(terrain.low)), 1, 1};
    Raster<std::uint16_t> codes(terrain.filled.width(), terrain.filled.height());
    for (std::int64_t i = 0; i < codes.size().cells(); ++i)
      codes.data()[i] = static_cast<std::uint16_t>(std::lround(static_cast<double>(terrain.filled.data()[i]) - map.base));
    CPLStringList options;
    const double quality = 100 * target.value / (2 * static_cast<double>(codes.size().cells()));
    options.SetNameValue("QUALITY", CPLSPrintf("%.12g", std::clamp(quality, 1e-6, 100.0)));
    options.SetNameValue("REVERSIBLE", "NO");
    return with_map(map, encode_with("JP2OpenJPEG", ".jp2", {codes.data(), GDT_UInt16, codes.size()}, options, threads));
  }

  void decode(std::span<const std::byte> bytes, RasterView<float> out, int threads) const override {
    const MappedFile file = read_map(bytes);
    Raster<std::int32_t> codes(out.width, out.height);
    decode_with("JP2OpenJPEG", ".jp2", file.file, codes.data(), GDT_Int32, codes.size(), threads);
    rebuild(codes, file.map.value_or(LinearMap{}), std::nullopt, out);
  }
};

class LercCodec final : public CodecUnderTest {
 public:
  std::string name() const override { return "lerc"; }
  std::string title() const override { return "LERC"; }
  std::string description() const override {
    return "GeoTIFF with LERC_ZSTD (level 19) and MAX_Z_ERROR, 32-bit floats in one block; voids as NaN. Where the data are whole quanta it gets the bound plus "
           "0.499 quanta (smaller than its integer types), and its decode is rounded.";
  }
  bool keeps_voids() const override { return true; }
  std::int64_t bytes_per_cell() const override { return 56; }
  bool can(const TestedTerrain& terrain, CodingTarget target) const override {
    if (target.kind == CodingTarget::Kind::max_error) return steps_within(terrain, target.value).has_value();
    return target.kind != CodingTarget::Kind::bytes;
  }
  std::optional<SettingsRange> settings_range(const TestedTerrain& terrain) const override {
    return SettingsRange{relief_of(terrain) / 2, relief_of(terrain) * finest_bound};
  }

  std::vector<std::byte> encode(const TestedTerrain& terrain, CodingTarget target, int threads) const override {
    Raster<float> cells = terrain.cells.clone();
    if (target.kind == CodingTarget::Kind::setting) return with_map(std::nullopt, encode_floats(cells, target.value, threads));
    const std::optional<UniformSteps> steps = steps_for(terrain, target);
    if (!steps) return with_map(std::nullopt, encode_floats(cells, 0, threads));
    if (!steps->of_quanta) return with_map(std::nullopt, encode_floats(cells, steps->map.stride / 2, threads));
    const LinearMap quanta{steps->map.base, 1, terrain.quantum};
    for (std::int64_t i = 0; i < cells.size().cells(); ++i) {
      float& cell = cells.data()[i];
      if (!is_void(cell)) cell = static_cast<float>(std::round(static_cast<double>(cell) / quanta.unit) - quanta.base);
    }
    return with_map(quanta, encode_floats(cells, (steps->map.stride - 1) / 2 + 0.499, threads));
  }

  void decode(std::span<const std::byte> bytes, RasterView<float> out, int threads) const override {
    const MappedFile file = read_map(bytes);
    Raster<float> cells(out.width, out.height);
    decode_with("GTiff", ".tif", file.file, cells.data(), GDT_Float32, cells.size(), threads);
    if (file.map)
      for (std::int64_t i = 0; i < cells.size().cells(); ++i)
        if (float& cell = cells.data()[i]; !is_void(cell)) cell = file.map->elevation(std::llround(cell));
    copy_cells(cells, out);
  }

 private:
  static std::vector<std::byte> encode_floats(Raster<float>& cells, double max_error, int threads) {
    CPLStringList options;
    options.SetNameValue("COMPRESS", "LERC_ZSTD");
    options.SetNameValue("ZSTD_LEVEL", "19");
    options.SetNameValue("MAX_Z_ERROR", CPLSPrintf("%.12g", max_error));
    options.SetNameValue("BLOCKYSIZE", CPLSPrintf("%d", static_cast<int>(cells.height())));
    return encode_with("GTiff", ".tif", {cells.data(), GDT_Float32, cells.size(), void_value}, options, threads);
  }
};

/// GeoTIFF with a general compressor behind a predictor.
class PredictorCodec final : public CodecUnderTest {
 public:
  PredictorCodec(std::string name, std::string title, std::string compressor, std::pair<std::string, std::string> level)
      : name_(std::move(name)), title_(std::move(title)), compressor_(std::move(compressor)), level_(std::move(level)) {}

  std::string name() const override { return name_; }
  std::string title() const override { return title_; }
  std::string description() const override {
    return "GeoTIFF in tiles of 512, " + level_.first + "=" + level_.second + ", voids as nodata. Lossless: predictor 2 on whole metres in 16 bits, "
           "predictor 3 on floats. Lossy: predictor 2 on uniform steps (whole quanta where the data have them).";
  }
  bool keeps_voids() const override { return true; }
  std::int64_t bytes_per_cell() const override { return 72; }
  bool can(const TestedTerrain& terrain, CodingTarget target) const override {
    if (target.kind == CodingTarget::Kind::lossless) return true;
    return target.kind != CodingTarget::Kind::bytes && steps_within(terrain, target.value).has_value();
  }
  std::optional<SettingsRange> settings_range(const TestedTerrain& terrain) const override {
    double fine = std::max(relief_of(terrain) * finest_bound, terrain.quantum / 4);
    while (!steps_within(terrain, fine)) fine *= 2;
    return SettingsRange{std::max(relief_of(terrain) / 4, 2 * fine), fine};
  }

  std::vector<std::byte> encode(const TestedTerrain& terrain, CodingTarget target, int threads) const override {
    if (target.kind == CodingTarget::Kind::lossless) return with_map(std::nullopt, encode_exactly(terrain, threads));
    const CodedTerrain coded = quantise(terrain, steps_within(terrain, target.value).value());
    return with_map(coded.map, encode_codes(terrain, coded, threads));
  }

  void decode(std::span<const std::byte> bytes, RasterView<float> out, int threads) const override {
    const MappedFile file = read_map(bytes);
    if (file.map) {
      Raster<std::int32_t> codes(out.width, out.height);
      const auto [nodata] = decode_with("GTiff", ".tif", file.file, codes.data(), GDT_Int32, codes.size(), threads);
      return rebuild(codes, *file.map, nodata, out);
    }
    Raster<float> cells(out.width, out.height);
    const auto [nodata] = decode_with("GTiff", ".tif", file.file, cells.data(), GDT_Float32, cells.size(), threads);
    if (nodata && !std::isnan(*nodata))
      std::replace(cells.data(), cells.data() + cells.size().cells(), static_cast<float>(*nodata), void_value);
    copy_cells(cells, out);
  }

 private:
  /// A raster smaller than a tile is one tile of a multiple of 16 cells, as TIFF wants it.
  static int tile_side(std::int64_t cells) { return static_cast<int>(std::min<std::int64_t>(512, (cells + 15) / 16 * 16)); }

  CPLStringList options(int predictor, Size size) const {
    CPLStringList options;
    options.SetNameValue("COMPRESS", compressor_.c_str());
    options.SetNameValue(level_.first.c_str(), level_.second.c_str());
    options.SetNameValue("PREDICTOR", predictor == 2 ? "2" : "3");
    options.SetNameValue("TILED", "YES");
    options.SetNameValue("BLOCKXSIZE", CPLSPrintf("%d", tile_side(size.width)));
    options.SetNameValue("BLOCKYSIZE", CPLSPrintf("%d", tile_side(size.height)));
    return options;
  }

  std::vector<std::byte> encode_exactly(const TestedTerrain& terrain, int threads) const {
    constexpr std::int16_t nodata = std::numeric_limits<std::int16_t>::min();
    if (terrain.quantum != 1 || terrain.low <= nodata || terrain.high > std::numeric_limits<std::int16_t>::max()) {
      Raster<float> cells = terrain.cells.clone();
      return encode_with("GTiff", ".tif", {cells.data(), GDT_Float32, cells.size(), void_if_any(terrain, void_value)}, options(3, cells.size()), threads);
    }
    Raster<std::int16_t> cells(terrain.cells.width(), terrain.cells.height());
    std::transform(terrain.cells.data(), terrain.cells.data() + cells.size().cells(), cells.data(),
                   [](float z) { return is_void(z) ? nodata : static_cast<std::int16_t>(z); });
    return encode_with("GTiff", ".tif", {cells.data(), GDT_Int16, cells.size(), void_if_any(terrain, nodata)}, options(2, cells.size()), threads);
  }

  std::vector<std::byte> encode_codes(const TestedTerrain& terrain, const CodedTerrain& coded, int threads) const {
    // The code after the highest stands for voids.
    const std::int64_t nodata = std::int64_t{coded.highest} + 1;
    Raster<std::int32_t> wide = coded.codes.clone();
    for (std::int64_t i = 0; i < wide.size().cells(); ++i)
      if (is_void(terrain.cells.data()[i])) wide.data()[i] = static_cast<std::int32_t>(nodata);
    const std::optional<double> tag = void_if_any(terrain, static_cast<double>(nodata));
    if (nodata > highest_16_bits) return encode_with("GTiff", ".tif", {wide.data(), GDT_Int32, wide.size(), tag}, options(2, wide.size()), threads);
    Raster<std::uint16_t> narrow(wide.width(), wide.height());
    std::transform(wide.data(), wide.data() + wide.size().cells(), narrow.data(), [](std::int32_t code) { return static_cast<std::uint16_t>(code); });
    return encode_with("GTiff", ".tif", {narrow.data(), GDT_UInt16, narrow.size(), tag}, options(2, wide.size()), threads);
  }

  static std::optional<double> void_if_any(const TestedTerrain& terrain, double nodata) {
    return terrain.valid < terrain.cells.size().cells() ? std::optional(nodata) : std::nullopt;
  }

  std::string name_, title_, compressor_;
  std::pair<std::string, std::string> level_;
};

}  // namespace

std::unique_ptr<CodecUnderTest> make_gdal_jpeg2000_codec() { return std::make_unique<GdalJpeg2000Codec>(); }
std::unique_ptr<CodecUnderTest> make_lerc_codec() { return std::make_unique<LercCodec>(); }
std::unique_ptr<CodecUnderTest> make_zstd_codec() {
  return std::make_unique<PredictorCodec>("zstd", "ZSTD GeoTIFF", "ZSTD", std::pair("ZSTD_LEVEL", "19"));
}
std::unique_ptr<CodecUnderTest> make_deflate_codec() {
  return std::make_unique<PredictorCodec>("deflate", "DEFLATE GeoTIFF", "DEFLATE", std::pair("ZLEVEL", "9"));
}

}  // namespace arete
