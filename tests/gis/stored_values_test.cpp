#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

#include "core/support/error.h"
#include "core/support/random.h"
#include "gis/dem_file.h"
#include "tests/data.h"
#include "tests/gis/dem_files.h"

namespace arete {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double float_max = std::numeric_limits<float>::max();
constexpr ValueType every_type[] = {ValueType::uint8,  ValueType::int16,   ValueType::uint16, ValueType::int32,
                                    ValueType::uint32, ValueType::float32, ValueType::float64};

GDALDataType gdal_type(ValueType type) { return GDALGetDataTypeByName(std::string(name_of(type)).c_str()); }

Raster<double> read_all_stored(const DemReader& dem) {
  Raster<double> cells(dem.size().width, dem.size().height);
  dem.read_stored({0, 0, cells.width(), cells.height()}, cells.view());
  return cells;
}

/// All that a DEM says of its band, to write the same file again.
DemWriteOptions like(const DemReader& dem, const std::string& format = {}) {
  const DemDescription& about = dem.description();
  DemWriteOptions options;
  options.format = format;
  options.bands = {about.band_names[0]};
  options.type = dem.value_type();
  options.scale = about.scale;
  options.offset = about.offset;
  options.unit = about.unit;
  options.metadata = about.metadata;
  options.band_metadata = about.band_metadata;
  return options;
}

void write_stored(const std::string& path, const Raster<double>& cells, const GeoReference& geo, const DemWriteOptions& options) {
  DemWriter writer(path, cells.size(), geo, options);
  writer.write_stored({0, 0, cells.width(), cells.height()}, cells.view());
  writer.commit();
}

void copy_stored(const std::string& from, const std::string& to, const std::string& format = {}) {
  const DemReader dem(from);
  write_stored(to, read_all_stored(dem), dem.georeference(), like(dem, format));
}

/// The bytes of band 1 as GDAL itself reads them, in the file's own type.
std::vector<std::uint8_t> raw_cells(const std::string& path) {
  GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str()));
  GDALRasterBand& band = *dataset->GetRasterBand(1);
  const int width = dataset->GetRasterXSize(), height = dataset->GetRasterYSize();
  const GDALDataType type = band.GetRasterDataType();
  std::vector<std::uint8_t> cells(static_cast<std::size_t>(width * height * GDALGetDataTypeSizeBytes(type)));
  EXPECT_EQ(band.RasterIO(GF_Read, 0, 0, width, height, cells.data(), width, height, type, 0, 0, nullptr), CE_None);
  return cells;
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void expect_same_bits(const Raster<double>& a, const Raster<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size().cells()) * sizeof(double)), 0);
}

ErrorKind kind_of_failure(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.kind();
  }
  ADD_FAILURE() << "no error";
  return ErrorKind::usage;
}

/// The ends of the type, zeros of both signs, subnormals, neighbours, and noise of all magnitudes between them.
std::vector<double> numbers_of(ValueType type, std::size_t count) {
  const ValueRange range = type == ValueType::float64 ? range_of(ValueType::float32) : range_of(type);
  std::vector<double> numbers = {range.lowest, range.highest, 0, 1, hold_to(type, 1234.5678)};
  if (!is_integer(type)) {
    const double smallest = type == ValueType::float32 ? std::ldexp(1.0, -149) : std::numeric_limits<double>::denorm_min();
    for (const double extra : {-0.0, smallest, -smallest, 3 * smallest, -1.0 / 3}) numbers.push_back(hold_to(type, extra));
  }
  while (numbers.size() < count) {
    const std::uint64_t i = numbers.size();
    const double magnitude = std::exp2(40 * uniform_at(3, i, 0) - 8);
    numbers.push_back(hold_to(type, uniform_at(4, i, 0) < 0.5 ? -magnitude : magnitude));
  }
  return numbers;
}

