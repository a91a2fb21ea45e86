#include "gis/crs.h"

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "core/support/error.h"

namespace arete {
namespace {

std::string wkt_of(const char* definition) {
  OGRSpatialReference crs;
  EXPECT_EQ(crs.SetFromUserInput(definition), OGRERR_NONE);
  char* text = nullptr;
  crs.exportToWkt(&text);
  std::string wkt = text;
  CPLFree(text);
  return wkt;
}

// Names and codes: the EPSG registry.
TEST(SummariseCrs, SeparatesTheHorizontalAndTheVerticalPart) {
  const CrsSummary utm = summarise_crs(wkt_of("EPSG:32632+5773"));
  EXPECT_EQ(utm.name, "WGS 84 / UTM zone 32N");
  EXPECT_EQ(utm.authority, "EPSG:32632");
  EXPECT_EQ(utm.unit, "metre");
  EXPECT_EQ(utm.vertical_name, "EGM96 height");
  EXPECT_EQ(utm.vertical_authority, "EPSG:5773");
  EXPECT_FALSE(utm.geographic);
  const CrsSummary wgs84 = summarise_crs(wkt_of("EPSG:4326"));
  EXPECT_EQ(wgs84.name, "WGS 84");
  EXPECT_EQ(wgs84.authority, "EPSG:4326");
  EXPECT_EQ(wgs84.unit, "degree");
  EXPECT_EQ(wgs84.vertical_name, "");
  EXPECT_TRUE(wgs84.geographic);
}

TEST(SummariseCrs, IsEmptyForWhatIsNoCrs) {
  EXPECT_EQ(summarise_crs("").name, "");
  EXPECT_EQ(summarise_crs("PROJCS[").name, "");
}

// 500000 m east in UTM is the central meridian, 9 E in zone 32; northing 0 is the equator (definition of UTM).
TEST(GeographicExtent, OfAUtmGridAtItsOrigin) {
  GeoReference geo;
  geo.crs_wkt = wkt_of("EPSG:32632+5773");
  geo.transform = {500000, 10, 0, 1000, 0, -10};
  const auto extent = geographic_extent(geo, {100, 100});
  ASSERT_TRUE(extent);
  EXPECT_NEAR(extent->west, 9, 1e-9);
  EXPECT_NEAR(extent->south, 0, 1e-9);
  EXPECT_NEAR(extent->east, 9 + 1000 / (0.9996 * 6378137) * 57.29577951308232, 1e-6);
  EXPECT_GT(extent->north, extent->south);
}

TEST(GeographicExtent, OfAGeographicGridIsItsOwn) {
  GeoReference geo;
  geo.crs_wkt = wkt_of("EPSG:4326");
  geo.transform = {9.5, 0.25, 0, 47, 0, -0.25};
  const auto extent = geographic_extent(geo, {4, 2});
  ASSERT_TRUE(extent);
  EXPECT_NEAR(extent->west, 9.5, 1e-12);
  EXPECT_NEAR(extent->east, 10.5, 1e-12);
  EXPECT_NEAR(extent->south, 46.5, 1e-12);
  EXPECT_NEAR(extent->north, 47, 1e-12);
}

TEST(GeographicExtent, NeedsATransformAndACrs) {
  GeoReference geo;
  EXPECT_FALSE(geographic_extent(geo, {4, 2}));
  geo.transform = {9.5, 0.25, 0, 47, 0, -0.25};
  EXPECT_FALSE(geographic_extent(geo, {4, 2}));
}

TEST(CrsWkt, UnderstandsCodesAndRefusesNonsense) {
  EXPECT_EQ(summarise_crs(crs_wkt("EPSG:32632")).name, "WGS 84 / UTM zone 32N");
  EXPECT_EQ(summarise_crs(crs_wkt("+proj=longlat +datum=WGS84")).geographic, true);
  EXPECT_THROW(crs_wkt("EPSG:1"), Error);
  EXPECT_THROW(crs_wkt("somewhere"), Error);
}

}  // namespace
}  // namespace arete
