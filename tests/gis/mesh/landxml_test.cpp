#include "gis/mesh/landxml.h"

#include <gtest/gtest.h>

#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

TEST(LandXml, IsReadFromItsSpecificationAlone) {
  TestFolder folder;
  const MeshStore mesh = hills(40, 450123.456789, 5200000.1);
  MeshWriteOptions options;
  options.title = "<hills> & \"dales\" \xc3\xa9 \xff";
  write_landxml(mesh, frame_of("EPSG:32632+5773"), folder / "mesh.xml", options);
  const MeshStore back = read_by_python(folder / "mesh.xml");
  EXPECT_EQ(vertices_of(back), vertices_of(mesh));
  EXPECT_EQ(triangles_of(back), triangles_of(mesh));
  const std::string text = get_file(folder / "mesh.xml");
  EXPECT_NE(text.find("<P id=\"1\">5200000.1 450123.456789 0</P>\n"), std::string::npos);
  EXPECT_NE(text.find("epsgCode=\"32632\" verticalDatum=\"EGM96 height\" ogcWktCode=\"COMPD_CS["), std::string::npos);
}

std::string surface(const std::string& points, const std::string& faces, const std::string& before = "") {
  return "<?xml version=\"1.0\"?>\n<lx:LandXML xmlns:lx=\"http://www.landxml.org/schema/LandXML-1.1\">" + before +
         "<lx:Surfaces><lx:Surface name=\"a\"><lx:Definition surfType=\"TIN\"><lx:Pnts>" + points + "</lx:Pnts><lx:Faces>" +
         faces + "</lx:Faces></lx:Definition></lx:Surface></lx:Surfaces></lx:LandXML>";
}

const std::string points =
    "<lx:P id=\"10\">1.5 2 3</lx:P><lx:P id=\"4\"> 4\n5 6 </lx:P><lx:P id='1'>7 8 9</lx:P><lx:P id=\"2\">7 8 9</lx:P>";

TEST(LandXml, OfOtherProgramsIsRead) {
  TestFolder folder;
  put_file(folder / "mesh.xml", surface(points, "<lx:F n=\"0 2 0\">10 4 1</lx:F><lx:F i=\"1\">10 4 2</lx:F>",
                                        "<lx:Units><lx:Imperial linearUnit=\"USSurveyFoot\"/></lx:Units><lx:CoordinateSystem "
                                        "epsgCode=\"2277\" ogcWktCode=\"TX83-CF\"/>"));
  const MeshFile file = read_landxml(folder / "mesh.xml", {});
  EXPECT_EQ(vertices_of(file.mesh), (std::vector<MeshVertex>{{2, 1.5, 3}, {5, 4, 6}, {8, 7, 9}, {8, 7, 9}}));
  // The second face is invisible: it fills what is no terrain.
  EXPECT_EQ(triangles_of(file.mesh), (std::vector<MeshTriangle>{{0, 1, 2}}));
  EXPECT_EQ(file.frame.metres_per_unit, 1200.0 / 3937.0);
  EXPECT_EQ(summarise_crs(file.frame.crs_wkt).authority, "EPSG:2277");
}

TEST(LandXml, WithBadContentsIsRefusedWithTheReason) {
  TestFolder folder;
  const struct {
    std::string text, expected;
    ErrorKind kind;
  } cases[] = {{surface(points, "<lx:F>10 4 1 2</lx:F>"), "more than three points", ErrorKind::input},
               {surface(points, "<lx:F>10 4</lx:F>"), "does not name three points", ErrorKind::input},
               {surface(points, "<lx:F>10 4 3</lx:F>"), "names the point 3", ErrorKind::input},
               {surface(points + "<lx:P id=\"4\">0 0 0</lx:P>", ""), "point 4 is given a second time", ErrorKind::input},
               {surface("<lx:P id=\"4\">0 0</lx:P>", ""), "northing easting elevation", ErrorKind::input},
               {surface("<lx:P>0 0 0</lx:P>", ""), "northing easting elevation", ErrorKind::input},
               {surface(points, "", "<lx:Surface/>"), "more than one surface", ErrorKind::input},
               {surface(points, "", "<lx:Definition surfType=\"grid\"/>"), "expected TIN", ErrorKind::input},
               {surface(points, "<lx:F>"), "mismatched tag", ErrorKind::input},
               {"<LandXML/>", "holds no surface", ErrorKind::format},
               {"<VRTDataset/>", "not LandXML", ErrorKind::format},
               {"", "no element found", ErrorKind::format}};
  for (const auto& bad : cases) {
    put_file(folder / "bad.xml", bad.text);
    const Error error = error_of([&] { read_landxml(folder / "bad.xml", {}); });
    EXPECT_EQ(error.kind(), bad.kind) << error.what();
    EXPECT_NE(std::string(error.what()).find(bad.expected), std::string::npos) << error.what();
  }
}

TEST(LandXml, IsWrittenInMetresOnly) {
  TestFolder folder;
  EXPECT_EQ(error_of([&] {
              write_landxml(hills(2, 0, 0), {"", "ft", 0.3048}, folder / "mesh.xml", {});
            }).kind(),
            ErrorKind::format);
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace arete
