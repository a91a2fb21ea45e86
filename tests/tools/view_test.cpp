// The window under a display of its own (Xvfb), with keys and a mouse that X delivers (xdotool).
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include <nlohmann/json.hpp>

#include "gis/image.h"
#include "tests/shaders/mesa.h"
#include "tests/tools/verb_fixture.h"

namespace arete {
namespace {

class View : public VerbFixture {
 protected:
  void SetUp() override {
    VerbFixture::SetUp();
    hold_mesa_still();
    dem_ = write_mountains("dem.tif", {150, 120});
  }

  /// Skips where the hands are missing, and where OpenGL is.
  bool can_show() {
    for (const char* program : {"Xvfb", "xvfb-run", "xdotool"})
      if (std::system((std::string("command -v ") + program + " > /dev/null 2>&1").c_str()) != 0) {
        missing_ = std::string("no ") + program + "; install xvfb xauth xdotool";
        return false;
      }
    const Outcome probe = run("preview " + dem_ + " " + path("probe.png") + " --view perspective --size 64x64 --overwrite");
    missing_ = probe.err;
    return !(probe.code == 3 && probe.err.find("OpenGL") != std::string::npos);
  }

  /// Shows the terrains, acts on the window $w, waits until it is closed. In the actions `shot N` takes picture N and waits for it.
  Outcome act(const std::string& arguments, const std::string& actions) const {
    write(path("act.sh"),
          "cd '" + path("") + "'\n" + ARETE_TOOL + " view " + arguments + " > act.out 2> act.err &\npid=$!\n"
          "for i in $(seq 300); do w=$(xdotool search --onlyvisible --name 'arete view' 2> /dev/null | head -1); [ -n \"$w\" ] && break; kill -0 $pid 2> /dev/null || break; sleep 0.1; done\n"
          // Until it has the keyboard.
          "for i in $(seq 100); do [ \"$(xdotool getwindowfocus 2> /dev/null)\" = \"$w\" ] && break; kill -0 $pid 2> /dev/null || break; sleep 0.1; done\nsleep 0.5\n"
          "shot() { xdotool key p; for i in $(seq 300); do [ -e dem-view-$1.png ] && break; kill -0 $pid 2> /dev/null || break; sleep 0.1; done; }\n"
          "drag() { xdotool mousemove --window $w $1 $2 mousedown 1; xdotool mousemove --window $w $(( ($1 + $3) / 2 )) $4; xdotool mousemove --window $w $3 $4 mouseup 1; }\n" +
              actions +
              "\nfor i in $(seq 300); do kill -0 $pid 2> /dev/null || break; sleep 0.1; done\nkill $pid 2> /dev/null\nwait $pid\n");
    const int status = std::system(("timeout 200 xvfb-run -a -s '-screen 0 1400x900x24' bash '" + path("act.sh") + "' > /dev/null 2>&1").c_str());
    return {WEXITSTATUS(status), read(path("act.out")), read(path("act.err"))};
  }

  Picture shot(int n) const { return read_picture(path("dem-view-" + std::to_string(n) + ".png")); }
  /// Share of pixels that differ, in the columns from..to of 0..1.
  static double difference(const Picture& a, const Picture& b, double from = 0, double to = 1) {
    if (a.width() != b.width() || a.height() != b.height()) return 1;
    const auto left = static_cast<std::int64_t>(from * static_cast<double>(a.width())), right = static_cast<std::int64_t>(to * static_cast<double>(a.width()));
    std::int64_t other = 0;
    for (std::int64_t y = 0; y < a.height(); ++y)
      for (std::int64_t x = left; x < right; ++x) other += a(x, y) != b(x, y);
    return static_cast<double>(other) / static_cast<double>(a.height() * (right - left));
  }