TEST(StoredValues, EveryTypeComesBackBitForBit) {
  TestFolder folder;
  for (const ValueType type : every_type) {
    for (const std::string format : {"COG", "GTiff"}) {
      SCOPED_TRACE(std::string(name_of(type)) + " in " + format);
      const std::string from = folder / (std::string(name_of(type)) + format + ".tif"), to = folder / ("copy" + format + ".tif");
      const std::vector<double> numbers = numbers_of(type, 700 * 600);
      make_raster(from, 700, 600, gdal_type(type), numbers);
      const DemReader source(from);
      EXPECT_EQ(source.value_type(), type);
      const Raster<double> stored = read_all_stored(source);
      EXPECT_EQ(std::memcmp(stored.data(), numbers.data(), numbers.size() * sizeof(double)), 0);

      std::filesystem::remove(to);
      copy_stored(from, to, format);
      const DemReader copy(to);
      EXPECT_EQ(copy.value_type(), type);
      EXPECT_FALSE(copy.description().nodata_declared);
      EXPECT_EQ(raw_cells(to), raw_cells(from));
      expect_same_bits(read_all_stored(copy), stored);
    }
  }
}

struct DeclaredNodata {
  ValueType type;
  double value;
};

TEST(StoredValues, TheNodataValueIsKeptExactlyWithItsVoids) {
  TestFolder folder;
  for (const auto& [type, nodata] :
       {DeclaredNodata{ValueType::uint8, 255}, DeclaredNodata{ValueType::int16, -9999}, DeclaredNodata{ValueType::int16, 0},
        DeclaredNodata{ValueType::int16, -32768}, DeclaredNodata{ValueType::uint16, 65535},
        DeclaredNodata{ValueType::int32, -2147483648.0}, DeclaredNodata{ValueType::uint32, 4294967295.0},
        DeclaredNodata{ValueType::float32, -9999}, DeclaredNodata{ValueType::float32, -9999.1},
        DeclaredNodata{ValueType::float32, 1.70141e+38}, DeclaredNodata{ValueType::float32, -float_max},
        DeclaredNodata{ValueType::float32, nan},
        DeclaredNodata{ValueType::float64, -9999.1}, DeclaredNodata{ValueType::float64, -1.7976931348623157e308},
        DeclaredNodata{ValueType::float64, nan}}) {
    for (const bool with_voids : {true, false}) {
      for (const std::string format : {"COG", "GTiff"}) {
        SCOPED_TRACE(std::string(name_of(type)) + " " + std::to_string(nodata) + " " + format);
        std::vector<double> numbers(600 * 50);
        for (std::size_t i = 0; i < numbers.size(); ++i)
          numbers[i] = with_voids && i % 7 == 3 ? nodata : static_cast<double>(1 + i % 90);
        const std::string from = folder / "from.tif", to = folder / "to.tif";
        std::filesystem::remove(to);
        make_raster(from, 600, 50, gdal_type(type), numbers,
                    [nodata = nodata](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(nodata); });
        copy_stored(from, to, format);
        const DemReader source(from), copy(to);
        ASSERT_TRUE(copy.georeference().nodata);
        if (std::isnan(nodata)) {
          EXPECT_TRUE(std::isnan(*copy.georeference().nodata));
        } else {
          EXPECT_EQ(*copy.georeference().nodata, *source.georeference().nodata);
        }
        EXPECT_EQ(raw_cells(to), raw_cells(from));
        const Raster<double> stored = read_all_stored(copy);
        for (std::int64_t i = 0; i < stored.size().cells(); ++i)
          ASSERT_EQ(std::isnan(stored.data()[i]), with_voids && i % 7 == 3) << i;
      }
    }
  }
}

TEST(StoredValues, ANodataValueThatTheTypeCannotHoldStaysDeclaredWhileNothingIsVoid) {
  TestFolder folder;
  GeoReference geo;
  geo.nodata = -9999;
  write_stored(folder / "b.tif", Raster<double>(3, 2, 0), geo, {.type = ValueType::uint8});
  EXPECT_EQ(DemReader(folder / "b.tif").georeference().nodata, -9999);
  Raster<double> holed(3, 2, 7);
  holed(1, 1) = nan;
  write_stored(folder / "c.tif", holed, geo, {.type = ValueType::uint8});
  EXPECT_EQ(DemReader(folder / "c.tif").georeference().nodata, 0);
  EXPECT_TRUE(std::isnan(read_all_stored(DemReader(folder / "c.tif"))(1, 1)));
}

