#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gis/dem_file.h"
#include "tests/data.h"
#include "tests/gis/dem_files.h"

namespace arete {
namespace {

using testing::HasSubstr;

struct Outcome {
  int code = -1;
  std::string out, err;
};

std::string slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Outcome run_info(const std::string& arguments) {
  TestFolder folder;
  const std::string command = std::string(ARETE_TOOL) + " info " + arguments + " > " + (folder / "out") + " 2> " + (folder / "err");
  const int status = std::system(command.c_str());
  return {WEXITSTATUS(status), slurp(folder / "out"), slurp(folder / "err")};
}

nlohmann::json info_json(const std::string& arguments) {
  const Outcome outcome = run_info("--json " + arguments);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  return nlohmann::json::parse(outcome.out);
}

// The figures: the table of the data's README, and gdalinfo -stats of GDAL 3.6.
TEST(Info, DescribesARealDem) {
  const std::string path = test_data("alr_tyrol_dtm_5m.tif");
  if (path.empty()) GTEST_SKIP() << "no development data: set ARETE_TEST_DATA";
  const nlohmann::json data = info_json(path);
  EXPECT_EQ(data["kind"], "dem");
  EXPECT_EQ(data["driver"], "GTiff");
  EXPECT_EQ(data["data_type"], "Float64");
  EXPECT_EQ(data["width"], 417);
  EXPECT_EQ(data["height"], 915);
  EXPECT_EQ(data["crs"]["authority"], "EPSG:31287");
  EXPECT_EQ(data["registration"], "area");
  EXPECT_EQ(data["nodata"], -9999);
  EXPECT_NEAR(data["void_share"].get<double>(), 0.306, 0.0005);
  EXPECT_NEAR(data["elevation_m"]["min"].get<double>(), 566.13, 0.005);
  EXPECT_NEAR(data["elevation_m"]["max"].get<double>(), 2452.32, 0.005);
  EXPECT_NEAR(data["cell_size_m"]["x"].get<double>(), 5, 1e-9);
  // The README places it at 47.30 N 11.43 E.
  EXPECT_LT(data["extent_wgs84"]["west"].get<double>(), 11.43);
  EXPECT_GT(data["extent_wgs84"]["east"].get<double>(), 11.40);
  EXPECT_NEAR(data["extent_wgs84"]["north"].get<double>(), 47.30, 0.05);

  const Outcome outcome = run_info(path);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("EPSG:31287"));
  EXPECT_THAT(outcome.out, HasSubstr("417 x 915 cells"));
  EXPECT_THAT(outcome.out, HasSubstr("566.127 .. 2452.318 m"));
}

TEST(Info, DescribesEveryEdgeCase) {
  for (const char* name : {"all_nodata_74x92.tif", "geographic_anisotropic_74x92.tif", "no_crs_6x4.tif", "skinny_8x160.tif",
                           "some_nodata_74x92.tif", "south_up_250x250.tif", "tiny_6x4.tif", "n31e035_srtm3_below_sea_level.tif",
                           "fuji_terrain_rgb_512.png"}) {
    const std::string path = test_data(std::string("edge-cases/") + name);
    if (path.empty()) GTEST_SKIP() << "no development data: set ARETE_TEST_DATA";
    const std::string options = path.find("terrain_rgb") == std::string::npos ? "" : "--terrain-rgb ";
    const nlohmann::json data = info_json(options + path);
    EXPECT_EQ(data["elevation_m"].is_null(), path.find("all_nodata") != std::string::npos) << name;
    EXPECT_EQ(data["crs"]["name"].get<std::string>().empty(),
              path.find("no_crs") != std::string::npos || path.find(".png") != std::string::npos)
        << name;
    EXPECT_EQ(run_info(options + path).code, 0) << name;
  }
}

TEST(Info, ShowsTheUnitTheVoidsAndHowItWasMade) {
  TestFolder folder;
  GeoReference geo;
  geo.vertical_unit = "ft";
  geo.metres_per_unit = 0.3048;
  {
    DemWriter writer(folder / "a b.tif", {2, 2}, geo, {.metadata = {{"ARETE_COMMAND", "arete amplify x y"}, {"OTHER", "1"}}});
    writer.write(0, {0, 0, 2, 1}, Raster<float>(2, 1, 304.8f).view());
    writer.commit();
  }
  const nlohmann::json data = info_json("'" + (folder / "a b.tif") + "'");
  EXPECT_EQ(data["nodata"], "nan");
  EXPECT_EQ(data["void_share"], 0.5);
  EXPECT_EQ(data["vertical_unit"]["metres"], 0.3048);
  EXPECT_NEAR(data["elevation_m"]["mean"].get<double>(), 304.8, 1e-4);
  EXPECT_EQ(data["made_by"]["ARETE_COMMAND"], "arete amplify x y");
  EXPECT_FALSE(data["made_by"].contains("OTHER"));
  EXPECT_TRUE(data["transform"].is_null());
  const std::string text = run_info("'" + (folder / "a b.tif") + "'").out;
  EXPECT_THAT(text, HasSubstr("ft (0.3048 m)"));
  EXPECT_THAT(text, HasSubstr("50 % of the cells void"));
}

TEST(Info, WhatCannotBeReadIsOneLineAndCodeThree) {
  TestFolder folder;
  std::ofstream(folder / "text.tif") << "no raster";
  for (const std::string& file : {folder / "none.tif", folder / "text.tif", "--band 7 " + test_data("edge-cases/tiny_6x4.tif")}) {
    if (file == "--band 7 ") continue;
    const Outcome outcome = run_info(file);
    EXPECT_EQ(outcome.code, 3) << file;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

}  // namespace
}  // namespace arete
