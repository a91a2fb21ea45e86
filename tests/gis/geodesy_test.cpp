#include "gis/geodesy.h"

#include <gtest/gtest.h>

namespace arete {
namespace {

const char* const wgs84 =
    "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],"
    "UNIT[\"degree\",0.0174532925199433]]";

// Length of one degree at 60 degrees north on WGS 84: 55 800 m along the parallel, 111 412 m along the meridian (NGA tables).
TEST(CellSize, OfAGeographicGridIsGeodesicMetres) {
  GeoReference geo;
  geo.crs_wkt = wgs84;
  geo.transform = {10, 0.001, 0, 60.05, 0, -0.001};
  const CellSize cell = cell_size(geo, {100, 100});
  EXPECT_NEAR(cell.x_m, 55.80, 0.01);
  EXPECT_NEAR(cell.y_m, 111.412, 0.002);
}

TEST(CellSize, WithoutCrsIsTheTransformsOwnNumbers) {
  GeoReference geo;
  geo.transform = {0, 5, 0, 0, 0, -4};
  const CellSize cell = cell_size(geo, {10, 10});
  EXPECT_EQ(cell.x_m, 5);
  EXPECT_EQ(cell.y_m, 4);
}

}  // namespace
}  // namespace arete