// GDAL 3.6 takes every cell for void where a nodata value is infinite in the type of the band.
TEST(StoredValues, ANodataValueThatSpoilsTheFileIsNotDeclared) {
  TestFolder folder;
  Raster<double> cells(600, 2, 7);
  cells(0, 0) = 8;
  for (const auto& [type, nodata] : {DeclaredNodata{ValueType::float32, -inf}, DeclaredNodata{ValueType::float32, 1e300},
                                     DeclaredNodata{ValueType::float64, inf}, DeclaredNodata{ValueType::int16, inf},
                                     DeclaredNodata{ValueType::int16, nan}, DeclaredNodata{ValueType::int16, 1e300}}) {
    for (const bool with_voids : {false, true}) {
      SCOPED_TRACE(std::string(name_of(type)) + " " + std::to_string(nodata));
      cells(1, 1) = with_voids ? nan : 9;
      GeoReference geo;
      geo.nodata = nodata;
      write_stored(folder / "i.tif", cells, geo, {.overwrite = true, .type = type});
      const Raster<double> back = read_all_stored(DemReader(folder / "i.tif"));
      EXPECT_EQ(back(0, 0), 8);
      EXPECT_EQ(back(599, 1), 7);
      EXPECT_EQ(std::isnan(back(1, 1)), with_voids);
      // As other programs see it.
      GDALDatasetUniquePtr tiff(GDALDataset::Open((folder / "i.tif").c_str()));
      std::uint8_t valid[2];
      GDALRasterBand& mask = *tiff->GetRasterBand(1)->GetMaskBand();
      ASSERT_EQ(mask.RasterIO(GF_Read, 1, 1, 2, 1, valid, 2, 1, GDT_Byte, 0, 0, nullptr), CE_None);
      EXPECT_EQ(valid[0], with_voids ? 0 : 255);
      EXPECT_EQ(valid[1], 255);
    }
  }
}

TEST(StoredValues, IntegerVoidsWithoutANodataValueBecomeTheLowestUnlessAnElevationHasIt) {
  TestFolder folder;
  for (const ValueType type : {ValueType::uint8, ValueType::int16, ValueType::uint16, ValueType::int32, ValueType::uint32}) {
    SCOPED_TRACE(name_of(type));
    const double lowest = range_of(type).lowest;
    Raster<double> cells(1100, 600, 50);
    cells(1099, 599) = nan;
    write_stored(folder / "v.tif", cells, {}, {.overwrite = true, .type = type});
    EXPECT_EQ(DemReader(folder / "v.tif").georeference().nodata, lowest);
    EXPECT_TRUE(std::isnan(read_all_stored(DemReader(folder / "v.tif"))(1099, 599)));
    const std::string before = bytes_of(folder / "v.tif");

    cells(0, 0) = lowest;
    EXPECT_EQ(kind_of_failure([&] { write_stored(folder / "v.tif", cells, {}, {.overwrite = true, .type = type}); }),
              ErrorKind::format);
    EXPECT_EQ(bytes_of(folder / "v.tif"), before);

    // Whole blocks of the lowest value are elevations as long as nothing is void.
    for (std::int64_t y = 0; y < 600; ++y)
      for (std::int64_t x = 0; x < 1100; ++x) cells(x, y) = x < 600 ? lowest : 3;
    write_stored(folder / "v.tif", cells, {}, {.overwrite = true, .type = type});
    EXPECT_FALSE(DemReader(folder / "v.tif").description().nodata_declared);
    expect_same_bits(read_all_stored(DemReader(folder / "v.tif")), cells);

    // Cells that are never written are voids like any other.
    const auto leave_the_last_row = [&] {
      DemWriter writer(folder / "w.tif", {1100, 601}, {}, {.overwrite = true, .type = type});
      writer.write_stored({0, 0, 1100, 600}, cells.view());
      writer.commit();
    };
    EXPECT_EQ(kind_of_failure(leave_the_last_row), ErrorKind::format);
    for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = 3;
    leave_the_last_row();
    const Raster<double> back = read_all_stored(DemReader(folder / "w.tif"));
    EXPECT_EQ(back(1099, 599), 3);
    EXPECT_TRUE(std::isnan(back(0, 600)));
  }
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"v.tif", "w.tif"}));
}

