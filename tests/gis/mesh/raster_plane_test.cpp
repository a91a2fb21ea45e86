#include "gis/mesh/raster_plane.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "core/support/random.h"
#include "gis/crs.h"
#include "tests/gis/mesh/test_mesh.h"

namespace arete {
namespace {

GeoReference utm() {
  GeoReference geo;
  geo.transform = {500000.3, 10, 0, 4600000.7, 0, -10};
  geo.crs_wkt = crs_wkt("EPSG:32633");
  return geo;
}

RasterPoint placed(const MeshVertex& vertex, const MeshFrame& frame, const GeoReference& geo) {
  RasterPoint point;
  RasterPlane(frame, geo).place(0, {&vertex, 1}, {&point, 1});
  return point;
}

/// Every half cell of a block, at heights that floats hold, taken into another CRS by OGR.
void expect_all_come_back(const GeoReference& geo, const std::string& other, bool with_height, double metres_per_unit = 1) {
  MeshFrame frame;
  frame.crs_wkt = crs_wkt(other);
  frame.metres_per_unit = metres_per_unit;
  OGRSpatialReference from, to;
  from.importFromWkt(geo.crs_wkt.c_str());
  to.importFromWkt(frame.crs_wkt.c_str());
  if (with_height) from.PromoteTo3D(nullptr);
  from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  to.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> change(OGRCreateCoordinateTransformation(&from, &to));
  ASSERT_NE(change, nullptr);
  const RasterPlane plane(frame, geo);
  for (std::int64_t i = 0; i < 2000; ++i) {
    const auto column = static_cast<std::int64_t>(6000 * uniform_at(1, static_cast<std::uint64_t>(i))), row = static_cast<std::int64_t>(6000 * uniform_at(2, static_cast<std::uint64_t>(i)));
    const auto z = static_cast<float>(4000 * uniform_at(3, static_cast<std::uint64_t>(i)) - 100);
    MeshVertex v = place(geo, static_cast<double>(column) / 2, static_cast<double>(row) / 2, static_cast<double>(z));
    ASSERT_TRUE(change->Transform(1, &v.x, &v.y, with_height ? &v.z : nullptr));
    v.z /= metres_per_unit;
    RasterPoint point;
    plane.place(i, {&v, 1}, {&point, 1});
    ASSERT_EQ(point.column, column * cell_units / 2);
    ASSERT_EQ(point.row, row * cell_units / 2);
    ASSERT_EQ(point.z, static_cast<double>(z));
  }
}

TEST(RasterPlane, HalfCellsComeBackExactlyFromOtherCrs) {
  expect_all_come_back(utm(), "EPSG:32633", false);
  expect_all_come_back(utm(), "EPSG:32633", false, 0.3048);
  expect_all_come_back(utm(), "EPSG:3857", false);
  expect_all_come_back(utm(), "EPSG:4326", false);
  expect_all_come_back(utm(), "EPSG:32632", false, 0.3048);
  expect_all_come_back(utm(), "EPSG:4978", true);
}

// PROJ's way back over these is off by 1e-4 of a cell.
TEST(RasterPlane, HalfCellsComeBackExactlyOverDatumShifts) {
  GeoReference geo;
  geo.transform = {780000.5, 10, 0, 190000.25, 0, -10};
  for (const char* swiss : {"EPSG:21781", "EPSG:2056"}) {
    if (swiss == std::string("EPSG:2056")) geo.transform = {2780000.5, 10, 0, 1190000.25, 0, -10};
    geo.crs_wkt = crs_wkt(swiss);
    for (const char* other : {"EPSG:3857", "EPSG:4326", "EPSG:32632"}) expect_all_come_back(geo, other, false);
    expect_all_come_back(geo, "EPSG:4978", true);
  }
  geo.transform = {300000, 5, 0, 400000, 0, -5};
  for (const char* crs : {"EPSG:31287", "EPSG:27700"}) {
    geo.crs_wkt = crs_wkt(crs);
    expect_all_come_back(geo, "EPSG:3857", false);
    expect_all_come_back(geo, "EPSG:4978", true);
  }
  geo.transform = {550000, 1, 0, 4300000, 0, -1};
  geo.crs_wkt = crs_wkt("EPSG:6341");
  expect_all_come_back(geo, "EPSG:4978", true);
}

TEST(RasterPlane, HalfCellsOfAGeographicRasterComeBackExactly) {
  GeoReference geo;
  geo.transform = {9.6, 1.0 / 3600, 0, 47.1, 0, -1.0 / 3600};
  geo.crs_wkt = crs_wkt("EPSG:4326");
  expect_all_come_back(geo, "EPSG:4326", false);
  expect_all_come_back(geo, "EPSG:32632", false);
  expect_all_come_back(geo, "EPSG:4978", true);
}

TEST(RasterPlane, OtherPlacesStayWhereTheyAre) {
  const RasterPoint point = placed({500000.3 + 33.125, 4600000.7 - 47.2, 1e-9}, {}, utm());
  EXPECT_NEAR(static_cast<double>(point.column), 2.8125 * static_cast<double>(cell_units), 4);
  EXPECT_NEAR(static_cast<double>(point.row), 4.22 * static_cast<double>(cell_units), 4);
  EXPECT_EQ(point.z, 1e-9);
  // 2e-6 of a cell from a half is not noise.
  EXPECT_NE(placed({500000.3 + 30 + 2e-5, 4600000.7 - 50, 0}, {}, utm()).column % (cell_units / 2), 0);
  EXPECT_EQ(placed({500000.3 + 30 + 2e-6, 4600000.7 - 50, 0}, {}, utm()).column, 5 * cell_units / 2);
}

TEST(RasterPlane, ARotatedTransformIsInverted) {
  GeoReference geo;
  geo.transform = {1000, 8, 6, 2000, 6, -8};
  const MeshVertex v = place(geo, 12.5, 7, 3);
  const RasterPoint point = placed(v, {}, geo);
  EXPECT_EQ(point.column, 25 * cell_units / 2);
  EXPECT_EQ(point.row, 7 * cell_units);
  EXPECT_EQ(RasterPlane({}, geo).orientation(), -1);
  geo.transform = {1000, -8, 0, 2000, 0, -8};
  EXPECT_EQ(RasterPlane({}, geo).orientation(), 1);
}

TEST(RasterPlane, RefusesWhatHasNoPlace) {
  const auto message = [](const MeshVertex& vertex, const MeshFrame& frame, const GeoReference& geo) -> std::string {
    try {
      placed(vertex, frame, geo);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.what();
    }
    return "placed";
  };
  EXPECT_NE(message({std::nan(""), 0, 0}, {}, utm()).find("vertex 0 of the mesh lies nowhere near"), std::string::npos);
  EXPECT_NE(message({1e300, 0, 0}, {}, utm()).find("nowhere near"), std::string::npos);
  EXPECT_NE(message({500000, 4600000, HUGE_VAL}, {}, utm()).find("nowhere near"), std::string::npos);
  MeshFrame frame;
  frame.crs_wkt = "rubbish";
  EXPECT_NE(message({0, 0, 0}, frame, utm()).find("cannot be read"), std::string::npos);
  frame.crs_wkt = crs_wkt("EPSG:4326");
  EXPECT_NE(message({15, 95, 0}, frame, utm()).find("no place"), std::string::npos);
  GeoReference flat = utm();
  (*flat.transform)[5] = 0;
  EXPECT_NE(message({0, 0, 0}, {}, flat).find("cannot be inverted"), std::string::npos);
}

}  // namespace
}  // namespace arete
