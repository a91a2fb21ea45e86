#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <thread>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "gis/dem_file.h"
#include "tests/data.h"
#include "tests/gis/dem_files.h"

namespace arete {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string wkt_of_epsg(const std::string& definition) {
  OGRSpatialReference crs;
  EXPECT_EQ(crs.SetFromUserInput(definition.c_str()), OGRERR_NONE);
  char* text = nullptr;
  crs.exportToWkt(&text);
  std::string wkt = text;
  CPLFree(text);
  return wkt;
}

ErrorKind kind_of_failure(const std::string& path, const DemReadOptions& options = {}, std::string* message = nullptr) {
  try {
    read_all(DemReader(path, options));
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    if (message != nullptr) *message = error.what();
    return error.kind();
  }
  ADD_FAILURE() << path << " was read without an error";
  return ErrorKind::usage;
}

// Expected sizes, ranges and shares of voids: the table of the data's README, which was made with gdalinfo -stats.
struct RealDem {
  const char* name;
  Size size;
  double lowest, highest, tolerance;
  double void_share;
  const char* driver;
  Registration registration;
};

void PrintTo(const RealDem& dem, std::ostream* out) { *out << dem.name; }

class RealDems : public testing::TestWithParam<RealDem> {};

TEST_P(RealDems, OpenWithTheSizeTheRangeAndTheVoidsOfTheTable) {
  const RealDem& expected = GetParam();
  const std::string path = test_data(expected.name);
  if (path.empty()) GTEST_SKIP() << "no development data: set ARETE_TEST_DATA";
  DemReadOptions options;
  options.terrain_rgb = path.find("terrain_rgb") != std::string::npos;
  const DemReader dem(path, options);
  ASSERT_EQ(dem.size(), expected.size);
  EXPECT_EQ(dem.description().driver, expected.driver);
  EXPECT_EQ(dem.georeference().registration, expected.registration);
  if (dem.georeference().transform) {
    EXPECT_LT((*dem.georeference().transform)[5], 0);
  }
  const Raster<float> cells = read_all(dem);
  double lowest = inf, highest = -inf;
  std::int64_t voids = 0;
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) {
    const float z = cells.data()[i];
    if (is_void(z)) {
      ++voids;
      continue;
    }
    lowest = std::min<double>(lowest, z);
    highest = std::max<double>(highest, z);
  }
  if (expected.void_share < 1) {
    EXPECT_NEAR(lowest, expected.lowest, expected.tolerance);
    EXPECT_NEAR(highest, expected.highest, expected.tolerance);
  }
  EXPECT_NEAR(static_cast<double>(voids) / static_cast<double>(cells.size().cells()), expected.void_share, 0.0005);
}

constexpr auto area = Registration::area;
constexpr auto point = Registration::point;

INSTANTIATE_TEST_SUITE_P(
    Data, RealDems,
    testing::Values(RealDem{"davos_srtm1_1arcsec.tif", {2160, 2160}, 556, 3373, 0, 0, "GTiff", area},
                    RealDem{"n46e008_srtm3_3arcsec_voids.tif", {1201, 1201}, 187, 4173, 0, 0.072, "GTiff", point},
                    RealDem{"aleutians_glo30_1arcsec_ocean.tif", {3600, 3600}, -1.43, 1211.31, 0.005, 0, "GTiff", point},
                    RealDem{"davosdorf_dtm_10m.tif", {559, 495}, 1535.92, 2843.08, 0.005, 0, "GTiff", area},
                    RealDem{"alr_tyrol_dtm_5m.tif", {417, 915}, 566.13, 2452.32, 0.005, 0.306, "GTiff", area},
                    RealDem{"hit_tyrol_dtm_5m.asc", {526, 446}, 1455.17, 2604.46, 0.005, 0.316, "AAIGrid", point},
                    RealDem{"greenriver_lidar_1m.tif", {2000, 1000}, 1297.29, 1347.03, 0.005, 0, "GTiff", area},
                    RealDem{"gabilan_lidar_1m.bil", {921, 859}, 187.90, 307.28, 0.005, 0, "ENVI", area},
                    RealDem{"inyo_srtm_30m_utm11_nan.tif", {558, 897}, 466, 3369, 0, 0.569, "GTiff", area},
                    RealDem{"recife_srtm1_1arcsec_coast.tif", {460, 592}, -38, 115, 0, 0, "GTiff", area}));

