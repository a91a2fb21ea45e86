#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gis/dem_file.h"
#include "gis/image.h"
#include "gis/mesh/mesh_format.h"
#include "tests/gis/mesh/test_mesh.h"
#include "tests/tools/verb_fixture.h"

namespace arete {
namespace {

using testing::HasSubstr;

/// A DEM of 60 x 40 cells with one void, and its mesh.
class MeshVerbs : public VerbFixture {
 protected:
  void SetUp() override {
    VerbFixture::SetUp();
    dem_path_ = write_mountains("dem.tif", {60, 40});
    const DemReader reader(dem_path_);
    geo_ = reader.georeference();
    mesh_ = quarter_mesh(read_all(reader).view(), geo_);
  }
  std::string write_mesh(const std::string& name) const {
    MeshFrame frame;
    frame.crs_wkt = geo_.crs_wkt;
    mesh_format_of(path(name)).write(mesh_.store(), frame, path(name), {});
    return path(name);
  }
  std::string dem_path_;
  GeoReference geo_;
  TestMesh mesh_;
};

TEST_F(MeshVerbs, VerifyKeepsABoundThatIsKept) {
  const std::string mesh = write_mesh("mesh.ply");
  const Outcome text = run("verify " + mesh + " --dem " + dem_path_ + " --max-error 0");
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("PLY, 18,400 triangles"));
  EXPECT_THAT(text.out, HasSubstr("2,399 of 2,399 valid cells compared, 0 of them further off than 0 m"));
  EXPECT_THAT(text.out, HasSubstr("covers 2300 cells, exactly the domain of the DEM"));
  EXPECT_THAT(text.out, HasSubstr("manifold; 1 part"));
  EXPECT_THAT(text.out, HasSubstr("bound of 0 m: kept"));
  const Outcome json = run("verify " + mesh + " --dem " + dem_path_ + " --max-error 0 --json");
  const auto data = nlohmann::json::parse(json.out);
  EXPECT_EQ(data["kept"], true);
  EXPECT_EQ(data["max_error_m"], 0);
  EXPECT_EQ(data["valid_cells"], 2399);
  EXPECT_EQ(data["area_exact"], true);
  EXPECT_EQ(data["components"], 1);
  EXPECT_TRUE(data["faults"].empty());
}

TEST_F(MeshVerbs, VerifySaysWhatIsBroken) {
  const Raster<float> dem = read_all(DemReader(dem_path_));
  const MeshVertex centre = place(geo_, 7, 9, 0);
  mesh_.vertices[static_cast<std::size_t>(mesh_.at(centre.x, centre.y))].z += 12;
  mesh_.triangles.pop_back();
  const std::string mesh = write_mesh("mesh.ply"), command = "verify " + mesh + " --dem " + dem_path_;
  const Outcome broken = run(command + " --max-error 10");
  EXPECT_EQ(broken.code, 8);
  EXPECT_EQ(broken.error_lines(), 1);
  EXPECT_THAT(broken.err, HasSubstr("1 cells are further off than 10 m, first column 7, row 9"));
  EXPECT_THAT(broken.err, HasSubstr("the triangles cover 2299.875 cells"));
  EXPECT_EQ(broken.out, "");
  // Without a bound it is told.
  const Outcome told = run(command);
  EXPECT_EQ(told.code, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr("at column 7, row 9"));
  EXPECT_THAT(told.out, HasSubstr("fault: "));
  EXPECT_EQ(told.out.find("kept"), std::string::npos);
  const Outcome clipped = run(command + " --max-error 12.001 --clipped");
  EXPECT_EQ(clipped.code, 0) << clipped.err;
}

TEST_F(MeshVerbs, VerifyWithoutDemLooksAtTheTriangles) {
  mesh_.triangles.push_back(mesh_.triangles[0]);
  const Outcome text = run("verify " + write_mesh("mesh.ply"));
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("3 not manifold"));
}

TEST_F(MeshVerbs, VerifyRefusesInOneLine) {
  const std::string mesh = write_mesh("mesh.ply"), other = write_mountains("other.tif", {30, 20});
  write(path("rubbish.ply"), "ply\nformat of nothing\n");
  const std::vector<std::pair<std::string, int>> cases = {
      {"verify " + mesh + " --max-error 5", 2},
      {"verify " + mesh + " --clipped", 2},
      {"verify " + path("none.ply"), 3},
      {"verify " + path("rubbish.ply"), 3},
      {"verify " + mesh + " --dem " + path("none.tif"), 3},
      {"verify " + mesh + " --dem " + dem_path_ + " --max-error -1", 2},
      {"verify " + dem_path_ + " --max-error 5", 2},
      {"verify " + mesh + " --dem " + other + " --max-error 5", 8},
  };
  for (const auto& [command, code] : cases) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, code) << command << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << command << outcome.err;
  }
}

