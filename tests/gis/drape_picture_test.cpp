#include "gis/drape_picture.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/support/error.h"
#include "gis/colour_ramp.h"
#include "gis/crs.h"
#include "gis/gdal_errors.h"

namespace arete {
namespace {

namespace fs = std::filesystem;

class ReadDrape : public testing::Test {
 protected:
  void SetUp() override {
    const GdalErrors registers;
    folder_ = fs::temp_directory_path() / ("arete_drape_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// 200 x 150 cells of 30 m in UTM 33.
  static Placed dem() {
    Placed placed{"dem.tif", {}, {200, 150}};
    placed.geo.transform = std::array<double, 6>{500000, 30, 0, 4600000, 0, -30};
    placed.geo.crs_wkt = crs_wkt("EPSG:32633");
    return placed;
  }
  static constexpr std::array<double, 6> same_ground = {500000, 15, 0, 4600000, 0, -15};

  using Value = std::function<double(int band, int x, int y)>;
  using Finish = std::function<void(GDALDataset&)>;
  std::string raster(const std::string& name, Size size, int bands, GDALDataType type, const std::string& crs,
                     const std::array<double, 6>& transform, const Value& value, const Finish& finish = nullptr) const {
    const GDALDatasetUniquePtr file(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
        path(name).c_str(), static_cast<int>(size.width), static_cast<int>(size.height), bands, type, nullptr));
    if (!crs.empty()) file->SetProjection(crs_wkt(crs).c_str());
    file->SetGeoTransform(const_cast<double*>(transform.data()));
    std::vector<double> row(static_cast<std::size_t>(size.width));
    if (finish) finish(*file);
    for (int b = 1; b <= bands; ++b)
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) row[static_cast<std::size_t>(x)] = value(b, x, y);
        if (file->GetRasterBand(b)->RasterIO(GF_Write, 0, y, static_cast<int>(size.width), 1, row.data(),
                                             static_cast<int>(size.width), 1, GDT_Float64, 0, 0, nullptr) != CE_None)
          ADD_FAILURE();
      }
    return path(name);
  }
  static std::string message(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      const std::string text = error.what();
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
      return text;
    }
    return "nothing was thrown";
  }

 private:
  fs::path folder_;
};

TEST_F(ReadDrape, OnTheGridOfTheDemPixelsStayAsTheyAre) {
  const std::string file = raster("rgb.tif", {400, 300}, 3, GDT_Byte, "EPSG:32633", same_ground,
                                  [](int band, int x, int y) { return (band * 50 + x * 3 + y * 7) % 256; });
  const DrapePicture drape = read_drape(file, dem());
  ASSERT_EQ(drape.picture.width(), 400);
  ASSERT_EQ(drape.picture.height(), 300);
  EXPECT_TRUE(drape.opaque);
  EXPECT_FALSE(drape.values);
  EXPECT_EQ(drape.left, 0);
  EXPECT_EQ(drape.width, 200);
  for (int y = 0; y < 300; y += 7)
    for (int x = 0; x < 400; x += 3)
      for (int c = 0; c < 3; ++c)
        ASSERT_EQ(drape.picture(x, y)[static_cast<std::size_t>(c)], ((c + 1) * 50 + x * 3 + y * 7) % 256) << x << ", " << y;
}

TEST_F(ReadDrape, InAnotherCrsItsEdgeIsWhereProjSays) {
  // Red west of 15.03 degrees, blue east of it; in degrees, and turned against the grid of the DEM by the convergence of
  // meridians there.
  const double step = 0.0002, west = 15.03 - 200 * step, north = 41.56;
  const std::string file = raster("lonlat.tif", {400, 400}, 3, GDT_Byte, "EPSG:4326", {west, step, 0, north, 0, -step},
                                  [](int band, int x, int) { return band == (x < 200 ? 1 : 3) ? 255 : 0; });
  const DrapePicture drape = read_drape(file, dem());
  OGRSpatialReference degrees, utm;
  degrees.importFromEPSG(4326);
  degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  utm.importFromEPSG(32633);
  const std::unique_ptr<OGRCoordinateTransformation> project(OGRCreateCoordinateTransformation(&degrees, &utm));
  int checked = 0;
  for (double latitude = 41.515; latitude < 41.55; latitude += 0.001) {
    double x = 15.03, y = latitude;
    ASSERT_TRUE(project->Transform(1, &x, &y));
    const double column = ((x - 500000) / 30 - drape.left) / drape.width * static_cast<double>(drape.picture.width());
    const auto row =
        static_cast<std::int64_t>(((4600000 - y) / 30 - drape.top) / drape.height * static_cast<double>(drape.picture.height()));
    if (row < 0 || row >= drape.picture.height()) continue;
    const auto edge = static_cast<std::int64_t>(std::floor(column));
    ASSERT_TRUE(edge > 3 && edge + 3 < drape.picture.width());
    EXPECT_GT(drape.picture(edge - 2, row)[0], 250) << latitude;
    EXPECT_LT(drape.picture(edge - 2, row)[2], 5) << latitude;
    EXPECT_LT(drape.picture(edge + 2, row)[0], 5) << latitude;
    EXPECT_GT(drape.picture(edge + 2, row)[2], 250) << latitude;
    ++checked;
  }
  EXPECT_GT(checked, 20);
  // About its own resolution: 0.0002 degrees are 22 m to the north, 17 m to the east.
  EXPECT_NEAR(drape.height * 30 / static_cast<double>(drape.picture.height()), 22.2, 1);
  EXPECT_NEAR(drape.width * 30 / static_cast<double>(drape.picture.width()), 16.7, 1);
}