// Ranges that the README does not give are those of gdalinfo -stats (GDAL 3.6).
INSTANTIATE_TEST_SUITE_P(
    EdgeCases, RealDems,
    testing::Values(RealDem{"edge-cases/n31e035_srtm3_below_sea_level.tif", {1201, 1201}, -424, 1301, 0, 0, "GTiff", point},
                    RealDem{"edge-cases/fuji_terrain_rgb_512.png", {512, 512}, 13.7, 3751.0, 0.01, 0, "PNG", area},
                    RealDem{"edge-cases/some_nodata_74x92.tif", {74, 92}, 1733.174, 3602.768, 0.001, 10.0 / 6808, "GTiff", point},
                    RealDem{"edge-cases/all_nodata_74x92.tif", {74, 92}, 0, 0, 0, 1, "GTiff", point},
                    RealDem{"edge-cases/geographic_anisotropic_74x92.tif", {74, 92}, 0, 3627.917, 0.001, 0, "GTiff", point},
                    RealDem{"edge-cases/no_crs_6x4.tif", {6, 4}, 1077, 1088, 0, 0, "GTiff", area},
                    RealDem{"edge-cases/tiny_6x4.tif", {6, 4}, 1077, 1088, 0, 0, "GTiff", area},
                    RealDem{"edge-cases/skinny_8x160.tif", {8, 160}, 1846, 3111, 0, 0, "GTiff", area},
                    RealDem{"edge-cases/south_up_250x250.tif", {250, 250}, 200, 600, 0, 0, "GTiff", area}));

TEST(DemReader, GivesTheMetricCellSizeOfAGeographicDem) {
  const std::string path = test_data("davos_srtm1_1arcsec.tif");
  if (path.empty()) GTEST_SKIP() << "no development data: set ARETE_TEST_DATA";
  // WGS 84 at 46.8 N: a second of latitude is 30.88 m, of longitude 21.21 m (series of Snyder 1987, p. 25).
  const CellSize cell = DemReader(path).cell_size();
  EXPECT_NEAR(cell.x_m, 21.21, 0.01);
  EXPECT_NEAR(cell.y_m, 30.88, 0.01);
}

TEST(DemReader, TurnsRowsThatRunNorthwards) {
  TestFolder folder;
  make_raster(folder / "up.tif", 2, 3, GDT_Int16, {1, 2, 3, 4, 5, 6}, [](GDALDataset& dataset) {
    double t[] = {100, 10, 0, 500, 0, 20};
    dataset.SetGeoTransform(t);
  });
  const DemReader dem(folder / "up.tif");
  EXPECT_TRUE(dem.description().south_up);
  EXPECT_EQ(*dem.georeference().transform, (std::array<double, 6>{100, 10, 0, 560, 0, -20}));
  const Raster<float> all = read_all(dem);
  EXPECT_EQ(all(0, 0), 5);
  EXPECT_EQ(all(1, 2), 2);
  Raster<float> one(1, 2);
  dem.read({1, 1, 1, 2}, one.view());
  EXPECT_EQ(one(0, 0), 4);
  EXPECT_EQ(one(0, 1), 2);
}

TEST(DemReader, KeepsARotatedTransform) {
  TestFolder folder;
  const std::array<double, 6> rotated{100, 8, 6, 500, 6, -8};
  make_raster(folder / "r.tif", 2, 1, GDT_Int16, {1, 2}, [&](GDALDataset& dataset) {
    auto t = rotated;
    dataset.SetGeoTransform(t.data());
  });
  const DemReader dem(folder / "r.tif");
  EXPECT_EQ(*dem.georeference().transform, rotated);
  EXPECT_NEAR(dem.cell_size().x_m, 10, 1e-12);
}