TEST(StoredValues, AnElevationNeverBecomesTheSourcesNodata) {
  TestFolder folder;
  for (const auto& [type, nodata] :
       {DeclaredNodata{ValueType::uint8, 255}, DeclaredNodata{ValueType::int16, -9999}, DeclaredNodata{ValueType::float32, 0},
        DeclaredNodata{ValueType::float64, -9999.1}, DeclaredNodata{ValueType::float32, float_max}}) {
    GeoReference geo;
    geo.nodata = nodata;
    Raster<double> cells(2, 1, nodata);
    cells(1, 0) = nan;
    write_stored(folder / "n.tif", cells, geo, {.format = "GTiff", .overwrite = true, .type = type});
    const DemReader dem(folder / "n.tif");
    const Raster<double> back = read_all_stored(dem);
    EXPECT_TRUE(std::isnan(back(1, 0)));
    if (std::fabs(nodata) > 1e30) continue;  // the reader takes the neighbours of such values for rounded nodata
    EXPECT_NEAR(back(0, 0), nodata, is_integer(type) ? 1 : 0.001) << name_of(type);
  }
}

TEST(StoredValues, NumbersAreHeldToTheType) {
  TestFolder folder;
  Raster<double> cells(5, 1);
  const double given[] = {2.5, -2.5, 1e6, -1e6, inf};
  std::copy(std::begin(given), std::end(given), cells.data());
  GeoReference geo;
  geo.nodata = -1;
  write_stored(folder / "h.tif", cells, geo, {.type = ValueType::int16});
  const Raster<double> back = read_all_stored(DemReader(folder / "h.tif"));
  EXPECT_EQ(back(0, 0), 3);
  EXPECT_EQ(back(1, 0), -3);
  EXPECT_EQ(back(2, 0), 32767);
  EXPECT_EQ(back(3, 0), -32768);
  EXPECT_TRUE(std::isnan(back(4, 0)));
}

TEST(StoredValues, ScaleOffsetUnitNamesAndRegistrationAreKept) {
  TestFolder folder;
  make_raster(folder / "from.tif", 40, 30, GDT_Int16, std::vector<double>(1200, 8848), [](GDALDataset& dataset) {
    GDALRasterBand& band = *dataset.GetRasterBand(1);
    band.SetScale(0.1);
    band.SetOffset(-450.25);
    band.SetUnitType("US survey foot");
    band.SetDescription("bare earth");
    band.SetMetadataItem("SURVEY", "2019");
    band.SetMetadataItem("STATISTICS_MEAN", "12");
    dataset.SetMetadataItem("AREA_OR_POINT", "Point");
    dataset.SetMetadataItem("PRODUCER", "someone");
    double transform[] = {600000, 30, 0, 5200000, 0, -30};
    dataset.SetGeoTransform(transform);
  });
  for (const std::string format : {"COG", "GTiff"}) {
    const std::string to = folder / (format + ".tif");
    copy_stored(folder / "from.tif", to, format);
    const DemReader source(folder / "from.tif"), copy(to);
    const DemDescription& about = copy.description();
    EXPECT_EQ(about.scale, 0.1);
    EXPECT_EQ(about.offset, -450.25);
    EXPECT_EQ(about.unit, "US survey foot");
    EXPECT_EQ(about.band_names, std::vector<std::string>{"bare earth"});
    EXPECT_EQ(about.band_metadata, (std::map<std::string, std::string>{{"SURVEY", "2019"}}));
    EXPECT_EQ(about.metadata.at("PRODUCER"), "someone");
    EXPECT_EQ(copy.georeference().registration, Registration::point);
    EXPECT_EQ(copy.georeference().transform, source.georeference().transform);
    EXPECT_EQ(copy.georeference().nodata, std::nullopt);
    EXPECT_EQ(read_all(copy)(3, 3), read_all(source)(3, 3));
    EXPECT_EQ(read_all(copy)(3, 3), static_cast<float>((8848 * 0.1 - 450.25) * (1200.0 / 3937.0)));
  }
  // A band that names no unit stays so.
  make_raster(folder / "bare.tif", 4, 3, GDT_Float32, std::vector<double>(12, 5));
  copy_stored(folder / "bare.tif", folder / "bare-copy.tif");
  EXPECT_EQ(DemReader(folder / "bare-copy.tif").description().unit, "");
}