TEST_F(ReadDrape, NodataAlphaAndMasksAreTransparent) {
  const auto left_is_empty = [&](const std::string& file) {
    const DrapePicture drape = read_drape(file, dem());
    EXPECT_FALSE(drape.opaque) << file;
    EXPECT_EQ(drape.picture(20, 150)[3], 0) << file;
    EXPECT_EQ(drape.picture(380, 150)[3], 255) << file;
    EXPECT_EQ(drape.picture(380, 150)[1], 90) << file;
  };
  left_is_empty(raster(
      "nodata.tif", {400, 300}, 3, GDT_Byte, "EPSG:32633", same_ground, [](int, int x, int) { return x < 200 ? 7 : 90; },
      [](GDALDataset& file) {
        for (int b = 1; b <= 3; ++b) file.GetRasterBand(b)->SetNoDataValue(7);
      }));
  left_is_empty(raster(
      "alpha.tif", {400, 300}, 4, GDT_Byte, "EPSG:32633", same_ground,
      [](int band, int x, int) { return band == 4 ? (x < 200 ? 0 : 255) : 90; },
      [](GDALDataset& file) { file.GetRasterBand(4)->SetColorInterpretation(GCI_AlphaBand); }));
  left_is_empty(raster(
      "mask.tif", {400, 300}, 1, GDT_Byte, "EPSG:32633", same_ground, [](int, int, int) { return 90; },
      [](GDALDataset& file) {
        ASSERT_EQ(file.CreateMaskBand(GMF_PER_DATASET), CE_None);
        std::vector<std::uint8_t> row(400, 0);
        std::fill(row.begin() + 200, row.end(), 255);
        for (int y = 0; y < 300; ++y)
          ASSERT_EQ(
              file.GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Write, 0, y, 400, 1, row.data(), 400, 1, GDT_Byte, 0, 0, nullptr),
              CE_None);
      }));
}

TEST_F(ReadDrape, ColoursAreThoseOfPalettesGreyOrARamp) {
  const DrapePicture palette = read_drape(
      raster(
          "palette.tif", {400, 300}, 1, GDT_Byte, "EPSG:32633", same_ground, [](int, int x, int) { return x < 200 ? 1 : 2; },
          [](GDALDataset& file) {
            GDALColorTable table;
            const GDALColorEntry green{10, 200, 30, 255}, pink{250, 100, 150, 255};
            table.SetColorEntry(1, &green);
            table.SetColorEntry(2, &pink);
            file.GetRasterBand(1)->SetColorTable(&table);
          }),
      dem());
  EXPECT_EQ(palette.picture(50, 50), (Colour{10, 200, 30, 255}));
  EXPECT_EQ(palette.picture(350, 50), (Colour{250, 100, 150, 255}));
  const DrapePicture grey = read_drape(
      raster("grey.tif", {400, 300}, 1, GDT_Byte, "EPSG:32633", same_ground, [](int, int x, int) { return x / 2; }), dem());
  EXPECT_EQ(grey.picture(240, 50), (Colour{120, 120, 120, 255}));
  EXPECT_FALSE(grey.values);
  const DrapePicture numbers = read_drape(raster(
                                              "float.tif", {400, 300}, 1, GDT_Float32, "EPSG:32633", same_ground,
                                              [](int, int x, int) { return x < 100 ? NAN : 1000 + x; },
                                              [](GDALDataset& file) { file.GetRasterBand(1)->SetNoDataValue(NAN); }),
                                          dem());
  EXPECT_TRUE(numbers.values);
  EXPECT_NEAR(numbers.low, 1103, 2);
  EXPECT_NEAR(numbers.high, 1396, 2);
  EXPECT_EQ(numbers.picture(50, 20)[3], 0);
  EXPECT_EQ(numbers.picture(250, 20), named_ramp("viridis").at((1250 - numbers.low) / (numbers.high - numbers.low)));
  const DrapePicture deep = read_drape(raster("deep.tif", {400, 300}, 3, GDT_UInt16, "EPSG:32633", same_ground,
                                              [](int band, int x, int) { return band == 2 ? 500 : 500 + 20 * x; }),
                                       dem());
  EXPECT_EQ(deep.picture(399, 20)[0], 255);
  EXPECT_EQ(deep.picture(399, 20)[1], 0);
}

