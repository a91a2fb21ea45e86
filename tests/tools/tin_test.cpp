#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

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
  const Outcome obj = run("tin " + dem_ + " " + path("mesh.obj") + " --max-error 20 --drape relief --normals");
  ASSERT_EQ(obj.code, 0) << obj.err;
  EXPECT_THAT(read(path("mesh.mtl")), HasSubstr("map_Kd mesh.png"));
  EXPECT_GE(read_picture(path("mesh.png")).width(), 150);
  const Outcome glb = run("tin " + dem_ + " " + path("mesh.glb") + " --max-error 20 --drape relief --normals --crs EPSG:3857");
  ASSERT_EQ(glb.code, 0) << glb.err;
  EXPECT_THAT(read(path("mesh.glb")), HasSubstr("TEXCOORD_0"));
  EXPECT_THAT(read(path("mesh.glb")), HasSubstr("PNG"));
  EXPECT_EQ(run("verify " + path("mesh.glb") + " --dem " + dem_ + " --max-error 20").code, 0);
  EXPECT_EQ(run("tin " + dem_ + " " + path("other.ply") + " --max-error 20 --drape relief").code, 2);
}

/// A plain with a peak at column 110, row 30, in degrees or not; and a picture that is red about the peak and blue elsewhere.
class DrapedPeak : public VerbFixture {
 protected:
  static constexpr std::int64_t width = 150, height = 120, column = 110, row = 30;

  std::string write_peak(bool degrees) const {
    Raster<float> cells(width, height, 100.0f);
    cells(column, row) = 900;
    GeoReference geo;
    geo.transform = degrees ? std::array<double, 6>{9, 0.001, 0, 47, 0, -0.001} : std::array<double, 6>{500000, 30, 0, 4600000, 0, -30};
    geo.crs_wkt = crs_wkt(degrees ? "EPSG:4326" : "EPSG:32633");
    DemWriter writer(path("peak.tif"), {width, height}, geo);
    writer.write(0, {0, 0, width, height}, cells.view());
    writer.commit();
    return path("peak.tif");
  }
  std::string write_marked_picture() const {
    Picture picture(4 * width, 4 * height, {0, 0, 255, 255});
    fill(picture, {4 * (column - 2), 4 * (row - 2), 20, 20}, {255, 0, 0, 255});
    write_picture(path("marked.png"), picture);
    return path("marked.png");
  }
  struct DrapedVertex {
    double height, across, down;  ///< of the picture, from its upper left corner
  };
  /// The peak is on red, whatever is a hundred metres high, in the west, on blue.
  static void expect_draped(const std::vector<DrapedVertex>& vertices, const Picture& picture) {
    int peaks = 0, others = 0;
    for (const DrapedVertex& v : vertices) {
      const Colour c = picture(static_cast<std::int64_t>(v.across * static_cast<double>(picture.width())), static_cast<std::int64_t>(v.down * static_cast<double>(picture.height())));
      const bool is_peak = v.height > 800;
      (is_peak ? peaks : others) += 1;
      if (is_peak) {
        EXPECT_TRUE(c[0] > 230 && c[2] < 25) << v.across << ", " << v.down;
      } else if (v.across < 0.5) {
        EXPECT_TRUE(c[0] < 25 && c[2] > 230) << v.across << ", " << v.down;
      }
    }
    EXPECT_EQ(peaks, 1);
    EXPECT_GE(others, 4);
  }
  static std::vector<DrapedVertex> read_obj_vertices(const std::string& file, double offset) {
    std::istringstream lines(read(file));
    std::vector<double> heights;
    std::vector<DrapedVertex> vertices;
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string keyword;
      double x = 0, y = 0, z = 0;
      words >> keyword >> x >> y >> z;
      if (keyword == "v") heights.push_back(z + offset);
      if (keyword == "vt") vertices.push_back({heights[vertices.size()], x, 1 - y});
    }
    return vertices;
  }
};

TEST_F(DrapedPeak, LiesOnItsTexelInObj) {
  const std::string picture = write_marked_picture();
  for (const bool degrees : {false, true}) {  // those become UTM
    const std::string dem = write_peak(degrees);
    const Outcome made = run("tin " + dem + " " + path("mesh.obj") + " --max-error 1 --overwrite --drape " + picture);
    ASSERT_EQ(made.code, 0) << made.err;
    expect_draped(read_obj_vertices(path("mesh.obj"), 0), read_picture(path("mesh.png")));
    std::filesystem::remove(dem);
  }
}