TEST(DemReader, AppliesScaleOffsetAndUnit) {
  TestFolder folder;
  const auto make = [&](const char* name, const char* unit) {
    make_raster(folder / name, 3, 1, GDT_Int16, {100, -32768, -50}, [&](GDALDataset& dataset) {
      GDALRasterBand& band = *dataset.GetRasterBand(1);
      band.SetScale(0.5);
      band.SetOffset(10);
      band.SetUnitType(unit);
      band.SetNoDataValue(-32768);
    });
    return DemReader(folder / name).georeference().metres_per_unit;
  };
  EXPECT_EQ(make("m.tif", "m"), 1);
  EXPECT_EQ(make("ft.tif", "ft"), 0.3048);
  EXPECT_EQ(make("us.tif", "US survey foot"), 1200.0 / 3937.0);
  EXPECT_EQ(make("cm.tif", "cm"), 0.01);
  const Raster<float> feet = read_all(DemReader(folder / "ft.tif"));
  EXPECT_EQ(feet(0, 0), static_cast<float>(60 * 0.3048));
  EXPECT_TRUE(is_void(feet(1, 0)));
  EXPECT_EQ(feet(2, 0), static_cast<float>(-15 * 0.3048));
  EXPECT_EQ(make("odd.tif", "fathoms of old"), 1);
  EXPECT_FALSE(DemReader(folder / "odd.tif").description().unit_known);
}

TEST(DemReader, TakesTheUnitOfTheVerticalAxis) {
  TestFolder folder;
  // EPSG:6360 is NAVD88 height (ftUS); EPSG:5773 is EGM96 height, in metres.
  for (const auto& [definition, metres] :
       std::map<std::string, double>{{"EPSG:32612+6360", 1200.0 / 3937.0}, {"EPSG:32632+5773", 1}, {"EPSG:2277", 1}}) {
    make_raster(folder / "v.tif", 1, 1, GDT_Float32, {1000}, [&](GDALDataset& dataset) {
      dataset.SetProjection(wkt_of_epsg(definition).c_str());
      double t[] = {0, 1, 0, 0, 0, -1};
      dataset.SetGeoTransform(t);
    });
    const DemReader dem(folder / "v.tif");
    EXPECT_EQ(dem.georeference().metres_per_unit, metres) << definition;
    EXPECT_EQ(read_all(dem)(0, 0), static_cast<float>(1000 * metres)) << definition;
  }
}

TEST(DemReader, MakesVoidWhatIsNoElevation) {
  TestFolder folder;
  make_raster(folder / "f.tif", 6, 1, GDT_Float32, {nan, inf, -inf, 1.70141183460469e+38, 5, -9999}, [](GDALDataset& dataset) {
    dataset.GetRasterBand(1)->SetNoDataValue(1.70141e+38);
  });
  const Raster<float> cells = read_all(DemReader(folder / "f.tif"));
  for (int x = 0; x < 4; ++x) EXPECT_TRUE(is_void(cells(x, 0))) << x;
  EXPECT_EQ(cells(4, 0), 5);
  EXPECT_EQ(cells(5, 0), -9999);  // not declared

  make_raster(folder / "d.tif", 4, 1, GDT_Float64, {-1.7976931348623157e308, 1e300, 1234.1, -9999.9},
              [](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(-9999.9); });
  const Raster<float> doubles = read_all(DemReader(folder / "d.tif"));
  EXPECT_TRUE(is_void(doubles(0, 0)) && is_void(doubles(1, 0)) && is_void(doubles(3, 0)));
  EXPECT_EQ(doubles(2, 0), 1234.1f);
}

TEST(DemReader, ObeysAMaskBand) {
  TestFolder folder;
  make_raster(folder / "m.tif", 3, 1, GDT_Int16, {7, 8, 9}, [](GDALDataset& dataset) {
    ASSERT_EQ(dataset.CreateMaskBand(GMF_PER_DATASET), CE_None);
    unsigned char valid[] = {255, 0, 255};
    ASSERT_EQ(dataset.GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Write, 0, 0, 3, 1, valid, 3, 1, GDT_Byte, 0, 0, nullptr), CE_None);
  });
  const DemReader dem(folder / "m.tif");
  EXPECT_TRUE(dem.description().masked);
  const Raster<float> cells = read_all(dem);
  EXPECT_EQ(cells(0, 0), 7);
  EXPECT_TRUE(is_void(cells(1, 0)));
  EXPECT_EQ(cells(2, 0), 9);
}

