#include "gis/vertical_unit.h"

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

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

// 0.3048 m: the international agreement of 1959. 1200/3937 m: the Mendenhall order of 1893.
TEST(VerticalUnit, KnowsTheUsualSpellings) {
  for (const char* name : {"m", "M", "metre", "Meters"}) EXPECT_EQ(vertical_unit(name, "").metres, 1) << name;
  for (const char* name : {"ft", "Foot", "FEET", "foot (International)"}) EXPECT_EQ(vertical_unit(name, "").metres, 0.3048) << name;
  for (const char* name : {"US survey foot", "us-ft", "ftUS", "foot_us", "Foot (US survey)"})
    EXPECT_EQ(vertical_unit(name, "").metres, 1200.0 / 3937.0) << name;
  EXPECT_EQ(vertical_unit("cm", "").metres, 0.01);
  EXPECT_EQ(vertical_unit("ft", "").name, "ft");
}

TEST(VerticalUnit, TakesAnUnknownNameForTheMetreAndSaysSo) {
  const VerticalUnit unit = vertical_unit("cubits", "");
  EXPECT_EQ(unit.metres, 1);
  EXPECT_EQ(unit.name, "cubits");
  EXPECT_FALSE(unit.known);
}

TEST(VerticalUnit, OfTheBandComesBeforeThatOfTheCrs) {
  const std::string feet = wkt_of("EPSG:32612+6360");  // NAVD88 height (ftUS)
  EXPECT_NEAR(vertical_unit("", feet).metres, 1200.0 / 3937.0, 1e-15);
  EXPECT_EQ(vertical_unit("m", feet).metres, 1);
  EXPECT_EQ(vertical_unit("", wkt_of("EPSG:32632+5773")).name, "m");
  // Feet across say nothing about feet up: NAD83 / Texas Central (ftUS).
  EXPECT_EQ(vertical_unit("", wkt_of("EPSG:2277")).metres, 1);
  EXPECT_FALSE(vertical_unit("", wkt_of("EPSG:2277")).stated);
  EXPECT_TRUE(vertical_unit("", feet).stated);
}

}  // namespace
}  // namespace arete
