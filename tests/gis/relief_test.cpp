#include "gis/relief.h"

#include <cmath>
#include <cstring>
#include <filesystem>

#include <gdal_utils.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>

#include "core/support/random.h"
#include "core/terrain/hillshade.h"
#include "core/terrain/slope.h"
#include "gis/colour_ramp.h"

namespace arete {
namespace {

Raster<float> hills(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = static_cast<float>(500 + 200 * std::sin(static_cast<double>(x) / 9) * std::cos(static_cast<double>(y) / 7) +
                                       20 * uniform_at(1, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
  return cells;
}

Relief relief_of(const Raster<float>& cells, ReliefOptions options = {}, CellSize cell = {30, 30}) {
  options.legend = false;
  NoProgress silent;
  return draw_relief(ViewSource(cells.view()), cell, options, silent);
}

double brightness(Colour c) { return (c[0] + c[1] + c[2]) / 3.0; }

TEST(DrawRelief, AMapOfOneToOneHasThePixelsOfTheRaster) {
  const Relief relief = relief_of(hills(600, 520));
  EXPECT_EQ(relief.picture.width(), 600);
  EXPECT_EQ(relief.picture.height(), 520);
  EXPECT_EQ(relief.metres_per_pixel, 30);
}

TEST(DrawRelief, AConeHasOneColourOfSlopeAndAllOfAspects) {
  Raster<float> cells(1100, 1100);
  for (std::int64_t y = 0; y < 1100; ++y)
    for (std::int64_t x = 0; x < 1100; ++x) cells(x, y) = static_cast<float>(9000 - 5 * std::hypot(static_cast<double>(x - 550), static_cast<double>(y - 550)));
  ReliefOptions options;
  options.azimuth_deg = 315;
  options.exaggeration = 1e-6;  // even light
  options.style.colour = GroundColour::slope;
  const double steep = std::atan(0.5) * 180 / M_PI;
  const Picture slopes = relief_of(cells, options, {10, 10}).picture;
  options.style.colour = GroundColour::aspect;
  const Picture aspects = relief_of(cells, options, {10, 10}).picture;
  for (int degrees = 0; degrees < 360; degrees += 10) {
    const auto x = std::llround(550 + 400 * std::sin(degrees * M_PI / 180)), y = std::llround(550 - 400 * std::cos(degrees * M_PI / 180));
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(slopes(x, y)[c], slope_ramp().at(steep / slope_scale_deg(steep))[c], 2) << degrees;
      EXPECT_NEAR(aspects(x, y)[c], aspect_ramp().at(degrees / 360.0)[c], 4) << degrees;
    }
  }
}

TEST(DrawRelief, FlatGroundIsGreyWhereAspectsAreColoured) {
  Raster<float> cells = hills(100, 100);
  for (std::int64_t y = 30; y < 60; ++y)
    for (std::int64_t x = 30; x < 60; ++x) cells(x, y) = 480;
  ReliefOptions options;
  options.style.colour = GroundColour::aspect;
  const Picture picture = relief_of(cells, options).picture;
  const Colour grey = picture(picture.width() * 45 / 100, picture.height() * 45 / 100);
  EXPECT_EQ(grey[0], grey[1]);
  EXPECT_EQ(grey[1], grey[2]);
}

TEST(DrawRelief, ARasterLiesOverTheMapWhereItHasData) {
  const Raster<float> cells = hills(600, 520);
  const std::string file = testing::TempDir() + "/arete_cover.png";
  // Of the proportions of the map: red, from its middle on transparent.
  Picture cover(300, 260, {230, 20, 20, 255});
  fill(cover, {150, 0, 150, 260}, {0, 0, 0, 0});
  write_picture(file, cover, true);
  const Picture plain = relief_of(cells).picture;
  ReliefOptions options;
  options.cover = ReliefCover{file, {"hills", {}, {600, 520}}};
  const Picture covered = relief_of(cells, options).picture;
  options.threads = 1;
  const Picture again = relief_of(cells, options).picture;
  std::filesystem::remove(file);
  for (std::int64_t y = 0; y < 520; ++y)
    for (std::int64_t x = 0; x < 600; ++x) {
      ASSERT_EQ(covered(x, y), again(x, y));
      if (x < 298) { ASSERT_GT(covered(x, y)[0], 2 * covered(x, y)[1]) << x << ", " << y; }
      if (x > 301) { ASSERT_EQ(covered(x, y), plain(x, y)) << x << ", " << y; }
    }
}

TEST(DrawRelief, PixelsAreSquareOnTheGround) {
  const Relief relief = relief_of(hills(600, 600), {}, {20, 30});
  EXPECT_EQ(relief.picture.width(), 400);
  EXPECT_EQ(relief.picture.height(), 600);
}

TEST(DrawRelief, ALargeRasterShrinksAndASmallOneGrowsByAWholeFactor) {
  const Relief large = relief_of(hills(3000, 150));
  EXPECT_EQ(large.picture.width(), 2048);
  const Raster<float> small = hills(32, 20);
  const Relief grown = relief_of(small);
  EXPECT_EQ(grown.picture.width(), 1024);
  EXPECT_EQ(grown.picture.height(), 640);
  for (std::int64_t y = 0; y < 640; ++y)
    for (std::int64_t x = 0; x < 1024; ++x) ASSERT_EQ(grown.picture(x, y), grown.picture(x / 32 * 32, y / 32 * 32));
  ReliefOptions narrow;
  narrow.width = 300;
  EXPECT_EQ(relief_of(hills(1000, 400), narrow).picture.width(), 300);
}

TEST(DrawRelief, SlopesToTheNorthWestAreLit) {
  Raster<float> ridge(600, 600);  // falls to the north-west above the diagonal, to the south-east below
  for (std::int64_t y = 0; y < 600; ++y)
    for (std::int64_t x = 0; x < 600; ++x) ridge(x, y) = static_cast<float>(3000 - 10 * std::abs(x + y - 599));
  ReliefOptions grey;
  grey.ramp = "grey";
  const Relief relief = relief_of(ridge, grey);
  EXPECT_GT(brightness(relief.picture(200, 200)), brightness(relief.picture(400, 400)) + 40);
}

TEST(DrawRelief, VoidsAreHatchedAndChangeNoOtherPixel) {
  const Raster<float> whole = hills(520, 520);
  Raster<float> holed = whole.clone();
  for (std::int64_t y = 100; y < 140; ++y)
    for (std::int64_t x = 100; x < 140; ++x) holed(x, y) = void_value;
  ReliefOptions fixed;
  fixed.exaggeration = 1;
  const Picture before = relief_of(whole, fixed).picture, after = relief_of(holed, fixed).picture;
  for (std::int64_t y = 100; y < 140; ++y)
    for (std::int64_t x = 100; x < 140; ++x) EXPECT_GT(brightness(after(x, y)), 200);
  // The colour scale moves a little with the percentiles.
  for (std::int64_t y = 0; y < 520; ++y)
    for (std::int64_t x = 0; x < 520; ++x)
      if (x < 99 || x > 140 || y < 99 || y > 140) {
        ASSERT_NEAR(brightness(before(x, y)), brightness(after(x, y)), 3) << x << ' ' << y;
      }
}

TEST(DrawRelief, DeadFlatSeaIsBlueAndFlatHighGroundIsNot) {
  Raster<float> coast = hills(520, 520);
  for (std::int64_t y = 0; y < 520; ++y)
    for (std::int64_t x = 0; x < 200; ++x) coast(x, y) = 0;
  for (std::int64_t y = 0; y < 520; ++y)
    for (std::int64_t x = 400; x < 520; ++x) coast(x, y) = 700;
  const Picture map = relief_of(coast).picture;
  const auto blue = [&](std::int64_t x) { return map(x, 250)[2] > map(x, 250)[0] + 20; };
  EXPECT_TRUE(blue(0));
  EXPECT_TRUE(blue(198));
  EXPECT_FALSE(blue(260));
  EXPECT_FALSE(blue(500));
}

TEST(DrawRelief, NothingButVoidsIsAHatchedSheet) {
  const Relief relief = relief_of(Raster<float>(20, 20, void_value));
  EXPECT_TRUE(std::isnan(relief.low_m));
  EXPECT_GT(brightness(relief.picture(5, 5)), 200);
}

TEST(DrawRelief, IsTheSameForAnyThreadCount) {
  const Raster<float> cells = hills(700, 530);
  ReliefOptions one, many;
  one.threads = 1, many.threads = 5;
  const Picture a = relief_of(cells, one).picture, b = relief_of(cells, many).picture;
  EXPECT_EQ(std::memcmp(a.data(), b.data(), 700 * 530 * sizeof(Colour)), 0);
}

TEST(DrawRelief, GentleTerrainIsExaggeratedAndSteepIsNot) {
  Raster<float> gentle = hills(520, 520);
  for (std::int64_t i = 0; i < 520 * 520; ++i) gentle.data()[i] /= 20;
  EXPECT_GT(relief_of(gentle).exaggeration, 3);
  EXPECT_EQ(relief_of(hills(520, 520)).exaggeration, 1);
}

TEST(DrawReliefPanels, ShareScaleAndLight) {
  const Raster<float> fine = hills(128, 128);
  Raster<float> higher = fine.clone();
  for (std::int64_t i = 0; i < 128 * 128; ++i) higher.data()[i] += 1000;
  const ViewSource a(fine.view()), b(higher.view());
  NoProgress silent;
  ReliefOptions options;
  options.width = 256;
  options.legend = false;
  const Relief sheet = draw_relief_panels({{"low", &a, {30, 30}}, {"high", &b, {30, 30}}, {"low again", &a, {30, 30}}}, 0, options,
                                          silent);
  EXPECT_EQ(sheet.picture.width(), 3 * 256 + 4 * 10);
  EXPECT_NEAR(sheet.low_m, 300, 30);
  EXPECT_NEAR(sheet.high_m, 1710, 30);
  double low = 0, high = 0;
  for (std::int64_t y = sheet.picture.height() - 200; y < sheet.picture.height() - 20; ++y)
    for (std::int64_t x = 0; x < 256; ++x) {
      ASSERT_EQ(sheet.picture(10 + x, y), sheet.picture(10 + 2 * 266 + x, y));
      low += brightness(sheet.picture(10 + x, y));
      high += brightness(sheet.picture(276 + x, y));
    }
  EXPECT_GT(high, low);
}

TEST(DrawReliefPanels, WrapIntoRows) {
  const Raster<float> cells = hills(64, 32);
  const ViewSource source(cells.view());
  NoProgress silent;
  ReliefOptions options;
  options.width = 128;
  options.legend = false;
  const std::vector<ReliefPanel> five(5, {"x", &source, {10, 10}});
  const Picture sheet = draw_relief_panels(five, 3, options, silent).picture;
  EXPECT_EQ(sheet.width(), 3 * 128 + 4 * 10);
  EXPECT_GE(sheet.height(), 2 * 64);
}

TEST(DrapeReliefs, HaveAPixelPerCellOneScaleAndNoHoles) {
  const Raster<float> fine = hills(300, 200);
  Raster<float> coarse = hills(100, 80);
  for (std::int64_t y = 20; y < 60; ++y)
    for (std::int64_t x = 20; x < 60; ++x) coarse(x, y) = void_value;
  const ViewSource a(fine.view()), b(coarse.view());
  NoProgress silent;
  const Drapes drapes = drape_reliefs({{"a", &a, {10, 20}}, {"b", &b, {30, 30}}}, 150, {}, silent);
  ASSERT_EQ(drapes.drapes.size(), 2u);
  EXPECT_EQ(drapes.drapes[0].ground.cells.size(), (Size{150, 100}));
  EXPECT_EQ(drapes.drapes[0].picture.width(), 150);
  EXPECT_EQ(drapes.drapes[1].picture.height(), 80);
  EXPECT_LT(drapes.colour_low_m, drapes.colour_high_m);
  const Picture& holed = drapes.drapes[1].picture;
  for (std::int64_t i = 0; i < 100 * 80; ++i) ASSERT_EQ(holed.data()[i][3], 255);
  EXPECT_EQ(holed(40, 40), (Colour{190, 190, 190, 255}));
  EXPECT_NE(holed(21, 40), (Colour{190, 190, 190, 255}));
}

TEST(DrawDifferenceMap, IsRedWhereTheResultIsTooHigh) {
  Raster<float> reference(520, 520, 100.0f), result(520, 520, 100.0f);
  for (std::int64_t x = 0; x < 520; ++x) {
    result(x, 100) = 105;
    result(x, 300) = 95;
    result(x, 400) = void_value;
  }
  NoProgress silent;
  ReliefOptions options;
  options.legend = false;
  const Relief map = draw_difference_map(ViewSource(reference.view()), ViewSource(result.view()), {1, 1}, 5, options, silent);
  EXPECT_EQ(map.low_m, -5);
  EXPECT_EQ(map.high_m, 5);
  EXPECT_GT(map.picture(50, 100)[0], map.picture(50, 100)[2] + 50);
  EXPECT_GT(map.picture(50, 300)[2], map.picture(50, 300)[0] + 50);
  EXPECT_GT(brightness(map.picture(50, 200)), 230);
  EXPECT_GT(brightness(map.picture(50, 400)), 200);
}

/// The raster as GDAL sees it, processed by `gdaldem mode` and read back.
Raster<float> gdaldem(const Raster<float>& cells, double cell, const char* mode, std::vector<const char*> arguments) {
  GDALAllRegister();
  GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
  const int width = static_cast<int>(cells.width()), height = static_cast<int>(cells.height());
  GDALDataset* from = memory->Create("", width, height, 1, GDT_Float32, nullptr);
  double transform[6] = {0, cell, 0, 0, 0, -cell};
  from->SetGeoTransform(transform);
  EXPECT_EQ(from->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, width, height, const_cast<float*>(cells.data()), width, height,
                                             GDT_Float32, 0, 0, nullptr),
            CE_None);
  for (const char* each : {"-of", "MEM"}) arguments.push_back(each);
  arguments.push_back(nullptr);
  GDALDEMProcessingOptions* options = GDALDEMProcessingOptionsNew(const_cast<char**>(arguments.data()), nullptr);
  GDALDatasetH to = GDALDEMProcessing("", GDALDataset::ToHandle(from), mode, nullptr, options, nullptr);
  Raster<float> out(width, height);
  EXPECT_EQ(GDALRasterIO(GDALGetRasterBand(to, 1), GF_Read, 0, 0, width, height, out.data(), width, height, GDT_Float32, 0, 0),
            CE_None);
  GDALDEMProcessingOptionsFree(options);
  GDALClose(to);
  GDALClose(GDALDataset::ToHandle(from));
  return out;
}

// The independent authority for core/terrain/slope.h and hillshade.h.
TEST(GdalDem, GivesTheSameSlope) {
  const Raster<float> cells = hills(40, 30), theirs = gdaldem(cells, 30, "slope", {});
  Raster<float> ours(40, 30);
  slope(cells.view(), {0, 0, 40, 30}, {30, 30}, ours.view());
  for (std::int64_t y = 1; y < 29; ++y)
    for (std::int64_t x = 1; x < 39; ++x) EXPECT_NEAR(ours(x, y), theirs(x, y), 1e-3);
}

TEST(GdalDem, GivesTheSameAspect) {
  const Raster<float> cells = hills(40, 30), theirs = gdaldem(cells, 30, "aspect", {});
  for (std::int64_t y = 1; y < 29; ++y)
    for (std::int64_t x = 1; x < 39; ++x)
      EXPECT_NEAR(std::remainder(aspect_deg(*complete_gradient(cells.view(), x, y, {30, 30})) - theirs(x, y), 360.0), 0, 1e-2);
}

// Mark's definition from four hillshades and the aspects that gdaldem makes; it stores 1 + 254 times the light as a byte.
TEST(GdalDem, GivesTheSameLightsAndMarksWeightsTheSameSum) {
  const Raster<float> cells = hills(40, 30), aspects = gdaldem(cells, 30, "aspect", {});
  Raster<float> ours(40, 30), one(40, 30);
  hillshade(cells.view(), {0, 0, 40, 30}, {30, 30}, {}, ours.view());
  Raster<double> sum(40, 30, 0.0);
  for (const char* azimuth : {"225", "270", "315", "360"}) {
    const Raster<float> theirs = gdaldem(cells, 30, "hillshade", {"-az", azimuth});
    HillshadeOptions options;
    options.azimuth_deg = std::stod(azimuth);
    hillshade(cells.view(), {0, 0, 40, 30}, {30, 30}, options, one.view());
    for (std::int64_t y = 1; y < 29; ++y)
      for (std::int64_t x = 1; x < 39; ++x) {
        EXPECT_NEAR(1 + 254 * one(x, y), theirs(x, y), 1) << azimuth;
        const double weight = std::pow(std::sin((aspects(x, y) - *options.azimuth_deg) * M_PI / 180), 2);
        sum(x, y) += weight / 2 * (static_cast<double>(theirs(x, y)) - 1) / 254;
      }
  }
  for (std::int64_t y = 1; y < 29; ++y)
    for (std::int64_t x = 1; x < 39; ++x) EXPECT_NEAR(ours(x, y), sum(x, y), 1.0 / 254) << x << ' ' << y;
}

}  // namespace
}  // namespace arete
