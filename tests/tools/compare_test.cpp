#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "gis/dem_file.h"

namespace arete {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int code = 0;
  std::string out, err;
};

class CompareVerb : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("arete_compare_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string text(const std::string& name) {
    std::ifstream file(name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  Outcome compare(const std::string& arguments) const {
    const std::string command = std::string(ARETE_TOOL) + " compare " + arguments + " > " + path("out") + " 2> " + path("err");
    Outcome outcome;
    outcome.code = WEXITSTATUS(std::system(command.c_str()));
    outcome.out = text(path("out"));
    outcome.err = text(path("err"));
    return outcome;
  }
  /// 64 x 48 cells of 10 m (or of `cell`), raised by `shift`.
  std::string write(const std::string& name, float shift, double x = 600000, double cell = 10, bool hole = false) const {
    Raster<float> cells(64, 48);
    for (std::int64_t j = 0; j < 48; ++j)
      for (std::int64_t i = 0; i < 64; ++i)
        cells(i, j) = shift + static_cast<float>(100 + 20 * std::sin(static_cast<double>(i) / 5) + 15 * std::cos(static_cast<double>(j) / 3));
    if (hole) cells(20, 20) = void_value;
    GeoReference geo;
    geo.transform = {x, cell, 0, 5200000, 0, -cell};
    geo.nodata = -9999;
    DemWriteOptions options;
    options.overwrite = true;
    DemWriter writer(path(name), {64, 48}, geo, options);
    writer.write(0, {0, 0, 64, 48}, cells.view());
    writer.commit();
    return path(name);
  }
  fs::path folder_;
};

TEST_F(CompareVerb, IdenticalRastersHaveNoErrorAndAnInfinitePsnr) {
  const std::string a = write("a.tif", 0);
  const Outcome words = compare(a + " " + a);
  EXPECT_EQ(words.code, 0) << words.err;
  EXPECT_NE(words.out.find("identical"), std::string::npos) << words.out;
  const Outcome outcome = compare(a + " " + a + " --factor 4 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto data = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(data["height"]["rmse_m"], 0);
  EXPECT_TRUE(data["height"]["psnr_db"].is_null());
  EXPECT_EQ(data["height"]["identical"], true);
  EXPECT_EQ(data["consistency"]["rmse_m"], 0);
  EXPECT_EQ(data["cells"]["compared"], 64 * 48);
}

TEST_F(CompareVerb, AShiftIsABias) {
  const auto data = nlohmann::json::parse(compare(write("a.tif", 0) + " " + write("b.tif", 2) + " --json").out);
  EXPECT_NEAR(data["height"]["bias_m"], 2, 1e-5);
  EXPECT_NEAR(data["height"]["rmse_m"], 2, 1e-5);
  EXPECT_NEAR(data["slope"]["rmse_deg"], 0, 1e-4);
  EXPECT_NEAR(data["spectrum"]["bands"][0]["ratio"], 1, 1e-3);
  EXPECT_FALSE(data.contains("consistency"));
}

TEST_F(CompareVerb, RefusesAnotherGridInOneLine) {
  const std::string a = write("a.tif", 0), b = write("b.tif", 0, 600000, 5), c = write("c.tif", 0, 600003);
  for (const std::string& other : {b, c}) {
    const Outcome outcome = compare(a + " " + other + " --map " + path("map.png"));
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    for (const std::string& part : {a, other, std::string("--resample")}) EXPECT_NE(outcome.err.find(part), std::string::npos);
    EXPECT_FALSE(fs::exists(path("map.png")));
  }
}

TEST_F(CompareVerb, ResamplesWhenTold) {
  const auto data = nlohmann::json::parse(compare(write("a.tif", 0) + " " + write("c.tif", 5, 600000.001) + " --resample --json").out);
  EXPECT_NEAR(data["height"]["bias_m"], 5, 1e-3);
  EXPECT_FALSE(data["notes"].empty());
}

TEST_F(CompareVerb, ComparesTheCommonWindowAndCountsVoids) {
  const auto data = nlohmann::json::parse(compare(write("a.tif", 0, 600000, 10, true) + " " + write("b.tif", 0, 600100) + " --json").out);
  EXPECT_EQ(data["cells"]["compared"], 54 * 48 - 1);
  EXPECT_EQ(data["cells"]["only_result"], 1);
  EXPECT_EQ(data["notes"].size(), 1u);
}

TEST_F(CompareVerb, DrawsTheErrorAndKeepsWhatIsThere) {
  const std::string both = write("a.tif", 0) + " " + write("b.tif", 2, 600000, 10, true);
  EXPECT_EQ(compare(both + " --map " + path("map.png")).code, 0);
  EXPECT_GT(fs::file_size(path("map.png")), 1000u);
  const std::string before = text(path("map.png"));
  EXPECT_EQ(compare(both + " --map " + path("map.png")).code, 5);
  EXPECT_EQ(text(path("map.png")), before);
  EXPECT_EQ(compare(both + " --overwrite --map " + path("map.png")).code, 0);
}

TEST_F(CompareVerb, AMissingFileIsAnInputError) {
  const Outcome outcome = compare(path("none.tif") + " " + write("a.tif", 0));
  EXPECT_EQ(outcome.code, 3);
  EXPECT_NE(outcome.err.find("none.tif"), std::string::npos);
}

}  // namespace
}  // namespace arete
