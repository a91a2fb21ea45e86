#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "gis/image.h"
#include "tests/data.h"

namespace arete {
namespace {

namespace fs = std::filesystem;

class PreviewVerb : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("arete_preview_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    std::ofstream grid(path("hill.asc"));
    grid << "ncols 40\nnrows 30\nxllcorner 0\nyllcorner 0\ncellsize 25\nNODATA_value -9999\n";
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 40; ++x) grid << (x < 5 ? -9999 : 100 + (x * y) % 50) << ' ';
      grid << '\n';
    }
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string text(const std::string& name) const {
    std::ifstream file(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  int preview(const std::string& arguments) const {
    return WEXITSTATUS(std::system((std::string(ARETE_TOOL) + " preview " + arguments + " > " + path("out") + " 2> " + path("err")).c_str()));
  }
  fs::path folder_;
};

TEST_F(PreviewVerb, DrawsAPictureAndSaysWhatItShows) {
  ASSERT_EQ(preview(path("hill.asc") + " " + path("hill.png") + " --no-legend --json"), 0) << text("err");
  const auto data = nlohmann::json::parse(text("out"));
  EXPECT_EQ(data["low_m"], 100);
  EXPECT_EQ(data["high_m"], 149);
  const Picture picture = read_picture(path("hill.png"));
  EXPECT_EQ(picture.width(), 1000);  // 25 times larger
  EXPECT_EQ(picture.height(), 750);
  EXPECT_EQ(data["metres_per_pixel"], 1);
}

TEST_F(PreviewVerb, TheLegendStandsUnderTheMap) {
  if (find_font().empty()) GTEST_SKIP() << "no font; install fonts-dejavu-core";
  ASSERT_EQ(preview(path("hill.asc") + " " + path("hill.png")), 0);
  EXPECT_GT(read_picture(path("hill.png")).height(), 800);
}

TEST_F(PreviewVerb, HasTheSameBytesForAnyThreadCount) {
  ASSERT_EQ(preview(path("hill.asc") + " " + path("a.png") + " --threads 1"), 0);
  ASSERT_EQ(preview(path("hill.asc") + " " + path("b.png") + " --threads 4"), 0);
  EXPECT_EQ(text("a.png"), text("b.png"));
}

TEST_F(PreviewVerb, RefusesBadArgumentsAndWritesNothing) {
  EXPECT_EQ(preview(path("hill.asc") + " " + path("a.png") + " --ramp rainbow"), 2);
  EXPECT_EQ(preview(path("hill.asc") + " " + path("a.png") + " --azimuth north"), 2);
  EXPECT_EQ(preview(path("hill.asc") + " " + path("a.xyz")), 4);
  EXPECT_EQ(preview(path("hill.asc") + " " + path("none/a.png")), 5);
  EXPECT_EQ(preview(path("none.asc") + " " + path("a.png")), 3);
  const std::string err = text("err");
  EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1);
  EXPECT_FALSE(fs::exists(path("a.png")));
}

TEST_F(PreviewVerb, NeverReplacesAPictureUnlessTold) {
  std::ofstream(path("a.png")) << "mine";
  EXPECT_EQ(preview(path("hill.asc") + " " + path("a.png")), 5);
  EXPECT_EQ(text("a.png"), "mine");
  EXPECT_EQ(preview(path("hill.asc") + " " + path("a.png") + " --overwrite"), 0);
}

TEST_F(PreviewVerb, DrawsEveryAwkwardFile) {
  const std::string folder = test_data("edge-cases");
  if (folder.empty()) GTEST_SKIP() << "no development data: set ARETE_TEST_DATA";
  int drawn = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".tif" && extension != ".png") continue;
    const std::string rgb = extension == ".png" ? " --terrain-rgb" : "";
    EXPECT_EQ(preview(entry.path().string() + " " + path("edge.png") + " --overwrite" + rgb), 0) << entry.path() << text("err");
    ++drawn;
  }
  EXPECT_GE(drawn, 9);
}

