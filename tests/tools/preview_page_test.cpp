#include <cmath>
#include <cstdio>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "gis/image.h"
#include "tests/data.h"
#include "tests/tools/verb_fixture.h"

namespace arete {
namespace {

using testing::HasSubstr;
using testing::Not;

class PreviewPage : public VerbFixture {
 protected:
  static nlohmann::json described(const std::string& html) {
    const std::string tag = "id=\"page\">";
    const std::size_t begin = html.find(tag) + tag.size();
    return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
  }
  std::string write_dem(const std::string& name, Size size, std::array<double, 6> transform, const std::string& crs) const {
    GeoReference geo;
    geo.transform = transform;
    geo.crs_wkt = crs_wkt(crs);
    DemWriter writer(path(name), size, geo);
    writer.write(0, {0, 0, size.width, size.height}, synthesize_mountains(size, {.seed = 3}).view());
    writer.commit();
    return path(name);
  }
};

TEST_F(PreviewPage, SaysWhatItHolds) {
  const std::string dem = write_mountains("a.tif", {200, 120});
  const Outcome made = run("preview " + dem + " " + path("a.html") + " --json");
  ASSERT_EQ(made.code, 0) << made.err;
  const auto data = nlohmann::json::parse(made.out);
  EXPECT_EQ(data["terrains"][0]["width"], 200);
  EXPECT_EQ(data["bytes"], std::filesystem::file_size(path("a.html")));
  const auto page = described(read(path("a.html")));
  EXPECT_EQ(page["terrains"][0]["name"], "a.tif");
  EXPECT_EQ(page["terrains"][0]["facts"][0], "200 \u00d7 120 cells of 30 m");
  EXPECT_THAT(page["terrains"][0]["facts"][2].get<std::string>(), HasSubstr("all cells shown, heights within 0."));
  EXPECT_EQ(data["terrains"][0]["max_error_m"].get<double>(), data["terrains"][0]["step_m"].get<double>() / 2);
  EXPECT_EQ(page["terrains"][0]["step"], data["terrains"][0]["step_m"]);
}

TEST_F(PreviewPage, HasTheSameBytesForAnyThreadCount) {
  const std::string dem = write_mountains("a.tif", {300, 300});
  ASSERT_EQ(run("preview " + dem + " " + path("a.html") + " --threads 1").code, 0);
  ASSERT_EQ(run("preview " + dem + " " + path("b.html") + " --threads 4").code, 0);
  EXPECT_EQ(read(path("a.html")), read(path("b.html")));
}

TEST_F(PreviewPage, WidthBoundsTheSamples) {
  const std::string dem = write_mountains("a.tif", {300, 200});
  ASSERT_EQ(run("preview " + dem + " " + path("a.html") + " --width 100").code, 0);
  const auto terrain = described(read(path("a.html")))["terrains"][0];
  EXPECT_EQ(terrain["width"], 100);
  EXPECT_EQ(terrain["picture"], (nlohmann::json{150, 100}));
  EXPECT_EQ(terrain["height"], 67);
  EXPECT_EQ(terrain["placement"][1], 3 * 30);
}

TEST_F(PreviewPage, ADemInDegreesHasItsMetresOnTheGround) {
  const std::string dem = write_dem("a.tif", {60, 60}, {9.8, 1 / 3600.0, 0, 46.8, 0, -1 / 3600.0}, "EPSG:4326");
  ASSERT_EQ(run("preview " + dem + " " + path("a.html")).code, 0);
  const auto placement = described(read(path("a.html")))["terrains"][0]["placement"];
  // A second of arc at 46.79 degrees north on WGS 84: 30.88 m along the meridian, 21.20 m along the parallel (radii of curvature
  // M = a (1 - e2) / w^3 and N = a / w with w = sqrt(1 - e2 sin^2): 6369.4 and 6389.5 km).
  EXPECT_NEAR(placement[1].get<double>(), 21.21, 0.02);
  EXPECT_NEAR(placement[5].get<double>(), 30.88, 0.02);
}

TEST_F(PreviewPage, PlacesTheOtherDemByItsGeoreference) {
  const std::string a = write_dem("a.tif", {100, 80}, {500000, 30, 0, 4600000, 0, -30}, "EPSG:32633");
  const std::string b = write_dem("b.tif", {120, 90}, {500300, 10, 0, 4599700, 0, -10}, "EPSG:32633");
  ASSERT_EQ(run("preview " + a + " " + path("a.html") + " --compare " + b).code, 0);
  const auto placement = described(read(path("a.html")))["terrains"][1]["placement"];
  const double expected[] = {300, 10, 0, 300, 0, 10};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(placement[i].get<double>(), expected[i], 1e-6) << i;
}

TEST_F(PreviewPage, ATreeIsShownAsItsDem) {
  const std::string dem = write_mountains("a.tif", {90, 70});
  ASSERT_EQ(run("compress " + dem + " " + path("a.sct") + " --lossless").code, 0);
  const Outcome made = run("preview " + dem + " " + path("a.html") + " --compare " + path("a.sct"));
  ASSERT_EQ(made.code, 0) << made.err;
  const auto terrains = described(read(path("a.html")))["terrains"];
  EXPECT_EQ(terrains[0]["facts"], terrains[1]["facts"]);
  EXPECT_EQ(terrains[0]["low"], terrains[1]["low"]);
}

TEST_F(PreviewPage, RefusesWhatItCannotShowInOneLineAndWritesNothing) {
  const std::string a = write_dem("a.tif", {100, 80}, {500000, 30, 0, 4600000, 0, -30}, "EPSG:32633");
  const std::string away = write_dem("away.tif", {100, 80}, {600000, 30, 0, 4600000, 0, -30}, "EPSG:32633");
  const std::string zone = write_dem("zone.tif", {100, 80}, {500000, 30, 0, 4600000, 0, -30}, "EPSG:32632");
  ASSERT_EQ(run("tin " + a + " " + path("a.ply") + " --max-error 20").code, 0);
  const std::size_t before = entries();
  const auto refused = [&](const std::string& arguments, int code, const std::string& reason) {
    const Outcome outcome = run("preview " + arguments);
    EXPECT_EQ(outcome.code, code) << arguments;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(reason));
    EXPECT_EQ(entries(), before);
  };
  refused(a + " " + path("x.html") + " --compare " + away, 3, "share no ground");
  refused(a + " " + path("x.html") + " --compare " + zone, 3, "different coordinate systems");
  refused(a + " " + path("x.html") + " --compare " + path("none.tif"), 3, "none.tif");
  refused(a + " " + path("x.png") + " --compare " + a, 2, "--compare is not for --view top, but for pages (.html)");
  refused(a + " " + path("x.png") + " --credit me", 2, "--credit is not for --view top, but for pages (.html)");
  refused(path("a.ply") + " " + path("x.html"), 4, "it is a mesh");
  refused(a + " " + path("none/x.html"), 5, "none");
  std::ofstream(path("mine.html")) << "mine";
  EXPECT_EQ(run("preview " + a + " " + path("mine.html")).code, 5);
  EXPECT_EQ(read(path("mine.html")), "mine");
}

/// The page in Chromium, used by browse_page.py.
class PreviewPageInABrowser : public PreviewPage {
 protected:
  void SetUp() override {
    PreviewPage::SetUp();
    for (const char* program : {"/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome", "/usr/lib/chromium/chromium-headless-shell"})
      if (std::filesystem::exists(program)) browser_ = program;
    if (browser_.empty()) GTEST_SKIP() << "no browser: install the package chromium-headless-shell, or chromium";
  }
  nlohmann::json browse(const std::string& page, const std::string& flags = "") const {
    const std::string out = path("browsed.json");
    const std::string program = ARETE_TEST_PYTHON " -B " ARETE_SOURCE_DIR "/tests/tools/browse_page.py ";
    const int status = std::system((program + browser_ + " " + page + " " + path("") + " " + flags + " > " + out).c_str());
    EXPECT_EQ(status, 0);
    return status == 0 ? nlohmann::json::parse(read(out)) : nlohmann::json();
  }
  /// Pixels that differ by more than 24 in a channel, in [0, 1], columns x0 to x1.
  static double changed(const Picture& a, const Picture& b, std::int64_t x0 = 0, std::int64_t x1 = 1000) {
    std::int64_t count = 0;
    for (std::int64_t y = 0; y < a.height(); ++y)
      for (std::int64_t x = x0; x < x1; ++x)
        for (std::size_t c = 0; c < 3; ++c)
          if (std::abs(a(x, y)[c] - b(x, y)[c]) > 24) {
            ++count;
            break;
          }
    return static_cast<double>(count) / static_cast<double>(a.height() * (x1 - x0));
  }
  /// Pixels of the middle of the window that show terrain: the background is light and almost grey.
  static double coloured(const Picture& picture) {
    std::int64_t count = 0;
    for (std::int64_t y = 160; y < 480; ++y)
      for (std::int64_t x = 250; x < 750; ++x) {
        const Colour& p = picture(x, y);
        if (std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}) > 20 || p[0] < 200) ++count;
      }
    return static_cast<double>(count) / (320 * 500);
  }
  static double number(const nlohmann::json& text) { return std::stod(text.get<std::string>()); }
  static void expect_same_view(const nlohmann::json& a, const nlohmann::json& b) {
    for (const char* part : {"azimuth", "tilt", "distance", "target"}) EXPECT_EQ(a[part], b[part]) << part;
  }
  static void expect_no_network(const nlohmann::json& result) {
    EXPECT_FALSE(result["requests"].empty());
    for (const auto& url : result["requests"]) {
      const std::string text = url.get<std::string>();
      EXPECT_TRUE(text.rfind("file:", 0) == 0 || text.rfind("data:", 0) == 0) << text;
    }
    EXPECT_TRUE(result["errors"].empty()) << result["errors"];
  }
  std::string browser_;
};