TEST(StoredValues, RowsAreTurnedNorthUp) {
  TestFolder folder;
  std::vector<double> numbers(64 * 40);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<double>(i);
  make_raster(folder / "south.tif", 64, 40, GDT_UInt16, numbers, [](GDALDataset& dataset) {
    double transform[] = {1000, 10, 0, 2000, 0, 10};
    dataset.SetGeoTransform(transform);
  });
  const DemReader source(folder / "south.tif");
  const Raster<double> stored = read_all_stored(source);
  for (std::int64_t y = 0; y < 40; ++y)
    for (std::int64_t x = 0; x < 64; ++x) ASSERT_EQ(stored(x, y), static_cast<double>((39 - y) * 64 + x));
  Raster<double> part(7, 5);
  source.read_stored({3, 11, 7, 5}, part.view());
  for (std::int64_t y = 0; y < 5; ++y)
    for (std::int64_t x = 0; x < 7; ++x) ASSERT_EQ(part(x, y), stored(3 + x, 11 + y));
  copy_stored(folder / "south.tif", folder / "north.tif");
  expect_same_bits(read_all_stored(DemReader(folder / "north.tif")), stored);
}

TEST(StoredValues, VoidExactlyWhereMetresAre) {
  TestFolder folder;
  make_raster(folder / "m.tif", 4, 2, GDT_Float64, {1, -9999, nan, inf, -inf, 1e300, 5, 6},
              [](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(-9999); });
  const DemReader dem(folder / "m.tif");
  const Raster<double> stored = read_all_stored(dem);
  const Raster<float> metres = read_all(dem);
  for (std::int64_t i = 0; i < 8; ++i) EXPECT_EQ(std::isnan(stored.data()[i]), is_void(metres.data()[i])) << i;
  EXPECT_EQ(stored(0, 0), 1);
  EXPECT_EQ(stored(3, 1), 6);

  // A mask leaves cells out whatever they hold.
  make_raster(folder / "masked.tif", 2, 1, GDT_Int16, {100, 200}, [](GDALDataset& dataset) {
    const CPLConfigOptionSetter inside("GDAL_TIFF_INTERNAL_MASK", "YES", false);
    ASSERT_EQ(dataset.CreateMaskBand(GMF_PER_DATASET), CE_None);
    std::uint8_t valid[] = {0, 255};
    ASSERT_EQ(dataset.GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Write, 0, 0, 2, 1, valid, 2, 1, GDT_Byte, 0, 0, nullptr),
              CE_None);
  });
  EXPECT_TRUE(std::isnan(read_all_stored(DemReader(folder / "masked.tif"))(0, 0)));
  copy_stored(folder / "masked.tif", folder / "unmasked.tif");
  const Raster<double> copy = read_all_stored(DemReader(folder / "unmasked.tif"));
  EXPECT_TRUE(std::isnan(copy(0, 0)));
  EXPECT_EQ(copy(1, 0), 200);
}

