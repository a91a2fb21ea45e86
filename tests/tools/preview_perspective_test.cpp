#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <string>

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
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

TEST_F(PreviewPerspective, StandsAndLooksWhereItIsTold) {
  // A peak of its own in the west, seen from above: it is in the middle of the picture.
  Raster<float> cells(150, 120, 400.0f);
  for (std::int64_t y = 0; y < 120; ++y)
    for (std::int64_t x = 0; x < 150; ++x)
      cells(x, y) += 1000 * std::exp(-static_cast<float>((x - 40) * (x - 40) + (y - 60) * (y - 60)) / 200);
  GeoReference geo;
  geo.transform = {500000, 30, 0, 4600000, 0, -30};
  geo.crs_wkt = crs_wkt("EPSG:32633");
  DemWriter writer(path("peak.tif"), {150, 120}, geo);
  writer.write(0, {0, 0, 150, 120}, cells.view());
  writer.commit();
  const std::string preview = "preview " + path("peak.tif") + " " + path("p.png") + " --view perspective --size 320x200 --overwrite --json --no-legend --exaggeration 1 --ramp viridis ";
  Outcome outcome = run(preview + "--look-at 501215,4598185 --pitch 60 --look-from 180 --distance 4000");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto data = nlohmann::json::parse(outcome.out);
  EXPECT_NEAR(data["look_at"][2], 1400, 0.01);
  EXPECT_NEAR(data["eye"][0], 501215, 1e-6);
  EXPECT_NEAR(data["eye"][1], 4598185 - 2000, 1e-6);
  EXPECT_NEAR(data["eye"][2], 1400 + 2000 * std::sqrt(3), 0.01);
  // At the top the ramp is yellow, in the light and in the shade.
  const Picture picture = read_picture(path("p.png"));
  double sum = 0, sum_x = 0, sum_y = 0;
  for (std::int64_t y = 20; y < 180; ++y)
    for (std::int64_t x = 80; x < 240; ++x) {
      const double bright = std::max(0, picture(x, y)[0] - picture(x, y)[2] - 40);
      sum += bright, sum_x += bright * (static_cast<double>(x) + 0.5), sum_y += bright * (static_cast<double>(y) + 0.5);
    }
  EXPECT_NEAR(sum_x / sum, 160, 12);
  EXPECT_NEAR(sum_y / sum, 100, 12);
  // What it says of its camera gives the same picture again.
  const auto text = [&](const char* name) { return fmt::format("{:.9f},{:.9f},{:.9f}", data[name][0].get<double>(), data[name][1].get<double>(), data[name][2].get<double>()); };
  outcome = run(preview + "--eye " + text("eye") + " --look-at " + text("look_at"));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Picture again = read_picture(path("p.png"));
  double difference = 0;
  for (std::int64_t i = 0; i < 320 * 200; ++i) difference += std::abs(picture.data()[i][1] - again.data()[i][1]);
  EXPECT_LT(difference / (320 * 200), 0.1);
  outcome = run(preview + "--eye 501215,4598185,+100");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NEAR(nlohmann::json::parse(outcome.out)["eye"][2], 1500, 0.01);
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

TEST_F(PreviewPerspective, ATurntableIsTheSamePicturesTogether) {
  // The default orbit is further away than that of one picture, so the distance is given.
  const std::string camera = " --look-at 501500,4598500 --distance 9000 --pitch 40 ";
  const Outcome outcome = draw("turn.table.png", "--turntable 3 --look-from 250 --json" + camera);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto data = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(data["pictures"], (std::vector<std::string>{path("turn.table-000.png"), path("turn.table-001.png"), path("turn.table-002.png")}));
  EXPECT_EQ(entries(), 5u);  // and the DEM, and the first picture of this test
  int i = 0;
  for (const char* look_from : {"250", "10", "130"}) {
    ASSERT_EQ(draw("one.png", "--look-from " + std::string(look_from) + camera).code, 0);
    EXPECT_EQ(read(path("one.png")), read(data["pictures"][static_cast<std::size_t>(i++)])) << look_from;
  }
}

TEST_F(PreviewPerspective, ATurntableReplacesNothingUnlessTold) {
  write(path("t-001.png"), "mine");
  const std::size_t before = entries();
  Outcome outcome = run("preview " + dem_ + " " + path("t.png") + " --view perspective --size 64x64 --turntable 2");
  EXPECT_EQ(outcome.code, 5);
  EXPECT_EQ(outcome.error_lines(), 1);
  EXPECT_NE(outcome.err.find("t-001.png"), std::string::npos);
  EXPECT_EQ(entries(), before);
  EXPECT_EQ(read(path("t-001.png")), "mine");
  EXPECT_EQ(draw("t.png", "--turntable 2").code, 0);
  EXPECT_EQ(entries(), before + 1);
}

TEST_F(PreviewPerspective, TiffHasTheSamePictureInSixteenBits) {
  ASSERT_EQ(draw("a.png", "").code, 0);
  const Outcome outcome = draw("a.tif", "");
  ASSERT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "");
  const Picture coarse = read_picture(path("a.png")), fine = read_picture(path("a.tif"));
  ASSERT_EQ(fine.height(), coarse.height());
  for (std::int64_t i = 0; i < coarse.width() * coarse.height(); ++i)
    for (std::size_t c = 0; c < 3; ++c) ASSERT_LE(std::abs(fine.data()[i][c] - coarse.data()[i][c]), 1) << i;
  EXPECT_EQ(fine(5, coarse.height() - 2), coarse(5, coarse.height() - 2));  // the legend
  const auto file = OIIO::ImageInput::open(path("a.tif"));
  ASSERT_TRUE(file);
  EXPECT_EQ(file->spec().format, OIIO::TypeDesc::UINT16);
  std::vector<std::uint16_t> samples(static_cast<std::size_t>(3 * coarse.width() * coarse.height()));
  ASSERT_TRUE(file->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT16, samples.data()));
  EXPECT_GT(std::set<std::uint16_t>(samples.begin(), samples.end()).size(), 2000u);
}