TEST_F(PreviewPageInABrowser, ShowsTerrainThatADragTurns) {
  const std::string dem = write_mountains("a <b> & \"c\".tif", {200, 200}, 1);
  ASSERT_EQ(run("preview '" + dem + "' " + path("a.html")).code, 0);
  const auto result = browse(path("a.html"));
  ASSERT_EQ(result["before"]["state"], "ready") << result;
  EXPECT_EQ(result["before"]["title"], "a <b> & \"c\".tif");
  EXPECT_THAT(result["before"]["labels"][0].get<std::string>(), HasSubstr("a <b> & \"c\".tif"));
  const Picture before = read_picture(path("before.png")), turned = read_picture(path("turned.png"));
  EXPECT_GT(coloured(before), 0.5);
  EXPECT_GT(changed(before, turned), 0.1);
  EXPECT_NE(result["before"]["azimuth"], result["turned"]["azimuth"]);
  EXPECT_LT(number(result["zoomed"]["distance"]), number(result["turned"]["distance"]));
  EXPECT_THAT(result["zoomed"]["readout"].get<std::string>(), HasSubstr(" m at the pointer"));
  EXPECT_NEAR(number(result["north_up"]["azimuth"]), 0, 1e-3);
  EXPECT_GT(changed(before, read_picture(path("contours.png"))), 0.01);

  // Keys: left, up, shift with up, plus, then 0.
  EXPECT_NEAR(number(result["keyed"]["azimuth"]), -0.08, 1e-3);
  EXPECT_NEAR(number(result["keyed"]["tilt"]), number(result["north_up"]["tilt"]) - 0.06, 1e-3);
  EXPECT_NEAR(number(result["keyed"]["distance"]), 0.85 * number(result["north_up"]["distance"]), 1);
  EXPECT_NE(result["keyed"]["target"], result["north_up"]["target"]);
  expect_same_view(result["keyed_back"], result["before"]);
  // The right button moves; a double click shows all again.
  EXPECT_EQ(result["moved"]["azimuth"], result["before"]["azimuth"]);
  EXPECT_NE(result["moved"]["target"], result["before"]["target"]);
  expect_same_view(result["double_clicked"], result["before"]);
  // One finger turns; two that part from 90 to 170 pixels zoom, two that go on move, two that turn by a quarter turn it; two taps show all again.
  EXPECT_LT(number(result["one_finger"]["azimuth"]), -0.1);
  EXPECT_EQ(result["one_finger"]["distance"], result["phone"]["distance"]);
  EXPECT_NEAR(number(result["spread"]["distance"]) / number(result["phone"]["distance"]), 90.0 / 170, 1e-3);
  EXPECT_EQ(result["two_fingers"]["distance"], result["spread"]["distance"]);
  EXPECT_NE(result["two_fingers"]["target"], result["spread"]["target"]);
  EXPECT_NEAR(number(result["twisted"]["azimuth"]) - number(result["two_fingers"]["azimuth"]), -std::acos(0), 1e-3);
  expect_same_view(result["double_tapped"], result["phone"]);
  expect_no_network(result);
}

