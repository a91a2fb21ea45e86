#include <cmath>

#include <nlohmann/json.hpp>

#include "tests/tools/verb_fixture.h"

namespace arete {
namespace {

class SampleVerb : public VerbFixture {
 protected:
  // z = x/10 + y/20 in metres of a grid of 10 m cells.
  std::string write_plane() const {
    Raster<float> cells(80, 60);
    for (std::int64_t y = 0; y < 60; ++y)
      for (std::int64_t x = 0; x < 80; ++x) cells(x, y) = static_cast<float>(static_cast<double>(x) + 0.5 + 30.0 - 0.5 * (static_cast<double>(y) + 0.5));
    GeoReference geo;
    geo.transform = {500000, 10, 0, 4600000, 0, -10};
    geo.crs_wkt = crs_wkt("EPSG:32633");
    DemWriter writer(path("plane.tif"), {80, 60}, geo);
    writer.write(0, {0, 0, 80, 60}, cells.view());
    writer.commit();
    return path("plane.tif");
  }
};

TEST_F(SampleVerb, GivesElevationAndSlope) {
  const Outcome outcome = run("sample " + write_plane() + " --point 500403 4599800 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto point = nlohmann::json::parse(outcome.out).at(0);
  EXPECT_NEAR(point["elevation_m"], 40.3 + 30 - 10, 1e-4);
  EXPECT_NEAR(point["slope_x"], 0.1, 1e-4);
  EXPECT_NEAR(point["slope_y"], -0.05, 1e-4);
}

TEST_F(SampleVerb, ATreeGivesWhatItsDemGives) {
  const std::string dem = write_plane();
  ASSERT_EQ(run("compress " + dem + " " + path("plane.sct") + " --rmse 0.001").code, 0);
  const std::string where = " --profile 500100 4599900 500700 4599500 --steps 7 --json";
  const auto a = nlohmann::json::parse(run("sample " + dem + where).out), b = nlohmann::json::parse(run("sample " + path("plane.sct") + where).out);
  ASSERT_EQ(a.size(), 8U);
  ASSERT_EQ(b.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(a[i]["elevation_m"], b[i]["elevation_m"], 0.01) << i;
}

TEST_F(SampleVerb, ReadsPointsFromAFile) {
  const std::string dem = write_plane();
  write(path("points.csv"), "lon,lat\n15.0024,41.5491\n0,0\n");
  const Outcome outcome = run("sample " + dem + " --points " + path("points.csv") + " --lonlat");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 3);
  EXPECT_NE(outcome.out.find("\n0,0,,,\n"), std::string::npos) << outcome.out;  // far outside
  EXPECT_EQ(outcome.out.find("15.0024,41.5491,,"), std::string::npos) << outcome.out;
}

TEST_F(SampleVerb, RefusesInOneLine) {
  const std::string dem = write_plane();
  write(path("bad.csv"), "x,y\n1,2\n3;four\n");
  for (const auto& [arguments, code] : std::vector<std::pair<std::string, int>>{{"sample " + dem, 2},
                                                                              {"sample " + dem + " --points " + path("none.csv"), 3},
                                                                              {"sample " + dem + " --points " + path("bad.csv"), 3},
                                                                              {"sample " + path("none.sct") + " --point 1 2", 3}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
}

}  // namespace
}  // namespace arete