// Whatever a format rounds, its half cells are found again.
TEST_F(MeshVerbs, VerifyFindsHalfCellsInEveryFormat) {
  for (const MeshFormat& format : mesh_formats()) {
    const std::string mesh = write_mesh("mesh" + format.extensions.front());
    const Outcome outcome = run("verify " + mesh + " --dem " + dem_path_ + " --max-error 0.01 --json --quiet");
    EXPECT_EQ(outcome.code, 0) << format.name << ": " << outcome.err;
  }
}

// Floats move these vertices by up to a hundred-thousandth of a cell, on cliffs of 9000 m: they are found again, and what moving them costs is told.
TEST_F(MeshVerbs, VerifySeesWhatRoundingCosts) {
  Raster<float> cliffs(300, 4);
  for (std::int64_t y = 0; y < 4; ++y)
    for (std::int64_t x = 0; x < 300; ++x) cliffs(x, y) = x % 2 == 0 ? 0.0F : 9000.0F;
  geo_.transform = {500000, 1.0 / 3, 0, 4600000, 0, -1.0 / 3};
  DemWriter writer(path("cliffs.tif"), cliffs.size(), geo_);
  writer.write(0, {0, 0, 300, 4}, cliffs.view());
  writer.commit();
  mesh_ = grid_mesh(cliffs.view(), 1, geo_);
  const std::string command = "verify " + write_mesh("mesh.stl") + " --dem " + path("cliffs.tif");
  EXPECT_EQ(run(command + " --max-error 1").code, 0);
  const Outcome finer = run(command + " --max-error 0.001");
  EXPECT_EQ(finer.code, 8);
  EXPECT_THAT(finer.err, HasSubstr("cells are further off than 0.001 m"));
  EXPECT_EQ(finer.err.find("no triangle"), std::string::npos) << finer.err;
}

TEST_F(MeshVerbs, InfoDescribesAMesh) {
  const std::string mesh = write_mesh("mesh.ply");
  const Outcome text = run("info " + mesh);
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("Triangles      18,400"));
  EXPECT_THAT(text.out, HasSubstr("X              500015 .. 501785"));
  EXPECT_THAT(text.out, HasSubstr("Y              4598815 .. 4599985"));
  EXPECT_THAT(text.out, HasSubstr("Area           2.07 km2"));
  EXPECT_THAT(text.out, HasSubstr("manifold; 1 part"));
  const auto data = nlohmann::json::parse(run("info --json " + mesh).out);
  EXPECT_EQ(data["kind"], "mesh");
  EXPECT_EQ(data["format"], "PLY");
  EXPECT_EQ(data["triangles"], 18400);
  EXPECT_EQ(data["bounds"]["low"]["x"], 500015);
  EXPECT_EQ(data["area_m2"], 2300.0 * 900);
  EXPECT_EQ(data["manifold"], true);
  // Half cells along the outside, and around the void cell.
  EXPECT_EQ(data["border_edges"], 2 * 2 * (59 + 39) + 8);
}

TEST_F(MeshVerbs, PreviewDrawsAMesh) {
  const std::string mesh = write_mesh("mesh.ply");
  const Outcome lined = run("preview " + mesh + " " + path("lined.png") + " --no-legend --width 590 --json");
  ASSERT_EQ(lined.code, 0) << lined.err;
  ASSERT_EQ(run("preview " + mesh + " " + path("bare.png") + " --no-legend --width 590 --no-wireframe").code, 0);
  const Picture a = read_picture(path("lined.png")), b = read_picture(path("bare.png"));
  ASSERT_EQ(a.width(), 590);
  ASSERT_EQ(a.height(), 390);
  EXPECT_EQ(nlohmann::json::parse(lined.out)["metres_per_pixel"], 3);
  std::int64_t darker = 0;
  for (std::int64_t i = 0; i < 590 * 390; ++i) darker += a.data()[i][1] < b.data()[i][1];
  EXPECT_GT(darker, 590 * 390 / 4);
  EXPECT_LT(darker, 590 * 390);
}

}  // namespace
}  // namespace arete
