#include "gis/tin/read_lines.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/support/error.h"
#include "gis/crs.h"

namespace arete {
namespace {

using testing::HasSubstr;

class ReadLines : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("arete-lines-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    const std::string path = (folder_ / name).string();
    std::ofstream(path) << text;
    return path;
  }
  /// GeoJSON of one geometry, in degrees unless a CRS is named.
  std::string write_geometry(const std::string& geometry, const std::string& crs = "") const {
    const std::string named = crs.empty() ? "" : R"("crs":{"type":"name","properties":{"name":")" + crs + R"("}},)";
    return write("lines.geojson", R"({"type":"FeatureCollection",)" + named + R"("features":[{"type":"Feature","properties":{},"geometry":)" + geometry + "}]}");
  }
  static std::string message_of(const std::function<void()>& work) {
    try {
      work();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

constexpr Size size{100, 80};

/// Cells of 10 m in UTM 32.
GeoReference utm() {
  GeoReference geo;
  geo.transform = std::array<double, 6>{500000, 10, 0, 5200000, 0, -10};
  geo.crs_wkt = crs_wkt("EPSG:32632");
  return geo;
}

TEST_F(ReadLines, CountsFromTheCentreOfTheFirstCell) {
  const std::string path = write_geometry(R"({"type":"LineString","coordinates":[[500005,5199995],[500105,5199965],[500123,5199900]]})", "urn:ogc:def:crs:EPSG::32632");
  const LinesInRaster read = read_breaklines(path, utm(), size);
  ASSERT_EQ(read.lines.size(), 1u);
  EXPECT_EQ(read.lines[0], (RasterLine{{0, 0}, {10, 3}, {11.8, 9.5}}));
  EXPECT_EQ(read.features, 1);
  EXPECT_EQ(read.features_inside, 1);
  EXPECT_FALSE(read.crs_unknown);
}

// The central meridian of UTM 32 is 9 E; its easting there is 500000 m by definition, so that a northing is all that is computed.
TEST_F(ReadLines, TransformsIntoTheCrsOfTheRaster) {
  const std::string path = write_geometry(R"({"type":"LineString","coordinates":[[9,46.9],[9,47]]})");
  GeoReference geo = utm();
  (*geo.transform)[0] = 499900;
  const LinesInRaster read = read_breaklines(path, geo, size);
  ASSERT_EQ(read.lines.size(), 1u);
  for (const RasterPlace& p : read.lines[0]) EXPECT_NEAR(p[0], 9.5, 1e-6);
  // A degree of latitude about 46.95 N: 111132.95 - 559.85 cos(2 * 46.95) + 1.175 cos(4 * 46.95) = 111169.9 m on WGS 84.
  EXPECT_NEAR(read.lines[0][0][1] - read.lines[0][1][1], 11116.99 * 0.9996 / 10, 0.02);
}

TEST_F(ReadLines, TakesRingsAndPartsOfCollections) {
  const std::string path = write_geometry(
      R"({"type":"GeometryCollection","geometries":[{"type":"Point","coordinates":[500100,5199900]},
          {"type":"MultiLineString","coordinates":[[[500100,5199900],[500200,5199900]],[[500100,5199800],[500200,5199800]]]},
          {"type":"Polygon","coordinates":[[[500100,5199900],[500300,5199900],[500200,5199700],[500100,5199900]]]}]})",
      "urn:ogc:def:crs:EPSG::32632");
  EXPECT_EQ(read_breaklines(path, utm(), size).lines.size(), 3u);
}

TEST_F(ReadLines, LeavesOutWhatDoesNotMeetTheRaster) {
  const std::string path = write_geometry(R"({"type":"LineString","coordinates":[[0,0],[1,1]]})", "urn:ogc:def:crs:EPSG::32632");
  const LinesInRaster read = read_breaklines(path, utm(), size);
  EXPECT_TRUE(read.lines.empty());
  EXPECT_EQ(read.features, 1);
  EXPECT_EQ(read.features_inside, 0);
}

TEST_F(ReadLines, SaysWhereOneCrsIsUnknown) {
  const std::string path = write_geometry(R"({"type":"LineString","coordinates":[[500100,5199900],[500200,5199900]]})", "urn:ogc:def:crs:EPSG::32632");
  GeoReference geo = utm();
  geo.crs_wkt = "";
  EXPECT_TRUE(read_breaklines(path, geo, size).crs_unknown);
}

TEST_F(ReadLines, ChoosesALayer) {
  const std::string path = write_geometry(R"({"type":"LineString","coordinates":[[500100,5199900],[500200,5199900]]})", "urn:ogc:def:crs:EPSG::32632");
  EXPECT_EQ(read_breaklines(path + "|lines", utm(), size).lines.size(), 1u);
  EXPECT_EQ(read_breaklines(path + "|layername=lines", utm(), size).lines.size(), 1u);
  EXPECT_THAT(message_of([&] { read_breaklines(path + "|roads", utm(), size); }), HasSubstr("has no layer 'roads'"));
}

TEST_F(ReadLines, RefusesInOneLine) {
  EXPECT_THAT(message_of([&] { read_breaklines((folder_ / "none.gpkg").string(), utm(), size); }), HasSubstr("none.gpkg"));
  EXPECT_THAT(message_of([&] { read_breaklines(write("text.geojson", "no lines"), utm(), size); }), HasSubstr("cannot read lines"));
  const std::string points = write_geometry(R"({"type":"Point","coordinates":[9,46.95]})");
  EXPECT_THAT(message_of([&] { read_breaklines(points, utm(), size); }), HasSubstr("has no lines"));
  EXPECT_THAT(message_of([&] { read_boundary(points, utm(), size); }), HasSubstr("has no polygons"));
}

TEST_F(ReadLines, UnitesPolygons) {
  const std::string path = write_geometry(
      R"({"type":"MultiPolygon","coordinates":[[[[500105,5199895],[500205,5199895],[500205,5199795],[500105,5199795],[500105,5199895]]],
                                               [[[500155,5199895],[500305,5199895],[500305,5199795],[500155,5199795],[500155,5199895]]]]})",
      "urn:ogc:def:crs:EPSG::32632");
  const LinesInRaster read = read_boundary(path, utm(), size);
  ASSERT_EQ(read.lines.size(), 1u);
  EXPECT_TRUE(is_inside(read.lines, {17, 15})) << "of both polygons";
  EXPECT_TRUE(is_inside(read.lines, {12, 15}));
  EXPECT_FALSE(is_inside(read.lines, {31, 15}));
}

TEST_F(ReadLines, MakesABowTieValid) {
  const std::string path = write_geometry(R"({"type":"Polygon","coordinates":[[[500105,5199895],[500305,5199795],[500305,5199895],[500105,5199795],[500105,5199895]]]})",
                                          "urn:ogc:def:crs:EPSG::32632");
  const LinesInRaster read = read_boundary(path, utm(), size);
  EXPECT_TRUE(is_inside(read.lines, {12, 15}));
  EXPECT_TRUE(is_inside(read.lines, {28, 15}));
  EXPECT_FALSE(is_inside(read.lines, {20, 11}));
}

}  // namespace
}  // namespace arete