TEST(DemReader, ReadsTheBandThatIsAskedFor) {
  TestFolder folder;
  make_raster(folder / "b.tif", 2, 1, GDT_Float64, {1, 2, 3, 4, 5, 6});
  EXPECT_EQ(read_all(DemReader(folder / "b.tif"))(1, 0), 2);
  EXPECT_EQ(read_all(DemReader(folder / "b.tif", {.band = 3}))(0, 0), 5);
  EXPECT_EQ(DemReader(folder / "b.tif").description().bands, 3);
  EXPECT_EQ(kind_of_failure(folder / "b.tif", {.band = 4}), ErrorKind::input);
  EXPECT_EQ(kind_of_failure(folder / "b.tif", {.band = 0}), ErrorKind::input);
  EXPECT_EQ(kind_of_failure(folder / "b.tif", {.terrain_rgb = true}), ErrorKind::input);
}

TEST(DemReader, DecodesTerrainRgbAndItsAlpha) {
  TestFolder folder;
  // Mapbox's formula by hand: (1, 134, 160) is -10000 + 100000 x 0.1 = 0 m; (1, 136, 148) is 50 m.
  make_raster(folder / "rgb.tif", 3, 1, GDT_Byte, {1, 1, 1, 134, 136, 136, 160, 148, 148, 255, 255, 0},
              [](GDALDataset& dataset) { dataset.GetRasterBand(4)->SetColorInterpretation(GCI_AlphaBand); });
  const Raster<float> cells = read_all(DemReader(folder / "rgb.tif", {.terrain_rgb = true}));
  EXPECT_EQ(cells(0, 0), 0);
  EXPECT_NEAR(cells(1, 0), 50, 1e-5);
  EXPECT_TRUE(is_void(cells(2, 0)));
}

TEST(DemReader, ReadsMosaicsAndArchives) {
  TestFolder folder;
  const auto at = [](double x) {
    return [x](GDALDataset& dataset) {
      double t[] = {x, 1, 0, 0, 0, -1};
      dataset.SetGeoTransform(t);
    };
  };
  make_raster(folder / "west.tif", 2, 1, GDT_Int16, {1, 2}, at(0));
  make_raster(folder / "east.tif", 2, 1, GDT_Int16, {3, 4}, at(2));
  ASSERT_EQ(std::system(("cd " + folder.path() + " && gdalbuildvrt -q all.vrt west.tif east.tif").c_str()), 0);
  const Raster<float> mosaic = read_all(DemReader(folder / "all.vrt"));
  ASSERT_EQ(mosaic.size(), (Size{4, 1}));
  for (int x = 0; x < 4; ++x) EXPECT_EQ(mosaic(x, 0), x + 1);

  const std::string inside = "/vsizip/" + (folder / "dem.zip") + "/west.tif";
  VSILFILE* file = VSIFOpenL(inside.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  std::ifstream west(folder / "west.tif", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(west)), {});
  VSIFWriteL(bytes.data(), 1, bytes.size(), file);
  VSIFCloseL(file);
  EXPECT_EQ(read_all(DemReader(inside))(1, 0), 2);

  std::filesystem::remove(folder / "east.tif");
  EXPECT_EQ(kind_of_failure(folder / "all.vrt"), ErrorKind::input);
}

