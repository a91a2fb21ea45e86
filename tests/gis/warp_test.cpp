#include "gis/warp.h"

#include <cmath>

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "core/support/error.h"

namespace arete {
namespace {

GeoReference placed(double x, double y, double cell) {
  GeoReference geo;
  geo.transform = {x, cell, 0, y, 0, -cell};
  return geo;
}

/// z = 2 x - y at the centres of the cells.
Raster<float> plane(const GeoReference& geo, Size size) {
  const auto& t = *geo.transform;
  Raster<float> cells(size.width, size.height);
  for (std::int64_t y = 0; y < size.height; ++y)
    for (std::int64_t x = 0; x < size.width; ++x)
      cells(x, y) = static_cast<float>(2 * (t[0] + (static_cast<double>(x) + 0.5) * t[1]) - (t[3] + (static_cast<double>(y) + 0.5) * t[5]));
  return cells;
}

TEST(WarpedSource, OnTheSameGridIsTheSame) {
  const GeoReference geo = placed(0, 1000, 10);
  const Raster<float> cells = plane(geo, {40, 30});
  const ViewSource source(cells.view());
  const Raster<float> warped = read_all(WarpedSource(source, geo, geo, {40, 30}));
  for (std::int64_t i = 0; i < 1200; ++i) EXPECT_FLOAT_EQ(warped.data()[i], cells.data()[i]);
}

TEST(WarpedSource, APlaneStaysThatPlaneOnAShiftedAndOnAFinerGrid) {
  const GeoReference from = placed(0, 1000, 10);
  const Raster<float> cells = plane(from, {60, 60});
  const ViewSource source(cells.view());
  for (const GeoReference& to : {placed(103.7, 904.2, 10), placed(100, 900, 2.5), placed(100, 900, 20)}) {
    const Size size{15, 15};
    const Raster<float> warped = read_all(WarpedSource(source, from, to, size)), expected = plane(to, size);
    for (std::int64_t i = 0; i < size.cells(); ++i) EXPECT_NEAR(warped.data()[i], expected.data()[i], 2e-3) << i;
  }
}

TEST(WarpedSource, BeyondTheOldRasterAndInVoidsItIsVoid) {
  const GeoReference from = placed(0, 1000, 10), to = placed(-50, 1050, 10);
  Raster<float> cells(30, 30, 7.0f);
  cells(10, 10) = void_value;
  const ViewSource source(cells.view());
  const Raster<float> warped = read_all(WarpedSource(source, from, to, {40, 40}));
  EXPECT_TRUE(is_void(warped(2, 20)));
  EXPECT_TRUE(is_void(warped(15, 15)));
  EXPECT_FLOAT_EQ(warped(16, 15), 7);
  EXPECT_FLOAT_EQ(warped(5, 5), 7);
}

TEST(WarpedSource, DoesNotDependOnTheWindow) {
  const GeoReference from = placed(0, 1000, 10), to = placed(3.1, 998.7, 7);
  Raster<float> cells(90, 90);
  for (std::int64_t i = 0; i < 8100; ++i) cells.data()[i] = static_cast<float>(std::sin(static_cast<double>(i)) * 50);
  const ViewSource source(cells.view());
  const WarpedSource warped(source, from, to, {100, 100});
  const Raster<float> whole = read_all(warped);
  Raster<float> part(13, 9);
  warped.read({31, 44, 13, 9}, part.view());
  for (std::int64_t y = 0; y < 9; ++y)
    for (std::int64_t x = 0; x < 13; ++x) EXPECT_EQ(part(x, y), whole(31 + x, 44 + y));
}

TEST(WarpedSource, FailuresOfTheSourceComeThrough) {
  struct Broken final : RasterSource {
    Size size() const override { return {10, 10}; }
    void read(const Window&, RasterView<float>) const override { throw Error(ErrorKind::input, "broken"); }
  };
  const Broken source;
  const WarpedSource warped(source, placed(0, 100, 10), placed(5, 95, 10), {5, 5});
  EXPECT_THROW(read_all(warped), Error);
}

TEST(WarpedSource, TransformsTheCrs) {
  OGRSpatialReference geographic, projected;
  geographic.importFromEPSG(4326);
  geographic.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  projected.importFromEPSG(32632);
  const auto wkt = [](const OGRSpatialReference& crs) {
    char* text = nullptr;
    crs.exportToWkt(&text);
    const std::string result = text;
    CPLFree(text);
    return result;
  };
  // Heights that are the longitude, read back where UTM says that longitude is: 9 degrees east is easting 500 km by definition.
  GeoReference from = placed(8.5, 47, 0.01), to = placed(500000 - 500, 5150000, 1000);
  from.crs_wkt = wkt(geographic), to.crs_wkt = wkt(projected);
  Raster<float> longitude(100, 100);
  for (std::int64_t y = 0; y < 100; ++y)
    for (std::int64_t x = 0; x < 100; ++x) longitude(x, y) = static_cast<float>(8.5 + 0.01 * (static_cast<double>(x) + 0.5));
  const ViewSource source(longitude.view());
  const Raster<float> warped = read_all(WarpedSource(source, from, to, {1, 20}));
  for (std::int64_t y = 0; y < 20; ++y) EXPECT_NEAR(warped(0, y), 9, 1e-5);
}

}  // namespace
}  // namespace arete
