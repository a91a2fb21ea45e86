#include "gis/mesh/side_files.h"

#include <gtest/gtest.h>

#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

TEST(Prj, HoldsTheWktOfEsri) {
  TestFolder folder;
  write_prj(frame_of("EPSG:32632+5773"), folder / "a.b.ply");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.b.prj"});
  const std::string text = get_file(folder / "a.b.prj");
  EXPECT_EQ(text.rfind("PROJCS[\"WGS_1984_UTM_Zone_32N\",GEOGCS[\"GCS_WGS_1984\"", 0), 0u) << text;
  EXPECT_NE(text.find(",VERTCS[\"EGM96_Geoid\""), std::string::npos) << text;
}

TEST(Prj, BringsTheVerticalUnitOfTheReferenceSystem) {
  TestFolder folder;
  write_prj(frame_of("EPSG:2277+6360"), folder / "a.ply");  // NAVD88 height (ftUS)
  const MeshFrame back = read_prj(folder / "a.ply");
  EXPECT_NEAR(back.metres_per_unit, 1200.0 / 3937.0, 1e-15);
  EXPECT_EQ(summarise_crs(back.crs_wkt).vertical_name, "NAVD88 height (ftUS)");
}

TEST(Prj, ThatIsMissingOrNonsenseIsNoReferenceSystem) {
  TestFolder folder;
  EXPECT_EQ(read_prj(folder / "a.ply").crs_wkt, "");
  put_file(folder / "a.prj", "nonsense");
  EXPECT_EQ(read_prj(folder / "a.ply").crs_wkt, "");
}

TEST(VerticalUnitText, IsReadBackExactly) {
  for (const MeshFrame& frame :
       {MeshFrame{"", "m", 1}, MeshFrame{"", "US survey foot", 1200.0 / 3937.0}, MeshFrame{"", "a = b", 0.1}}) {
    MeshFrame back;
    parse_vertical_unit(vertical_unit_text(frame), back);
    EXPECT_EQ(back.vertical_unit, frame.vertical_unit);
    EXPECT_EQ(back.metres_per_unit, frame.metres_per_unit);
  }
  for (const char* text : {"", "ft", "ft = 0 m", "ft = x m", "ft = 1 ft", " = 1 m"}) {
    MeshFrame back;
    parse_vertical_unit(text, back);
    EXPECT_EQ(back.vertical_unit, "m") << text;
    EXPECT_EQ(back.metres_per_unit, 1) << text;
  }
}

TEST(MeshOffset, IsWholeAndNearTheMiddleOfLargeCoordinatesOnly) {
  EXPECT_EQ(mesh_offset({{450123.4, -5200000.7, -100}, {450999.5, -5100000.1, 8848}}), (MeshVertex{450561, -5150000, 0}));
  EXPECT_EQ(mesh_offset({{-16384, 0, 6378137.5}, {16384, 16384.5, 6378137.5}}), (MeshVertex{0, 8192, 6378138}));
}

TEST(OffsetRounding, BoundsWhatTheOffsetDoes) {
  EXPECT_EQ(offset_rounding(-1e6, 1e6, 0), 0);
  EXPECT_EQ(offset_rounding(450123, 470000, 460000), 0);
  EXPECT_EQ(offset_rounding(-5e6, -4e6, -4500000), 0);
  // Around 0 and over many binary orders, by trial.
  const double low = 0.001, high = 900000, offset = 450000, bound = offset_rounding(low, high, offset);
  EXPECT_GT(bound, 0);
  for (double v = low; v < high; v *= 1.0001) ASSERT_LE(std::abs(offset + (v - offset) - v), bound);
}

}  // namespace
}  // namespace arete