TEST(StoredValues, WideIntegersTakeTheNarrowestTypeThatHoldsThem) {
  TestFolder folder;
  const auto type_of = [&](GDALDataType type, const std::vector<double>& numbers,
                           const std::function<void(GDALRasterBand&)>& adjust = {}) {
    make_raster(folder / "w.tif", static_cast<int>(numbers.size()), 1, type, numbers, [&](GDALDataset& dataset) {
      if (adjust) adjust(*dataset.GetRasterBand(1));
    });
    return DemReader(folder / "w.tif").value_type();
  };
  EXPECT_EQ(type_of(GDT_Int64, {0, 255}), ValueType::uint8);
  EXPECT_EQ(type_of(GDT_Int64, {-1, 255}), ValueType::int16);
  EXPECT_EQ(type_of(GDT_UInt64, {0, 40000}), ValueType::uint16);
  EXPECT_EQ(type_of(GDT_Int64, {-1, 40000}), ValueType::int32);
  EXPECT_EQ(type_of(GDT_UInt64, {0, 3e9}), ValueType::uint32);
  EXPECT_EQ(type_of(GDT_Int64, {-1, 3e9}), ValueType::float64);
  // Voids need room: the nodata value, or the lowest of the type.
  EXPECT_EQ(type_of(GDT_Int64, {0, 200, -9999}, [](GDALRasterBand& band) { band.SetNoDataValueAsInt64(-9999); }),
            ValueType::int16);
  const auto far_nodata = [](GDALRasterBand& band) { band.SetNoDataValueAsInt64(std::numeric_limits<std::int64_t>::min()); };
  EXPECT_EQ(type_of(GDT_Int64, {0, 200, -9223372036854775808.0}, far_nodata), ValueType::int16);
  EXPECT_EQ(type_of(GDT_Int64, {1, 200, -9223372036854775808.0}, far_nodata), ValueType::uint8);
  copy_stored(folder / "w.tif", folder / "copy.tif");
  const Raster<double> copy = read_all_stored(DemReader(folder / "copy.tif"));
  EXPECT_EQ(copy(1, 0), 200);
  EXPECT_TRUE(std::isnan(copy(2, 0)));

  EXPECT_EQ(type_of(GDT_Int64, {9007199254740990.0}), ValueType::float64);
  EXPECT_EQ(kind_of_failure([&] { type_of(GDT_Int64, {9007199254740992.0}); }), ErrorKind::format);
  EXPECT_EQ(kind_of_failure([&] { read_all_stored(DemReader(folder / "w.tif")); }), ErrorKind::format);
  EXPECT_EQ(read_all(DemReader(folder / "w.tif"))(0, 0), 9007199254740992.0F);  // as metres it is as good as any
}

TEST(StoredValues, SignedBytesKeepTheirSign) {
  TestFolder folder;
  const char* const creation[] = {"PIXELTYPE=SIGNEDBYTE", nullptr};
  make_raster(folder / "s.tif", 4, 1, GDT_Byte, {0, 127, 128, 255}, {}, "GTiff", creation);
  const DemReader dem(folder / "s.tif");
  EXPECT_EQ(dem.value_type(), ValueType::int16);
  const Raster<double> stored = read_all_stored(dem);
  EXPECT_EQ(stored(1, 0), 127);
  EXPECT_EQ(stored(2, 0), -128);
  EXPECT_EQ(stored(3, 0), -1);
  EXPECT_EQ(read_all(dem)(3, 0), -1);
}

TEST(StoredValues, TerrainRgbGivesItsMetres) {
  TestFolder folder;
  make_raster(folder / "rgb.tif", 2, 1, GDT_Byte, {1, 1, 134, 140, 160, 255});
  const DemReader dem(folder / "rgb.tif", {.terrain_rgb = true});
  EXPECT_EQ(dem.value_type(), ValueType::float32);
  const Raster<double> stored = read_all_stored(dem);
  // -10000 + (R 65536 + G 256 + B) 0.1
  EXPECT_EQ(stored(0, 0), static_cast<double>(static_cast<float>(0.0)));
  EXPECT_EQ(stored(1, 0), static_cast<double>(static_cast<float>(-10000 + (65536 + 140 * 256 + 255) * 0.1)));
}

TEST(StoredValues, TheSameBytesForAnyWindowsMemoryAndThreads) {
  TestFolder folder;
  Raster<double> cells(1300, 900);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i)
    cells.data()[i] = i % 11 == 5 ? nan : std::floor(3000 * uniform_at(9, static_cast<std::uint64_t>(i), 0));
  for (const ValueType type : {ValueType::int16, ValueType::float64}) {
    write_stored(folder / "a.tif", cells, {}, {.overwrite = true, .type = type, .threads = 1});
    DemWriter writer(folder / "b.tif", cells.size(), {},
                     {.overwrite = true, .type = type, .memory_bytes = 2 << 20, .threads = 2});
    for (std::int64_t x = 1200; x >= 0; x -= 100)
      for (std::int64_t y = 0; y < 900; y += 300) writer.write_stored({x, y, 100, 300}, cells.view().sub({x, y, 100, 300}));
    writer.commit();
    EXPECT_EQ(bytes_of(folder / "a.tif"), bytes_of(folder / "b.tif"));
  }
}

