#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/synthesis/mountains.h"
#include "core/terrain/resample.h"
#include "gis/crs.h"
#include "gis/dem_file.h"

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class DemoVerb : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("arete-demo-" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  struct Outcome {
    int code = -1;
    std::string out, err;
  };
  Outcome demo(const std::string& arguments) {
    const std::string out = path("stdout"), err = path("stderr");
    const int status = std::system((std::string(ARETE_TOOL) + " demo " + arguments + " > " + out + " 2> " + err).c_str());
    return {WEXITSTATUS(status), read(out), read(err)};
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string read(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  /// Mountains with a hole, 30 m cells.
  std::string write_dem(const std::string& name, arete::Size size) {
    arete::Raster<float> cells = arete::synthesize_mountains(size, {.relief_m = 900});
    cells(size.width / 2 + 7, size.height / 2) = arete::void_value;
    arete::GeoReference geo;
    geo.transform = {500000, 30, 0, 4600000, 0, -30};
    geo.crs_wkt = arete::crs_wkt("EPSG:32633");
    arete::DemWriter writer(path(name), size, geo);
    writer.write(0, {0, 0, size.width, size.height}, cells.view());
    writer.commit();
    return path(name);
  }
  std::size_t entries() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator())); }
  fs::path folder_;
};

TEST_F(DemoVerb, ShowsAUsersDem) {
  const std::string dem = write_dem("dem.tif", {300, 210});
  const Outcome outcome = demo(dem + " " + path("out") + " --factor 3 --atoms 32 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto data = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(data.at("report"), path("out/index.html"));
  EXPECT_EQ(data.at("methods").size(), 4u);
  EXPECT_NE(read(path("out/index.html")).find("300 x 210 cells of 30.0 m"), std::string::npos);
  EXPECT_NE(read(path("out/index.html")).find("srcdoc=\"&lt;!doctype html&gt;"), std::string::npos);
  EXPECT_NE(read(path("out/terrain.html")).find("<title>input.tif | detail-1.tif</title>"), std::string::npos);

  // The input is the average of the truth, where the truth lies, and the results have the truth's grid.
  const arete::DemReader truth(path("out/truth.tif")), input(path("out/input.tif")), result(path("out/detail-1.tif"));
  EXPECT_EQ(truth.size(), (arete::Size{150, 210}));
  EXPECT_EQ(input.size(), (arete::Size{50, 70}));
  EXPECT_EQ(result.size(), truth.size());
  EXPECT_EQ(result.georeference().transform, truth.georeference().transform);
  EXPECT_EQ(truth.georeference().transform->at(0), 500000 + 150 * 30);
  const auto fine = arete::read_all(result), coarse = arete::read_all(input);
  const auto averaged = arete::area_average(fine.view(), 3);
  for (std::int64_t i = 0; i < coarse.size().cells(); ++i) {
    if (arete::is_void(coarse.data()[i])) continue;
    // Elevations up to 1300 m are floats to 6e-5 m.
    EXPECT_NEAR(averaged.data()[i], coarse.data()[i], 2e-4);
  }
}

TEST_F(DemoVerb, ADemWithoutGeoreferenceIsComparedWithItsBicubic) {
  arete::DemWriter writer(path("plain.tif"), {192, 100}, {});
  writer.write(0, {0, 0, 192, 100}, arete::synthesize_mountains({192, 100}, {.seed = 3}).view());
  writer.commit();
  const Outcome outcome = demo(path("plain.tif") + " " + path("out") + " --factor 2 --atoms 16");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(read(path("out/terrain.html")).find("<title>bicubic.tif | detail-1.tif</title>"), std::string::npos);
}

TEST_F(DemoVerb, RefusesAFolderWithSomethingInIt) {
  fs::create_directory(folder_ / "out");
  std::ofstream(folder_ / "out" / "mine.txt") << "mine";
  const Outcome outcome = demo(path("out"));
  EXPECT_EQ(outcome.code, 5);
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("--overwrite"));
  EXPECT_EQ(read(folder_ / "out" / "mine.txt"), "mine");
}

TEST_F(DemoVerb, RefusesWhatIsTooSmallInOneLineAndWritesNothing) {
  const std::string dem = write_dem("dem.tif", {20, 5});
  const Outcome outcome = demo(dem + " " + path("out") + " --factor 4");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("20 x 5"));
  EXPECT_EQ(entries(), 3u) << "the DEM, stdout and stderr";
}

}  // namespace
