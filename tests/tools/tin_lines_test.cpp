#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/verb_fixture.h"

namespace arete {
namespace {

using testing::HasSubstr;

class TinLinesVerb : public VerbFixture {
 protected:
  /// A layer in the CRS of the mountains.
  void write_layer(const std::string& name, const std::string& geometry) const {
    write(path(name), R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::32633"}},"features":[{"type":"Feature","properties":{},"geometry":)" +
                          geometry + "}]}");
  }
  /// In columns and rows from the corner of write_mountains' rasters.
  static std::string at(double column, double row) { return "[" + std::to_string(500000 + 30 * column) + "," + std::to_string(4600000 - 30 * row) + "]"; }
};

TEST_F(TinLinesVerb, KeepsTheBoundWithLinesAndABoundary) {
  const std::string dem = write_mountains("dem.tif", {90, 70});
  write_layer("lines.geojson", R"({"type":"LineString","coordinates":[)" + at(3.3, 5.1) + "," + at(80.2, 60.7) + "," + at(85, 3) + "]}");
  write_layer("area.geojson", R"({"type":"Polygon","coordinates":[[)" + at(2, 2) + "," + at(88.3, 9.1) + "," + at(50.2, 66.6) + "," + at(2, 2) + "]]}");
  write_layer("far.geojson", R"({"type":"Polygon","coordinates":[[)" + at(1002, 2) + "," + at(1088.3, 9.1) + "," + at(1050.2, 66.6) + "," + at(1002, 2) + "]]}");

  const Outcome lines = run("tin " + dem + " " + path("lines.ply") + " --max-error 4 --breaklines " + path("lines.geojson"));
  EXPECT_EQ(lines.code, 0) << lines.err;
  EXPECT_EQ(run("verify " + path("lines.ply") + " --dem " + dem + " --max-error 4").code, 0);

  const Outcome clipped = run("tin " + dem + " " + path("clipped.glb") + " --max-error 4 --breaklines " + path("lines.geojson") + " --boundary " + path("area.geojson"));
  EXPECT_EQ(clipped.code, 0) << clipped.err;
  EXPECT_EQ(run("verify " + path("clipped.glb") + " --dem " + dem + " --max-error 4 --clipped").code, 0);
  EXPECT_NE(run("verify " + path("clipped.glb") + " --dem " + dem + " --max-error 4").code, 0) << "cells outside are uncovered";

  const Outcome outside = run("tin " + dem + " " + path("no.ply") + " --max-error 4 --boundary " + path("far.geojson"));
  EXPECT_EQ(outside.code, 3);
  EXPECT_EQ(outside.error_lines(), 1);
  EXPECT_THAT(outside.err, HasSubstr("lies outside"));
  const Outcome none = run("tin " + dem + " " + path("same.ply") + " --max-error 4 --breaklines " + path("far.geojson"));
  EXPECT_EQ(none.code, 0);
  EXPECT_THAT(none.err, HasSubstr("no breaklines"));
  EXPECT_EQ(run("tin " + dem + " " + path("plain.ply") + " --max-error 4").code, 0);
  EXPECT_EQ(read(path("same.ply")), read(path("plain.ply")));
  const Outcome missing = run("tin " + dem + " " + path("no.ply") + " --max-error 4 --breaklines " + path("missing.gpkg"));
  EXPECT_EQ(missing.code, 3);
  EXPECT_EQ(missing.error_lines(), 1);
}

}  // namespace
}  // namespace arete