TEST(StoredValues, MetresAreWrittenInTheTypeAndScaleOfTheFile) {
  TestFolder folder;
  Raster<float> metres(3, 1);
  metres(0, 0) = 1234.56F;
  metres(1, 0) = -3.04F;
  metres(2, 0) = void_value;
  DemWriter writer(folder / "cm.tif", metres.size(), {}, {.type = ValueType::int16, .scale = 0.1, .offset = 1000});
  writer.write(0, {0, 0, 3, 1}, metres.view());
  writer.commit();
  const DemReader dem(folder / "cm.tif");
  EXPECT_EQ(dem.data_type(), "Int16");
  const Raster<double> stored = read_all_stored(dem);
  EXPECT_EQ(stored(0, 0), 2346);
  EXPECT_EQ(stored(1, 0), -10030);
  EXPECT_TRUE(std::isnan(stored(2, 0)));
  EXPECT_NEAR(read_all(dem)(0, 0), 1234.6, 1e-4);
}

TEST(StoredValues, OtherFormatsHoldWhatTheyCan) {
  TestFolder folder;
  Raster<double> cells(40, 30, -12);
  cells(5, 5) = nan;
  GeoReference geo;
  geo.transform = {0, 30, 0, 900, 0, -30};
  geo.nodata = -32768;
  for (const std::string name : {"a.asc", "b.img", "c.bil"}) {
    write_stored(folder / name, cells, geo, {.type = ValueType::int16});
    const Raster<double> back = read_all_stored(DemReader(folder / name));
    EXPECT_EQ(back(4, 4), -12) << name;
    EXPECT_TRUE(std::isnan(back(5, 5))) << name;
  }
  EXPECT_EQ(kind_of_failure([&] { DemWriter(folder / "d.asc", {4, 4}, geo, {.type = ValueType::uint32}); }), ErrorKind::format);
}

TEST(StoredValues, OverviewsOfIntegersAreAverages) {
  TestFolder folder;
  Raster<double> cells(1200, 800);
  for (std::int64_t y = 0; y < 800; ++y)
    for (std::int64_t x = 0; x < 1200; ++x) cells(x, y) = x % 2 == 0 ? 100 : 104;
  write_stored(folder / "o.tif", cells, {}, {.type = ValueType::int16});
  GDALDatasetUniquePtr tiff(GDALDataset::Open((folder / "o.tif").c_str()));
  ASSERT_GE(tiff->GetRasterBand(1)->GetOverviewCount(), 1);
  std::int16_t mean = 0;
  ASSERT_EQ(tiff->GetRasterBand(1)->GetOverview(0)->RasterIO(GF_Read, 30, 30, 1, 1, &mean, 1, 1, GDT_Int16, 0, 0, nullptr),
            CE_None);
  EXPECT_EQ(mean, 102);
}

TEST(StoredValues, RealDemsComeBackBitForBit) {
  struct RealDem {
    const char* name;
    ValueType type;
  };
  for (const auto& [name, type] :
       {RealDem{"davos_srtm1_1arcsec.tif", ValueType::int16}, RealDem{"n46e008_srtm3_3arcsec_voids.tif", ValueType::int16},
        RealDem{"alr_tyrol_dtm_5m.tif", ValueType::float64}, RealDem{"greenriver_lidar_1m.tif", ValueType::float32},
        RealDem{"inyo_srtm_30m_utm11_nan.tif", ValueType::float32}}) {
    const std::string path = test_data(name);
    if (path.empty()) GTEST_SKIP() << "no development data: set ARETE_TEST_DATA";
    SCOPED_TRACE(name);
    TestFolder folder;
    copy_stored(path, folder / "copy.tif");
    const DemReader source(path), copy(folder / "copy.tif");
    EXPECT_EQ(copy.value_type(), type);
    expect_same_bits(read_all_stored(copy), read_all_stored(source));
    const bool undeclared_nan = std::string(name) == "inyo_srtm_30m_utm11_nan.tif";  // whose sign is lost, but now it is declared
    if (!undeclared_nan) {
      EXPECT_EQ(raw_cells(folder / "copy.tif"), raw_cells(path));
      EXPECT_EQ(copy.georeference().nodata, source.georeference().nodata);
    }
    EXPECT_EQ(copy.georeference().registration, source.georeference().registration);
    EXPECT_EQ(copy.georeference().transform, source.georeference().transform);
    EXPECT_EQ(copy.description().unit, source.description().unit);
  }
}

}  // namespace
}  // namespace arete