TEST(DemReader, ReadsTheSameValuesByAnyWindowAndFromAnyThread) {
  TestFolder folder;
  std::vector<double> values;
  for (int i = 0; i < 300 * 200; ++i) values.push_back((i * 7919) % 4001);
  make_raster(folder / "w.tif", 300, 200, GDT_Int16, values);
  const DemReader dem(folder / "w.tif");
  const Raster<float> all = read_all(dem);
  std::vector<std::thread> readers;
  std::vector<int> wrong(4, 0);
  for (int i = 0; i < 4; ++i)
    readers.emplace_back([&, i] {
      for (int k = 0; k < 25; ++k) {
        const Window window{(k * 37 + i * 11) % 250, (k * 53 + i * 7) % 150, 50, 50};
        Raster<float> part(50, 50);
        dem.read(window, part.view());
        for (int y = 0; y < 50; ++y)
          for (int x = 0; x < 50; ++x) wrong[static_cast<std::size_t>(i)] += part(x, y) != all(window.x + x, window.y + y);
      }
    });
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
  EXPECT_EQ(all(7, 3), (907 * 7919) % 4001);
}

TEST(DemReader, SaysInOneLineWhatIsWrongWithAFile) {
  TestFolder folder;
  std::string message;
  EXPECT_EQ(kind_of_failure(folder / "none.tif", {}, &message), ErrorKind::input);
  EXPECT_NE(message.find("no such file"), std::string::npos);
  std::ofstream(folder / "text.tif") << "This is a shopping list: bread, cheese, a ridge.\n";
  EXPECT_EQ(kind_of_failure(folder / "text.tif", {}, &message), ErrorKind::input);
  EXPECT_NE(message.find("not a raster"), std::string::npos);
  std::ofstream(folder / "empty.tif");
  EXPECT_EQ(kind_of_failure(folder / "empty.tif"), ErrorKind::input);
  EXPECT_EQ(kind_of_failure(folder.path()), ErrorKind::input);
  make_raster(folder / "complex.tif", 1, 1, GDT_CFloat32, {1});
  EXPECT_EQ(kind_of_failure(folder / "complex.tif"), ErrorKind::format);
}

TEST(DemReader, RefusesATruncatedFileAndPrintsNothing) {
  TestFolder folder;
  std::vector<double> values(256 * 256);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>((i * 2654435761u) % 30011);
  make_raster(folder / "whole.tif", 256, 256, GDT_Float32, values);
  make_raster(folder / "whole.bil", 256, 256, GDT_Float32, values, {}, "ENVI");
  for (const std::string name : {"whole.tif", "whole.bil"}) {
    const auto bytes = std::filesystem::file_size(folder / name);
    std::filesystem::copy_file(folder / "whole.hdr", folder / "cut.hdr", std::filesystem::copy_options::overwrite_existing);
    const std::string cut = folder / ("cut" + name.substr(5));
    for (const double share : {0.9, 0.5, 0.01}) {
      std::filesystem::copy_file(folder / name, cut, std::filesystem::copy_options::overwrite_existing);
      std::filesystem::resize_file(cut, static_cast<std::uintmax_t>(static_cast<double>(bytes) * share));
      testing::internal::CaptureStderr();
      EXPECT_EQ(kind_of_failure(cut), ErrorKind::input) << share;
      EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << share;
    }
  }
}

// A sparse GeoTIFF of a few hundred bytes whose only strip would take 3.6 GB.
TEST(DemReader, RefusesABlockLargerThanTheLimit) {
  TestFolder folder;
  GDALAllRegister();
  const char* const creation[] = {"SPARSE_OK=TRUE", "BLOCKYSIZE=30000", "COMPRESS=DEFLATE", nullptr};
  GDALDriver& tiff = *GetGDALDriverManager()->GetDriverByName("GTiff");
  GDALDatasetUniquePtr(tiff.Create((folder / "bomb.tif").c_str(), 30000, 30000, 1, GDT_Float32, creation)).reset();
  EXPECT_EQ(kind_of_failure(folder / "bomb.tif"), ErrorKind::memory);
  make_raster(folder / "small.tif", 10, 10, GDT_Float32, std::vector<double>(100, 1));
  EXPECT_EQ(kind_of_failure(folder / "small.tif", {.max_block_bytes = 399}), ErrorKind::memory);
  EXPECT_EQ(read_all(DemReader(folder / "small.tif", {.max_block_bytes = 400}))(9, 9), 1);
}

}  // namespace
}  // namespace arete
