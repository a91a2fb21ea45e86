#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gis/image.h"
#include "gis/mesh/mesh_format.h"
#include "tests/tools/verb_fixture.h"

namespace arete {
namespace {

using testing::HasSubstr;

class TinVerb : public VerbFixture {
 protected:
  void SetUp() override {
    VerbFixture::SetUp();
    dem_ = write_mountains("dem.tif", {150, 120});
  }
  std::string dem_;
};

TEST_F(TinVerb, EveryFormatKeepsTheBound) {
  int formats = 0;
  for (const MeshFormat& format : mesh_formats())
    for (const std::string& extension : format.extensions) {
      const std::string mesh = path("mesh" + extension);
      const Outcome made = run("tin " + dem_ + " " + mesh + " --max-error 5 --overwrite");
      ASSERT_EQ(made.code, 0) << extension << ": " << made.err;
      EXPECT_THAT(made.out, HasSubstr("proven: no cell is further off than")) << extension;
      const Outcome verified = run("verify " + mesh + " --dem " + dem_ + " --max-error 5");
      EXPECT_EQ(verified.code, 0) << extension << ": " << verified.err;
      EXPECT_THAT(verified.out, HasSubstr("bound of 5 m: kept")) << extension;
      ++formats;
    }
  EXPECT_GE(formats, 12);
}

TEST_F(TinVerb, OtherPlanesKeepTheBound) {
  for (const std::string crs : {"EPSG:3857", "EPSG:4326", "utm", "ecef"}) {
    const std::string mesh = path("mesh.ply");
    const Outcome made = run("tin " + dem_ + " " + mesh + " --max-error 5 --overwrite --crs " + crs);
    ASSERT_EQ(made.code, 0) << crs << ": " << made.err;
    const Outcome verified = run("verify " + mesh + " --dem " + dem_ + " --max-error 5");
    EXPECT_EQ(verified.code, 0) << crs << ": " << verified.err;
  }
}

TEST_F(TinVerb, SaysWhatItMadeAsData) {
  const Outcome made = run("tin " + dem_ + " " + path("mesh.ply") + " --max-error 5 --json");
  const auto data = nlohmann::json::parse(made.out);
  EXPECT_LE(data["max_error_m"], 5);
  EXPECT_GT(data["max_error_m"], 4);
  EXPECT_EQ(data["cells"], 150 * 120 - 1);
  EXPECT_EQ(data["format"], "PLY");
  EXPECT_EQ(data["crs"], "EPSG:32633");
  const auto told = nlohmann::json::parse(run("info " + path("mesh.ply") + " --json").out);
  EXPECT_EQ(told["triangles"], data["triangles"]);
}

TEST_F(TinVerb, MeetsANumberOfTrianglesToAPercent) {
  for (const int most : {300, 2000, 10000}) {
    const Outcome made = run("tin " + dem_ + " " + path("mesh.ply") + " --overwrite --json --max-triangles " + std::to_string(most));
    ASSERT_EQ(made.code, 0) << made.err;
    const int triangles = nlohmann::json::parse(made.out)["triangles"];
    EXPECT_LE(triangles, most);
    EXPECT_GE(triangles, 0.99 * most);
  }
}

TEST_F(TinVerb, MeetsAnRmse) {
  const Outcome made = run("tin " + dem_ + " " + path("mesh.ply") + " --rmse 3 --json");
  ASSERT_EQ(made.code, 0) << made.err;
  const double rmse = nlohmann::json::parse(made.out)["rmse_m"];
  EXPECT_LE(rmse, 3);
  EXPECT_GE(rmse, 2.9);
}

TEST_F(TinVerb, ReadsTreesAtAnyLevel) {
  ASSERT_EQ(run("compress " + dem_ + " " + path("dem.sct")).code, 0);
  for (const int level : {0, 1, 2}) {
    const std::string at = " --level " + std::to_string(level);
    ASSERT_EQ(run("decompress " + path("dem.sct") + " " + path("level.tif") + " --overwrite" + at).code, 0);
    const Outcome made = run("tin " + path("dem.sct") + " " + path("mesh.ply") + " --max-error 5 --overwrite" + at);
    ASSERT_EQ(made.code, 0) << made.err;
    const Outcome verified = run("verify " + path("mesh.ply") + " --dem " + path("level.tif") + " --max-error 5");
    EXPECT_EQ(verified.code, 0) << level << ": " << verified.err;
  }
  const Outcome beyond = run("tin " + path("dem.sct") + " " + path("mesh.ply") + " --max-error 5 --overwrite --level 30");
  EXPECT_EQ(beyond.code, 2);
  EXPECT_THAT(beyond.err, HasSubstr("has levels 0 to"));
}

TEST_F(TinVerb, DrapesTheRelief) {
  const Outcome obj = run("tin " + dem_ + " " + path("mesh.obj") + " --max-error 20 --drape --normals");
  ASSERT_EQ(obj.code, 0) << obj.err;
  EXPECT_THAT(read(path("mesh.mtl")), HasSubstr("map_Kd mesh.png"));
  EXPECT_GE(read_picture(path("mesh.png")).width(), 150);
  const Outcome glb = run("tin " + dem_ + " " + path("mesh.glb") + " --max-error 20 --drape --normals --crs EPSG:3857");
  ASSERT_EQ(glb.code, 0) << glb.err;
  EXPECT_THAT(read(path("mesh.glb")), HasSubstr("TEXCOORD_0"));
  EXPECT_THAT(read(path("mesh.glb")), HasSubstr("PNG"));
  EXPECT_EQ(run("verify " + path("mesh.glb") + " --dem " + dem_ + " --max-error 20").code, 0);
  EXPECT_EQ(run("tin " + dem_ + " " + path("other.ply") + " --max-error 20 --drape").code, 2);
}

TEST_F(TinVerb, TheSameBytesForAnyThreads) {
  ASSERT_EQ(run("tin " + dem_ + " " + path("one.ply") + " --max-error 5 --threads 1").code, 0);
  ASSERT_EQ(run("tin " + dem_ + " " + path("two.ply") + " --max-error 5 --threads 2").code, 0);
  EXPECT_EQ(read(path("one.ply")), read(path("two.ply")));
}

TEST_F(TinVerb, RefusesInOneLineAndWritesNothing) {
  const std::size_t before = entries();
  for (const std::string arguments : {"--max-error 0", "--max-error -3", "--max-error nan", "--max-error 1 --rmse 1", "", "--max-triangles 1", "--rmse 0",
                                      "--max-error 5 --crs EPSG:1", "--max-error 0.00001", "--max-error 5 --normals --draco"}) {
    const Outcome refused = run("tin " + dem_ + " " + path("mesh.ply") + " " + arguments);
    EXPECT_EQ(refused.code, 2) << arguments << ": " << refused.err;
    EXPECT_EQ(refused.error_lines(), 1) << arguments << ": " << refused.err;
  }
  EXPECT_EQ(run("tin " + dem_ + " " + path("mesh.foo") + " --max-error 1").code, 4);
  EXPECT_EQ(run("tin " + path("none.tif") + " " + path("mesh.ply") + " --max-error 1").code, 3);
  EXPECT_EQ(run("tin " + dem_ + " " + path("none/mesh.ply") + " --max-error 1").code, 5);
  EXPECT_EQ(entries(), before);
  write(path("mesh.ply"), "mine");
  EXPECT_EQ(run("tin " + dem_ + " " + path("mesh.ply") + " --max-error 1").code, 5);
  EXPECT_EQ(read(path("mesh.ply")), "mine");
}

TEST_F(TinVerb, AFullDiskLeavesNothing) {
  const std::size_t before = entries();
  // No file may grow beyond 8 blocks of 512 bytes: what a full disk is to the writer.
  for (const char* name : {"mesh.ply", "mesh.obj", "mesh.glb"}) {
    const std::string command = "tin " + dem_ + " " + path(name) + " --max-error 2";
    const int status = std::system(("trap '' XFSZ; ulimit -f 8; " + std::string(ARETE_TOOL) + " " + command + " > /dev/null 2>&1").c_str());
    EXPECT_EQ(WEXITSTATUS(status), 5) << name;
    EXPECT_EQ(entries(), before) << name;
  }
}

}  // namespace
}  // namespace arete
