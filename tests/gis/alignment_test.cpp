#include "gis/alignment.h"

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "core/support/error.h"

namespace arete {
namespace {

std::string wkt(int epsg, int vertical = 0) {
  OGRSpatialReference crs, height;
  crs.importFromEPSG(epsg);
  if (vertical != 0) {
    height.importFromEPSG(vertical);
    OGRSpatialReference both;
    both.SetCompoundCS("both", &crs, &height);
    crs = both;
  }
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  char* text = nullptr;
  crs.exportToWkt(&text, options);
  std::string result = text;
  CPLFree(text);
  return result;
}

Placed placed(const std::string& name, double x, double y, double cell, Size size, const std::string& crs) {
  Placed raster{name, {}, size};
  raster.geo.transform = {x, cell, 0, y, 0, -cell};
  raster.geo.crs_wkt = crs;
  return raster;
}

std::string refusal(const Placed& a, const Placed& b) {
  try {
    align_grids(a, b);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "";
}

TEST(AlignGrids, TheSameGridIsComparedWhole) {
  const Placed a = placed("a.tif", 600000, 5200000, 10, {100, 80}, wkt(32632));
  const Alignment alignment = align_grids(a, a);
  EXPECT_EQ(alignment.reference, (Window{0, 0, 100, 80}));
  EXPECT_EQ(alignment.result, alignment.reference);
  EXPECT_TRUE(alignment.notes.empty());
}

TEST(AlignGrids, DifferentExtentsShareTheirCommonWindowAndSaySo) {
  const Placed a = placed("a.tif", 600000, 5200000, 10, {100, 80}, wkt(32632));
  const Placed b = placed("b.tif", 600200, 5200050, 10, {200, 60}, wkt(32632));
  const Alignment alignment = align_grids(a, b);
  EXPECT_EQ(alignment.reference, (Window{20, 0, 80, 55}));
  EXPECT_EQ(alignment.result, (Window{0, 5, 80, 55}));
  ASSERT_EQ(alignment.notes.size(), 1u);
  EXPECT_NE(alignment.notes[0].find("80 x 55"), std::string::npos);
}

TEST(AlignGrids, RefusesOtherGridsWithBothNamesAndAWayOut) {
  const Placed a = placed("a.tif", 600000, 5200000, 10, {100, 80}, wkt(32632));
  for (const Placed& b : {placed("b.tif", 600000, 5200000, 5, {200, 160}, wkt(32632)),
                          placed("b.tif", 600000.001, 5200000, 10, {100, 80}, wkt(32632)),
                          placed("b.tif", 600000, 5200000, 10.00001, {100, 80}, wkt(32632)),
                          placed("b.tif", 600000, 5200000, 10, {100, 80}, wkt(32633)),
                          placed("b.tif", 700000, 5200000, 10, {100, 80}, wkt(32632))}) {
    const std::string message = refusal(a, b);
    for (const char* part : {"a.tif", "b.tif", "--resample"}) EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(AlignGrids, AMillionthOfACellDoesNotMatter) {
  const Placed a = placed("a.tif", 600000, 5200000, 10, {100, 80}, wkt(32632));
  EXPECT_NO_THROW(align_grids(a, placed("b.tif", 600000.000005, 5200000, 10, {100, 80}, wkt(32632))));
}

TEST(AlignGrids, AMissingCrsIsTakenOverWithANote) {
  const Placed a = placed("a.tif", 600000, 5200000, 10, {100, 80}, wkt(32632));
  EXPECT_EQ(align_grids(a, placed("b.asc", 600000, 5200000, 10, {100, 80}, "")).notes.size(), 1u);
}

TEST(AlignGrids, WithoutAGeoreferenceTheSizeDecides) {
  const Placed a = placed("a.tif", 600000, 5200000, 10, {100, 80}, wkt(32632));
  EXPECT_EQ(align_grids(a, {"b.png", {}, {100, 80}}).notes.size(), 1u);
  EXPECT_NE(refusal(a, {"b.png", {}, {100, 81}}).find("b.png"), std::string::npos);
}

TEST(SameHorizontalCrs, IgnoresNamesAndTheVerticalPart) {
  EXPECT_TRUE(same_horizontal_crs(wkt(25832, 5773), wkt(25832)));
  EXPECT_FALSE(same_horizontal_crs(wkt(4326), wkt(32632)));
}

TEST(PlaceInCells, FollowsSizeAndPlace) {
  const Placed a = placed("a.tif", 600000, 5200000, 10, {100, 80}, wkt(32632)), b = placed("b.tif", 600050, 5199980, 2.5, {40, 40}, wkt(32632));
  EXPECT_EQ(place_in_cells(a, a), (std::array<double, 6>{0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(place_in_cells(a, b), (std::array<double, 6>{5, 0.25, 0, 2, 0, 0.25}));
  Placed turned = b;
  turned.geo.transform = {600050, 0, 2.5, 5199980, -2.5, 0};  // its columns run south, its rows east
  EXPECT_EQ(place_in_cells(a, turned), (std::array<double, 6>{5, 0, 0.25, 2, 0.25, 0}));
}

TEST(PlaceInCells, RefusesOtherGround) {
  const Placed a = placed("a.tif", 600000, 5200000, 10, {100, 80}, wkt(32632));
  const auto refused = [&](const Placed& b) {
    try {
      place_in_cells(a, b);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused(placed("b.tif", 601000, 5200000, 10, {100, 80}, wkt(32632))).find("share no ground"), std::string::npos);
  EXPECT_NE(refused(placed("b.tif", 600000, 5200000, 10, {100, 80}, wkt(32633))).find("different coordinate systems"), std::string::npos);
  Placed bare = placed("b.tif", 0, 0, 1, {100, 80}, "");
  bare.geo.transform.reset();
  EXPECT_EQ(refused(bare), "");
  bare.size = {100, 81};
  EXPECT_NE(refused(bare).find("not of the same size"), std::string::npos);
}

}  // namespace
}  // namespace arete