  std::string dem_, missing_;
};

TEST_F(View, KeysAndMouseChangeThePictureAndEscEnds) {
  if (!can_show()) GTEST_SKIP() << missing_;
  const Outcome outcome = act("dem.tif --json",
                              "shot 1\ndrag 500 400 700 430\nshot 2\nxdotool key z\nshot 3\nxdotool key z key c\nshot 4\nxdotool key c\nshot 5\n"
                              "xdotool mousemove --window $w 640 420 click 4 click 4 click 4\nshot 6\nxdotool key comma comma comma semicolon\nshot 7\n"
                              "xdotool key 2 2\nshot 8\nxdotool key f keydown w\nsleep 0.5\nxdotool keyup w\nshot 9\nxdotool key r\nshot 10\nxdotool key h\nsleep 0.3\n"
                              "xdotool key Escape");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["pictures"], 10);
  EXPECT_EQ(shot(1).width(), 1280);
  EXPECT_EQ(shot(1).height(), 800);
  const double noise = 0.001;
  EXPECT_GT(difference(shot(1), shot(2)), 0.2) << "drag";
  EXPECT_GT(difference(shot(2), shot(3)), 0.1) << "wireframe";
  EXPECT_GT(difference(shot(3), shot(4)), 0.1) << "levels";
  EXPECT_LT(difference(shot(2), shot(5)), noise) << "both off again";
  EXPECT_GT(difference(shot(5), shot(6)), 0.2) << "wheel";
  EXPECT_GT(difference(shot(6), shot(7)), 0.1) << "sun";
  EXPECT_GT(difference(shot(7), shot(8)), 0.1) << "exaggeration";
  EXPECT_GT(difference(shot(8), shot(9)), 0.1) << "flight";
  EXPECT_LT(difference(shot(1), shot(10)), noise) << "the first view";
  EXPECT_NE(outcome.err.find("exaggerate"), std::string::npos);
}

TEST_F(View, KeysChangeHowTheGroundIsColoured) {
  if (!can_show()) GTEST_SKIP() << missing_;
  ASSERT_EQ(run("preview " + dem_ + " " + path("map.png") + " --no-legend --ramp viridis").code, 0);
  const Outcome outcome = act("dem.tif --colour slope --drape map.png", "xdotool key o\nshot 1\nxdotool key g\nshot 2\nxdotool key g\nshot 3\nxdotool key k\nshot 4\nxdotool key k key g\nshot 5\nxdotool key o\nshot 6\nxdotool key h\nsleep 0.3\nxdotool key Escape");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_GT(difference(shot(1), shot(2)), 0.2) << "aspects";
  EXPECT_GT(difference(shot(2), shot(3)), 0.2) << "heights";
  EXPECT_GT(difference(shot(3), shot(4)), 0.02) << "contours";
  EXPECT_LT(difference(shot(1), shot(5)), 0.001) << "slopes again";
  EXPECT_GT(difference(shot(5), shot(6)), 0.2) << "the drape";
  EXPECT_NE(outcome.err.find("aspects; contours; "), std::string::npos);
}

TEST_F(View, TwoTerrainsShareTheWindow) {
  if (!can_show()) GTEST_SKIP() << missing_;
  write_mountains("other.tif", {150, 120}, 2);
  // Buttons pressed and moved while a picture is drawn are not lost: the pan at the end.
  const Outcome outcome = act("dem.tif other.tif --json",
                              "shot 1\ndrag 640 300 320 300\nshot 2\nxdotool key Tab\nshot 3\nxdotool key Tab\nshot 4\nxdotool key Tab\nshot 5\n"
                              "xdotool key plus mousemove --window $w 300 400 mousedown 3 mousemove --window $w 380 430 mouseup 3 key minus\nshot 6\nxdotool key Escape");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Picture first = shot(3), second = shot(4);
  EXPECT_GT(difference(first, second), 0.1);
  // The swipe shows the first to the left of the divider, the second to its right; dragging moved it from 1/2 to 1/4.
  EXPECT_EQ(difference(shot(1), first, 0, 0.49), 0);
  EXPECT_EQ(difference(shot(1), second, 0.51, 1), 0);
  EXPECT_EQ(difference(shot(2), first, 0, 0.24), 0);
  EXPECT_EQ(difference(shot(2), second, 0.26, 1), 0);
  EXPECT_GT(difference(shot(5), first), 0.1);  // side by side
  EXPECT_GT(difference(shot(6), shot(5)), 0.1);
}

TEST_F(View, AMeshLiesOnItsDem) {
  if (!can_show()) GTEST_SKIP() << missing_;
  ASSERT_EQ(run("tin " + dem_ + " " + path("mesh.ply") + " --max-error 1 --crs EPSG:4326").code, 0);
  // The mesh alone, the DEM alone, and half of each.
  const Outcome outcome = act("dem.tif mesh.ply --json", "shot 1\nxdotool key Tab\nshot 2\nxdotool key Tab\nshot 3\nxdotool key 2\nshot 4\nxdotool key Escape");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Picture both = shot(1), dem = shot(2), mesh = shot(3);
  EXPECT_EQ(difference(both, dem, 0, 0.49), 0);
  EXPECT_EQ(difference(both, mesh, 0.51, 1), 0);
  EXPECT_GT(difference(shot(4), mesh), 0.2) << "exaggeration";
  // The same place to a pixel: outlines against the sky differ nowhere by more.
  std::int64_t other = 0;
  for (std::int64_t y = 0; y < dem.height(); ++y)
    for (std::int64_t x = 0; x < dem.width(); ++x) other += std::abs(dem(x, y)[1] - mesh(x, y)[1]) > 40;
  EXPECT_LT(static_cast<double>(other), 0.002 * static_cast<double>(dem.width() * dem.height()));
}

TEST_F(View, ClosesByItselfAndNeverOverwritesAPicture) {
  if (!can_show()) GTEST_SKIP() << missing_;
  write(path("dem-view-1.png"), "mine");
  const Outcome outcome = act("dem.tif --close-after 8", "shot 2");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(read(path("dem-view-1.png")), "mine");
  EXPECT_TRUE(std::filesystem::exists(path("dem-view-2.png")));
}

TEST_F(View, WithoutADisplayItSaysWhatToDo) {
  unsetenv("DISPLAY");
  const Outcome outcome = run("view " + dem_);
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(outcome.error_lines(), 1);
  EXPECT_NE(outcome.err.find("display"), std::string::npos);
  EXPECT_NE(outcome.err.find("--view perspective"), std::string::npos);
}

TEST_F(View, RefusesTerrainsOfDifferentPlaces) {
  if (!can_show()) GTEST_SKIP() << missing_;
  Raster<float> cells = synthesize_mountains({60, 60}, {.seed = 3});
  GeoReference geo;
  geo.transform = {900000, 30, 0, 4600000, 0, -30};
  geo.crs_wkt = crs_wkt("EPSG:32633");
  DemWriter writer(path("far.tif"), {60, 60}, geo);
  writer.write(0, {0, 0, 60, 60}, cells.view());
  writer.commit();
  ASSERT_EQ(run("tin " + path("far.tif") + " " + path("far.ply") + " --max-error 5").code, 0);
  for (const char* other : {"far.tif", "far.ply"}) {
    const Outcome outcome = act(std::string("dem.tif ") + other, "");
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.error_lines(), 1);
    EXPECT_NE(outcome.err.find("share no ground"), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace arete