TEST_F(ReadDrape, LimitsHoldAndPixelsAreThenMeans) {
  const std::string file = raster("fine.tif", {400, 300}, 1, GDT_Byte, "EPSG:32633", same_ground,
                                  [](int, int x, int y) { return (x + y) % 2 ? 200 : 100; });
  const DrapePicture small = read_drape(file, dem(), {.longest = 50});
  EXPECT_EQ(small.picture.width(), 50);
  EXPECT_EQ(small.picture.height(), 38);
  EXPECT_NEAR(small.picture(25, 20)[0], 150, 6);
  EXPECT_EQ(read_drape(file, dem(), {.per_cell = 0.5}).picture.width(), 100);
}

TEST_F(ReadDrape, CoversPartOfTheDemOrLiesRoundIt) {
  const DrapePicture part = read_drape(
      raster("part.tif", {40, 30}, 1, GDT_Byte, "EPSG:32633", {501500, 30, 0, 4599100, 0, -30}, [](int, int, int) { return 9; }),
      dem());
  EXPECT_DOUBLE_EQ(part.left, 50);
  EXPECT_DOUBLE_EQ(part.top, 30);
  EXPECT_DOUBLE_EQ(part.width, 40);
  EXPECT_FALSE(part.opaque);
  const DrapePicture round = read_drape(raster("round.tif", {100, 100}, 1, GDT_Byte, "EPSG:32633",
                                               {490000, 300, 0, 4610000, 0, -300}, [](int, int, int) { return 9; }),
                                        dem());
  EXPECT_DOUBLE_EQ(round.left, 0);
  EXPECT_DOUBLE_EQ(round.width, 200);
  EXPECT_TRUE(round.opaque);
}

TEST_F(ReadDrape, WithoutGeoreferenceTheProportionsDecide) {
  const auto plain = [&](const std::string& name, Size size) {
    Picture picture(size.width, size.height, {77, 88, 99, 255});
    write_picture(path(name), picture);
    return path(name);
  };
  const DrapePicture drape = read_drape(plain("map.png", {600, 450}), dem());
  EXPECT_DOUBLE_EQ(drape.left, 0);
  EXPECT_DOUBLE_EQ(drape.height, 150);
  EXPECT_EQ(drape.picture(300, 200), (Colour{77, 88, 99, 255}));
  EXPECT_NE(message([&] { read_drape(plain("square.png", {600, 600}), dem()); }).find("proportions"), std::string::npos);
}

TEST_F(ReadDrape, SaysInOneLineWhatIsWrong) {
  const std::string far =
      raster("far.tif", {10, 10}, 1, GDT_Byte, "EPSG:32633", {900000, 30, 0, 4600000, 0, -30}, [](int, int, int) { return 9; });
  const std::string text = message([&] { read_drape(far, dem()); });
  EXPECT_NE(text.find("far.tif' over 'dem.tif': they share no ground"), std::string::npos) << text;
  EXPECT_NE(message([&] { read_drape(path("none.tif"), dem()); }).find("No such file"), std::string::npos);
  const std::string empty = raster(
      "empty.tif", {400, 300}, 1, GDT_Byte, "EPSG:32633", same_ground, [](int, int, int) { return 9; },
      [](GDALDataset& file) { file.GetRasterBand(1)->SetNoDataValue(9); });
  EXPECT_NE(message([&] { read_drape(empty, dem()); }).find("share no ground"), std::string::npos);
}

}  // namespace
}  // namespace arete