TEST_F(PreviewVerb, RefusesOptionsOfOtherViews) {
  const auto refused = [&](const std::string& output, const std::string& options, const std::string& said) {
    EXPECT_EQ(preview(path("hill.asc") + " " + path(output) + " " + options), 2) << options;
    EXPECT_NE(text("err").find(said), std::string::npos) << text("err");
    EXPECT_FALSE(fs::exists(path(output)));
  };
  refused("a.png", "--size 100x100", "--size is not for --view top, but for --view perspective");
  refused("a.png", "--view profile --pitch 20", "--pitch is not for --view profile");
  refused("a.png", "--view perspective --width 300", "--width is not for --view perspective");
  refused("a.png", "--compare " + path("hill.asc"), "--compare is not for --view top, but for pages (.html)");
  refused("a.html", "--view perspective", "--view is not for pages (.html)");
  refused("a.html", "--no-wireframe", "--no-wireframe is not for pages (.html), but for --view top");
}

TEST_F(PreviewVerb, ColoursAndContoursMakeAnotherMap) {
  const auto map = [&](const std::string& name, const std::string& options) {
    EXPECT_EQ(preview(path("hill.asc") + " " + path(name) + " --no-legend --json " + options), 0) << text("err");
    return text(name);
  };
  const std::string plain = map("a.png", ""), contours = map("b.png", "--contours"), every = map("c.png", "--contours 20");
  const auto data = nlohmann::json::parse(text("out"));
  EXPECT_EQ(data["contour_interval_m"], 20);
  EXPECT_EQ(map("h.png", "--colour height"), plain);
  EXPECT_EQ(map("auto.png", "--contours auto"), contours);
  EXPECT_EQ(nlohmann::json::parse(text("out"))["contour_interval_m"], 2);
  EXPECT_NE(contours, plain);
  EXPECT_NE(every, contours);
  EXPECT_NE(map("s.png", "--colour slope"), map("d.png", "--colour aspect"));
  for (const char* options : {"--colour red", "--contours -5", "--contours 0", "--contours 10m", "--contours nan", "--view profile --contours", "--view profile --colour slope"}) {
    EXPECT_EQ(preview(path("hill.asc") + " " + path("no.png") + " " + options), 2) << options;
    const std::string err = text("err");
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
  }
  EXPECT_EQ(preview(path("hill.asc") + " " + path("no.html") + " --contours"), 2);
  EXPECT_FALSE(fs::exists(path("no.png")));
}

TEST_F(PreviewVerb, DrawsATree) {
  ASSERT_EQ(WEXITSTATUS(std::system((std::string(ARETE_TOOL) + " compress " + path("hill.asc") + " " + path("hill.sct") + " --lossless --quiet > " + path("out")).c_str())), 0);
  EXPECT_EQ(preview(path("hill.sct") + " " + path("tree.png")), 0) << text("err");
  EXPECT_EQ(preview(path("hill.asc") + " " + path("dem.png")), 0) << text("err");
  EXPECT_EQ(text("tree.png"), text("dem.png"));
}

TEST_F(PreviewVerb, DrawsAProfile) {
  EXPECT_EQ(preview(path("hill.asc") + " " + path("a.png") + " --view profile --width 800 --json"), 0) << text("err");
  const auto data = nlohmann::json::parse(text("out"));
  EXPECT_EQ(data["length_m"], 1000);
  EXPECT_EQ(data["width"], 800);
  EXPECT_EQ(read_picture(path("a.png")).height(), 320);
  EXPECT_EQ(preview(path("hill.asc") + " " + path("b.png") + " --view profile --width 800 --line 0,375,1000,375"), 0) << text("err");
  EXPECT_EQ(text("a.png"), text("b.png"));
  EXPECT_EQ(preview(path("hill.asc") + " " + path("c.png") + " --view profile --line -50,-50,-10,-10"), 3) << text("err");
  EXPECT_EQ(preview(path("hill.asc") + " " + path("c.png") + " --line 0,0,10,10"), 2);
  EXPECT_EQ(preview(path("hill.asc") + " " + path("c.png") + " --view profile --line 0,0,10"), 2);
  EXPECT_FALSE(fs::exists(path("c.png")));
}

}  // namespace
}  // namespace arete
