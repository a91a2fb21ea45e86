// Meshes as preview draws them in perspective and view shows them beside their DEM.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "gis/image.h"
#include "gis/mesh/mesh_format.h"
#include "tests/shaders/mesa.h"
#include "tests/tools/verb_fixture.h"

namespace arete {
namespace {

using testing::HasSubstr;

class MeshPerspective : public VerbFixture {
 protected:
  void SetUp() override {
    VerbFixture::SetUp();
    hold_mesa_still();
    dem_ = write_mountains("dem.tif", {150, 120});
    const Outcome outcome = draw("dem.tif", "dem.png");
    if (outcome.code == 3 && outcome.err.find("OpenGL") != std::string::npos) GTEST_SKIP() << outcome.err;
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  Outcome draw(const std::string& input, const std::string& picture, const std::string& options = "") const {
    return run("preview " + path(input) + " " + path(picture) + " --view perspective --size 200x150 --no-legend --exaggeration 1 --overwrite --json " + options);
  }
  void mesh(const std::string& name, const std::string& options = "") const {
    const Outcome outcome = run("tin " + dem_ + " " + path(name) + " --max-error 2 " + options);
    ASSERT_EQ(outcome.code, 0) << name << ": " << outcome.err;
  }
  /// Mean of the differences of all colours, in steps of 255.
  double difference(const std::string& a, const std::string& b) const {
    const Picture first = read_picture(path(a)), second = read_picture(path(b));
    EXPECT_EQ(first.width(), second.width());
    double sum = 0;
    for (std::int64_t y = 0; y < first.height(); ++y)
      for (std::int64_t x = 0; x < first.width(); ++x)
        for (std::size_t c = 0; c < 3; ++c) sum += std::abs(first(x, y)[c] - second(x, y)[c]);
    return sum / static_cast<double>(3 * first.width() * first.height());
  }
  std::string dem_;
};

TEST_F(MeshPerspective, EveryFormatLooksLikeTheDem) {
  for (const MeshFormat& format : mesh_formats())
    for (const std::string& extension : format.extensions) {
      mesh("mesh" + extension);
      const Outcome outcome = draw("mesh" + extension, "mesh.png");
      ASSERT_EQ(outcome.code, 0) << extension << ": " << outcome.err;
      EXPECT_GT(nlohmann::json::parse(outcome.out)["triangles"], 1000);
      // Measured: 1.5. A blank sheet differs by 20 and more.
      EXPECT_LT(difference("mesh.png", "dem.png"), 3) << extension;
    }
}

TEST_F(MeshPerspective, GeocentricCoordinatesAreDrawnUpright) {
  mesh("round.ply", "--crs ecef");
  ASSERT_EQ(draw("round.ply", "mesh.png").code, 0);
  // North is that of longitude and latitude, 1.5 degrees off that of the DEM at the zone's edge or less.
  EXPECT_LT(difference("mesh.png", "dem.png"), 6);
}

TEST_F(MeshPerspective, AMeshThatIsNowhereOnEarthIsDrawnInItsOwnUnits) {
  write(path("free.obj"), "v 0 0 0\nv 10 0 1\nv 10 10 3\nv 0 10 0\nf 1 2 3\nf 1 3 4\n");
  const Outcome outcome = draw("free.obj", "free.png");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto data = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(data["high_m"], 3);
  EXPECT_EQ(data["triangles"], 2 + 4 * 2);  // and walls
}

TEST_F(MeshPerspective, LinesAreDrawnAndLevelsRefused) {
  mesh("mesh.ply");
  ASSERT_EQ(draw("mesh.ply", "lit.png").code, 0);
  ASSERT_EQ(draw("mesh.ply", "lines.png", "--style wireframe").code, 0);
  EXPECT_GT(difference("lit.png", "lines.png"), 0.7);  // measured: 1.4; repeated: 0
  const Outcome outcome = draw("mesh.ply", "levels.png", "--style levels");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.error_lines(), 1);
  EXPECT_THAT(outcome.err, HasSubstr("--style levels is of DEMs"));
  EXPECT_FALSE(std::filesystem::exists(path("levels.png")));
}

TEST_F(MeshPerspective, CamerasColoursContoursAndDrapesAreThoseOfDems) {
  mesh("mesh.ply");
  ASSERT_EQ(draw("mesh.ply", "plain.png").code, 0);
  const std::string place = "501000,4599000";
  for (const std::string& options : {std::string("--colour slope"), std::string("--contours=100"), "--drape " + dem_, "--look-at " + place + " --distance 4000 --pitch 60",
                                     "--look-at " + place + " --eye 503500,4597500,+900"}) {
    for (const auto& [input, picture] : {std::pair{"dem.tif", "same.png"}, {"mesh.ply", "mesh.png"}}) {
      const Outcome outcome = draw(input, picture, options);
      ASSERT_EQ(outcome.code, 0) << options << ": " << outcome.err;
    }
    const double change = difference("mesh.png", "plain.png");
    EXPECT_GT(change, 0.8) << options;
    EXPECT_LT(difference("mesh.png", "same.png"), std::min(8.0, 0.6 * change)) << options;
  }
  EXPECT_EQ(draw("mesh.ply", "round.png", "--turntable 2").code, 0);
  EXPECT_TRUE(std::filesystem::exists(path("round-001.png")));
  EXPECT_EQ(draw("mesh.ply", "light.exr").code, 0);
  for (const char* options : {"--eye 501000,4599000,-4000", "--look-at 400000,4597000", "--contours=none"}) {
    const Outcome outcome = draw("mesh.ply", "none.png", options);
    EXPECT_EQ(outcome.code, 2) << options;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(path("none.png")));
  }
}

TEST_F(MeshPerspective, SaysWhyItCannotDraw) {
  mesh("mesh.ply");
  write(path("cut.ply"), read(path("mesh.ply")).substr(0, 5000));
  write(path("upright.obj"), "v 0 0 0\nv 1 0 0\nv 0.5 0 1\nf 1 2 3\n");
  const auto expect = [&](const Outcome& outcome, int code, const std::string& words) {
    EXPECT_EQ(outcome.code, code) << words;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(words));
    EXPECT_FALSE(std::filesystem::exists(path("none.png")));
  };
  expect(draw("cut.ply", "none.png"), 3, "cut.ply");
  expect(draw("upright.obj", "none.png"), 3, "no extent");
}

}  // namespace
}  // namespace arete
