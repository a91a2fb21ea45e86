#include <cmath>
#include <cstdlib>
#include <set>
#include <string>

#include <nlohmann/json.hpp>

#include "gis/image.h"
#include "tests/shaders/mesa.h"
#include "tests/tools/verb_fixture.h"

namespace arete {
namespace {

class PreviewPerspective : public VerbFixture {
 protected:
  void SetUp() override {
    VerbFixture::SetUp();
    hold_mesa_still();
    dem_ = write_mountains("dem.tif", {150, 120});
    const Outcome outcome = draw("probe.png", "");
    if (outcome.code == 3 && outcome.err.find("OpenGL") != std::string::npos) GTEST_SKIP() << outcome.err;
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  Outcome draw(const std::string& picture, const std::string& options) const {
    return run("preview " + dem_ + " " + path(picture) + " --view perspective --size 320x200 --overwrite " + options);
  }
  std::string dem_;
};

TEST_F(PreviewPerspective, DrawsThePictureAskedFor) {
  const Outcome outcome = draw("a.png", "--no-legend --look-from 90 --pitch 50 --fov 40 --exaggeration 2 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto data = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(data["exaggeration"], 2);
  EXPECT_GT(data["triangles"], 1000);
  EXPECT_GT(data["camera_m"][0], data["target_m"][0]);  // from the east
  const Picture picture = read_picture(path("a.png"));
  EXPECT_EQ(picture.width(), 320);
  EXPECT_EQ(picture.height(), 200);
  // Ground in the middle, haze in the corner.
  EXPECT_GT(picture(0, 0)[2], 215);
  EXPECT_LT(picture(160, 100)[2], 245);
  EXPECT_NE(picture(160, 100), picture(0, 0));
}

TEST_F(PreviewPerspective, EveryStyleIsAPictureOfItsOwn) {
  std::set<std::string> bytes;
  for (const char* style : {"lit", "wireframe", "levels"}) {
    ASSERT_EQ(draw("s.png", std::string("--style ") + style).code, 0) << style;
    bytes.insert(read(path("s.png")));
  }
  EXPECT_EQ(bytes.size(), 3u);
}

TEST_F(PreviewPerspective, ColoursAndContoursMakeAnotherPicture) {
  std::set<std::string> bytes;
  for (const char* options : {"", "--colour slope", "--colour aspect", "--contours", "--contours 500", "--colour slope --contours"}) {
    ASSERT_EQ(draw("s.png", std::string("--no-legend ") + options).code, 0) << options;
    bytes.insert(read(path("s.png")));
  }
  EXPECT_EQ(bytes.size(), 6u);
  EXPECT_EQ(nlohmann::json::parse(draw("s.png", "--contours 500 --json").out)["contour_interval_m"], 500);
}

TEST_F(PreviewPerspective, LaysARasterOverTheGround) {
  // Its own map, which has the proportions of the DEM; and the DEM itself as numbers.
  ASSERT_EQ(run("preview " + dem_ + " " + path("map.png") + " --no-legend --ramp viridis").code, 0);
  std::set<std::string> bytes;
  for (const std::string& drape : {std::string(), " --drape " + path("map.png"), " --drape " + dem_}) {
    for (const char* view : {" --view perspective --size 320x200", " --view top"}) {
      const Outcome outcome = run("preview " + dem_ + " " + path("d.png") + " --overwrite" + view + drape);
      ASSERT_EQ(outcome.code, 0) << outcome.err;
      bytes.insert(read(path("d.png")));
    }
  }
  EXPECT_EQ(bytes.size(), 6u);
  Raster<float> cells(10, 10, 5.0f);
  GeoReference geo;
  geo.transform = {900000, 30, 0, 4600000, 0, -30};
  geo.crs_wkt = crs_wkt("EPSG:32633");
  DemWriter writer(path("far.tif"), {10, 10}, geo);
  writer.write(0, {0, 0, 10, 10}, cells.view());
  writer.commit();
  const std::size_t before = entries();
  for (const char* view : {"--view perspective", "--view top"}) {
    const Outcome far = run("preview " + dem_ + " " + path("no.png") + " " + view + " --drape " + path("far.tif"));
    EXPECT_EQ(far.code, 3);
    EXPECT_EQ(far.error_lines(), 1) << far.err;
    EXPECT_NE(far.err.find("share no ground"), std::string::npos) << far.err;
  }
  EXPECT_EQ(run("preview " + dem_ + " " + path("no.png") + " --view profile --drape " + dem_).code, 2);
  EXPECT_EQ(entries(), before);
}

TEST_F(PreviewPerspective, HasTheSameBytesForAnyNumberOfThreads) {
  std::set<std::string> bytes;
  for (const char* threads : {"0", "1", "2"}) {
    setenv("LP_NUM_THREADS", threads, 1);
    for (const char* own : {"1", "3"}) {
      ASSERT_EQ(draw("t.png", std::string("--threads ") + own).code, 0);
      bytes.insert(read(path("t.png")));
    }
  }
  unsetenv("LP_NUM_THREADS");
  EXPECT_EQ(bytes.size(), 1u);
}

TEST_F(PreviewPerspective, ATreeLooksLikeItsDem) {
  ASSERT_EQ(run("compress " + dem_ + " " + path("tree.sct") + " --max-error 0.01").code, 0);
  const Outcome outcome = run("preview " + path("tree.sct") + " " + path("tree.png") + " --view perspective --size 320x200 --no-legend");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  ASSERT_EQ(draw("dem.png", "--no-legend").code, 0);
  const Picture a = read_picture(path("tree.png")), b = read_picture(path("dem.png"));
  double sum = 0;
  for (std::int64_t i = 0; i < 320 * 200; ++i) sum += std::abs(a.data()[i][1] - b.data()[i][1]);
  EXPECT_LT(sum / (320 * 200), 0.5);
}

TEST_F(PreviewPerspective, RefusesInOneLineAndWritesNothing) {
  const std::size_t before = entries();
  for (const char* options : {"--size 10x10", "--size 320", "--size 20000x100", "--pitch 0", "--fov 0", "--style blue", "--distance -1", "--style levels --contours"}) {
    const Outcome outcome = draw("no.png", options);
    EXPECT_EQ(outcome.code, 2) << options;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
  }
  EXPECT_EQ(entries(), before);
}

TEST_F(PreviewPerspective, WithoutADriverItSaysWhatToInstall) {
  setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json", 1);
  const Outcome outcome = draw("no.png", "");
  const Outcome map = run("preview " + dem_ + " " + path("map.png"));
  unsetenv("__EGL_VENDOR_LIBRARY_FILENAMES");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(outcome.error_lines(), 1);
  EXPECT_NE(outcome.err.find("libgl1-mesa-dri"), std::string::npos) << outcome.err;
  EXPECT_EQ(map.code, 0);
}

}  // namespace
}  // namespace arete