TEST_F(PreviewPageInABrowser, TheDividerShowsTheOtherDem) {
  const std::string a = write_mountains("a.tif", {200, 200}, 1), b = write_mountains("b.tif", {200, 200}, 2);
  ASSERT_EQ(run("preview " + a + " " + path("a.html") + " --compare " + b).code, 0);
  const auto result = browse(path("a.html"), "brief");
  ASSERT_EQ(result["before"]["state"], "ready") << result;
  EXPECT_EQ(result["before"]["labels"].size(), 2u);
  EXPECT_EQ(result["before"]["divider"], "50");
  EXPECT_EQ(result["divided"]["divider"], "25");
  ASSERT_EQ(run("preview " + b + " " + path("b.html") + " --compare " + b).code, 0);
  const Picture both = read_picture(path("before.png"));
  const auto alone = browse(path("b.html"), "brief");
  ASSERT_EQ(alone["before"]["state"], "ready");
  const Picture right = read_picture(path("before.png"));
  // Left of the divider is another terrain.
  EXPECT_GT(changed(both, right, 250, 480), 0.15);
  expect_no_network(result);
}

TEST_F(PreviewPageInABrowser, AVoidIsAHoleThroughWhichTheFloorIsSeenAndHeightsAreReadAtThePointer) {
  Raster<float> cells(120, 120, 100);  // a low plateau, whose rim hides no floor, south of rough ground, from which its heights are foretold
  for (std::int64_t x = 0; x < 120; ++x) cells(x, x % 10) = 100 + static_cast<float>(x) / 120;
  for (std::int64_t y = 30; y < 90; ++y)
    for (std::int64_t x = 30; x < 90; ++x) cells(x, y) = void_value;
  GeoReference geo;
  geo.transform = {500000, 30, 0, 4600000, 0, -30};
  DemWriter writer(path("hole.tif"), {120, 120}, geo);
  writer.write(0, {0, 0, 120, 120}, cells.view());
  writer.commit();
  ASSERT_EQ(run("preview " + path("hole.tif") + " " + path("hole.html") + " --exaggeration 1 --credit \"Nobody's data, <i>2 m</i>\"").code, 0);
  const auto result = browse(path("hole.html"), "brief");
  ASSERT_EQ(result["before"]["state"], "ready");
  EXPECT_EQ(result["hovered"], "100.00 m at the pointer");
  EXPECT_EQ(result["hovered_middle"], "");  // in the hole
  EXPECT_EQ(result["before"]["credit"], "Nobody's data, <i>2 m</i>");
  // 1 / 16384 = 0.000061 m, and the next round step.
  EXPECT_EQ(result["before"]["accuracy"], "Heights of hole.tif are kept in steps of 0.0001 m: none is off by more than 0.00005 m.");
  const Picture before = read_picture(path("before.png"));
  const int floor[] = {139, 134, 128};  // 255 x (0.80, 0.775, 0.74) x 0.68, as the page draws it
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(before(500, 320)[c], floor[c], 2) << c;
}