TEST_F(DrapedPeak, LiesOnItsTexelInGlb) {
  const std::string dem = write_peak(true);
  const Outcome made = run("tin " + dem + " " + path("mesh.glb") + " --max-error 1 --drape " + write_marked_picture());
  ASSERT_EQ(made.code, 0) << made.err;
  // GLB: 12 bytes of header, then chunks of a length, a type and bytes: JSON, binary.
  const std::string bytes = read(path("mesh.glb"));
  const auto number_at = [&](std::size_t at) {
    std::uint32_t number = 0;
    std::memcpy(&number, bytes.data() + at, 4);
    return std::size_t{number};
  };
  const std::size_t json_bytes = number_at(12), binary = 20 + json_bytes + 8;
  const auto document = nlohmann::json::parse(bytes.substr(20, json_bytes));
  const auto floats = [&](const nlohmann::json& index, std::size_t per_vertex) {
    const auto& accessor = document["accessors"][index.get<std::size_t>()];
    const auto& view = document["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    std::vector<float> values(accessor["count"].get<std::size_t>() * per_vertex);
    std::memcpy(values.data(), bytes.data() + binary + view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0}), 4 * values.size());
    return values;
  };
  ASSERT_EQ(document["meshes"].size(), 1u);
  const auto& attributes = document["meshes"][0]["primitives"][0]["attributes"];
  const std::vector<float> positions = floats(attributes["POSITION"], 3), places = floats(attributes["TEXCOORD_0"], 2);
  const double lowest = [&] {
    double low = positions[1];
    for (std::size_t i = 1; i < positions.size(); i += 3) low = std::min<double>(low, positions[i]);
    return low;
  }();
  std::vector<DrapedVertex> vertices;
  for (std::size_t i = 0; i < positions.size() / 3; ++i) vertices.push_back({positions[3 * i + 1] - lowest + 100, places[2 * i], places[2 * i + 1]});
  const auto& image = document["bufferViews"][document["images"][0]["bufferView"].get<std::size_t>()];
  write(path("inside.png"), bytes.substr(binary + image.value("byteOffset", std::size_t{0}), image["byteLength"].get<std::size_t>()));
  expect_draped(vertices, read_picture(path("inside.png")));
}

TEST_F(TinVerb, RefusesPicturesBeforeItWorks) {
  const std::size_t before = entries();
  const Outcome none = run("tin " + dem_ + " " + path("mesh.obj") + " --max-error 5 --drape " + path("none.png"));
  EXPECT_EQ(none.code, 3);
  EXPECT_EQ(none.error_lines(), 1) << none.err;
  const Outcome globe = run("tin " + dem_ + " " + path("mesh.glb") + " --max-error 5 --crs ecef --drape relief");
  EXPECT_EQ(globe.code, 2);
  EXPECT_THAT(globe.err, HasSubstr("map plane"));
  EXPECT_EQ(run("tin " + dem_ + " " + path("mesh.tiles") + " --max-error 5 --drape relief").code, 2);
  EXPECT_EQ(entries(), before);
}

TEST_F(TinVerb, LeavesNoSideFilesOfAnOverwrittenMesh) {
  ASSERT_EQ(run("tin " + dem_ + " " + path("mesh.obj") + " --max-error 20 --drape relief").code, 0);
  for (const char* side : {"mesh.mtl", "mesh.png", "mesh.prj", "mesh_offset.xyz"}) EXPECT_TRUE(std::filesystem::exists(path(side))) << side;
  ASSERT_EQ(run("tin " + dem_ + " " + path("mesh.obj") + " --max-error 20 --overwrite").code, 0);
  EXPECT_FALSE(std::filesystem::exists(path("mesh.mtl")));
  EXPECT_TRUE(std::filesystem::exists(path("mesh_offset.xyz")));
  EXPECT_EQ(run("verify " + path("mesh.obj") + " --dem " + dem_ + " --max-error 20").code, 0);
  // A mesh in another format beside it has the same .prj.
  EXPECT_EQ(run("tin " + dem_ + " " + path("mesh.ply") + " --max-error 20").code, 0);
}

TEST_F(TinVerb, TheSameBytesForAnyThreadsAndMemory) {
  ASSERT_EQ(run("tin " + dem_ + " " + path("one.ply") + " --max-error 5 --threads 1").code, 0);
  ASSERT_EQ(run("tin " + dem_ + " " + path("two.ply") + " --max-error 5 --threads 2").code, 0);
  EXPECT_EQ(read(path("one.ply")), read(path("two.ply")));
  ASSERT_EQ(run("tin " + dem_ + " " + path("little.ply") + " --max-error 5 --memory 64M").code, 0);
  EXPECT_EQ(read(path("one.ply")), read(path("little.ply")));
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