TEST_F(PreviewPerspective, ExrHasTheLightOfTheSceneAlone) {
  ASSERT_EQ(draw("a.tif", "--no-legend").code, 0);
  ASSERT_EQ(draw("a.exr", "").code, 0);
  const auto a = OIIO::ImageInput::open(path("a.tif")), b = OIIO::ImageInput::open(path("a.exr"));
  ASSERT_TRUE(a && b);
  EXPECT_EQ(b->spec().format, OIIO::TypeDesc::HALF);
  EXPECT_EQ(b->spec().width, 320);
  EXPECT_EQ(b->spec().height, 200);  // no legend
  std::vector<float> shown(3 * 320 * 200), light(3 * 320 * 200);
  ASSERT_TRUE(a->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, shown.data()) && b->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, light.data()));
  int dark = 0, differ = 0, bright = 0;
  for (std::size_t i = 0; i < light.size(); ++i) {
    const double linear = shown[i] <= 0.04045 ? shown[i] / 12.92 : std::pow((shown[i] + 0.055) / 1.055, 2.4);
    ASSERT_GT(light[i], linear - 0.001) << i;  // rolling off only darkens; half floats have steps of 1/2048 below 1
    dark += light[i] < 0.4f, differ += light[i] < 0.4f && light[i] > linear + 0.001, bright += light[i] > linear + 0.02;
  }
  // But where there are highlights in a pixel that is dark as a whole.
  EXPECT_GT(dark, 20000);
  EXPECT_LT(differ, dark / 20);
  EXPECT_GT(bright, 200);
  // Highlights are kept: the picture for the eye never has this much light.
  EXPECT_GT(*std::max_element(light.begin(), light.end()), 1);
  EXPECT_LT(*std::max_element(shown.begin(), shown.end()), 1);
}

TEST_F(PreviewPerspective, OtherFormatsAreRefusedByName) {
  const std::size_t before = entries();
  for (const char* name : {"a.jpg", "a.bmp", "a"}) {
    const Outcome outcome = draw(name, "");
    EXPECT_EQ(outcome.code, 4);
    EXPECT_EQ(outcome.error_lines(), 1);
    for (const char* format : {".png", ".tif", ".exr"}) EXPECT_NE(outcome.err.find(format), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(entries(), before);
}

TEST_F(PreviewPerspective, TheScaleBarIsTrueAtTheTarget) {
  if (find_font().empty()) GTEST_SKIP() << "no font; install fonts-dejavu-core";
  // Flat ground from above: it is as wide in the picture as the scale says.
  const Raster<float> cells(101, 81, 50.0f);
  GeoReference geo;
  geo.transform = {500000, 30, 0, 4600000, 0, -30};
  geo.crs_wkt = crs_wkt("EPSG:32633");
  DemWriter writer(path("flat.tif"), {101, 81}, geo);
  writer.write(0, {0, 0, 101, 81}, cells.view());
  writer.commit();
  const Outcome outcome = run("preview " + path("flat.tif") + " " + path("f.png") +
                              " --view perspective --size 400x300 --pitch 90 --look-at 501515,4598785 --distance 5000 --fov 50 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto data = nlohmann::json::parse(outcome.out);
  const double metres = data["metres_per_pixel"];
  EXPECT_NEAR(metres, 2 * 5000 * std::tan(25 * M_PI / 180) / 300, 1e-9);
  const Picture picture = read_picture(path("f.png"));
  int wide = 0, bar = 0, longest = 0;
  for (std::int64_t x = 0; x < 400; ++x) wide += picture(x, 150)[0] < 190;  // the rest is nearly white
  EXPECT_NEAR(wide * metres, 100 * 30, 2 * metres);
  for (std::int64_t y = 300; y < picture.height(); ++y)
    for (std::int64_t x = 250; x < 400; ++x) {
      bar = picture(x, y) == Colour{45, 45, 48, 255} ? bar + 1 : 0;
      longest = std::max(longest, bar);
    }
  EXPECT_NEAR(longest * metres, 1000, metres);  // the longest round length in a quarter of the width, 1.55 km
}

TEST_F(PreviewPerspective, RefusesInOneLineAndWritesNothing) {
  const std::size_t before = entries();
  for (const char* options : {"--size 10x10", "--size 320", "--size 20000x100", "--pitch 0", "--fov 0", "--style blue", "--style levels --contours", "--distance -1",
                              "--look-at 500000", "--look-at 499000,4599000", "--eye 501000,4599000,+50 --pitch 20", "--eye 501000,4599000,-4000",
                              "--look-at 501000,4599000,-900 --distance 100", "--turntable 1",
                              "--turntable 4 --eye 501000,4599000,+50", "--turntable 4 --pitch 90"}) {
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