TEST_F(PreviewPageInABrowser, WithoutWebGlOneSentenceSaysSo) {
  const std::string dem = write_mountains("a.tif", {40, 40}, 1);
  ASSERT_EQ(run("preview " + dem + " " + path("a.html")).code, 0);
  const auto result = browse(path("a.html"), "--disable-3d-apis");
  EXPECT_EQ(result["before"]["state"], "failed");
  EXPECT_EQ(result["before"]["message"], "This page needs WebGL 2, which this browser does not offer, or has switched off.");
  expect_no_network(result);
}

TEST_F(PreviewPageInABrowser, TheReportOfADemoHoldsItInAFrame) {
  const std::string dem = write_mountains("a.tif", {240, 120}, 1);
  ASSERT_EQ(run("demo " + dem + " " + path("out") + " --factor 3 --atoms 32").code, 0);
  const auto result = browse(path("out/index.html"));
  ASSERT_EQ(result["before"]["state"], "ready") << result;
  EXPECT_THAT(result["before"]["labels"][0].get<std::string>(), HasSubstr("input.tif"));
  EXPECT_THAT(result["before"]["labels"][1].get<std::string>(), HasSubstr("detail-1.tif"));
  EXPECT_LT(result["scrolled"]["by"].get<double>(), 0);
  expect_same_view(result["scrolled"], result["before"]);
  EXPECT_LT(number(result["clicked"]["distance"]), number(result["before"]["distance"]));
  expect_no_network(result);
}

TEST_F(PreviewPageInABrowser, NothingButVoidsIsSaid) {
  GeoReference geo;
  geo.transform = {500000, 30, 0, 4600000, 0, -30};
  DemWriter writer(path("void.tif"), {50, 50}, geo);
  writer.commit();
  ASSERT_EQ(run("preview " + path("void.tif") + " " + path("void.html")).code, 0);
  const auto result = browse(path("void.html"));
  EXPECT_EQ(result["before"]["state"], "failed");
  EXPECT_EQ(result["before"]["message"], "There is no valid cell to show.");
  EXPECT_TRUE(result["errors"].empty()) << result["errors"];
}

}  // namespace
}  // namespace arete
