#include "tests/tools/verb_fixture.h"

#include <cmath>

#include <nlohmann/json.hpp>

namespace arete {
namespace {

class BenchVerb : public VerbFixture {};

TEST_F(BenchVerb, MeasuresEveryCodecOnADem) {
  const std::string dem = write_mountains("dem.tif", {96, 72});
  const Outcome outcome = run("bench compression " + dem + " " + path("out") + " --repeats 1 --threads 2 --paper --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto data = nlohmann::json::parse(outcome.out);
  auto written = nlohmann::json::parse(read(path("out/results.json")));
  written["report"] = path("out/report.html");
  EXPECT_EQ(data, written);
  const auto& result = data.at("dems").at(0);
  EXPECT_EQ(result.at("width"), 96);
  EXPECT_EQ(result.at("valid_cells"), 96 * 72 - 1);
  EXPECT_EQ(result.at("anchor"), "openjpeg");
  EXPECT_EQ(result.at("rates_bits_per_sample").size(), 7u);
  ASSERT_EQ(result.at("codecs").size(), 7u);
  for (const auto& codec : result.at("codecs")) {
    EXPECT_FALSE(codec.at("curve").empty()) << codec.at("codec");
    for (const auto& bound : codec.at("bounds")) EXPECT_TRUE(bound.is_null() || bound.at("kept") == true) << codec.at("codec") << bound;
    EXPECT_TRUE(codec.at("lossless").is_null() || codec.at("lossless").at("exact") == true);
  }
  EXPECT_FALSE(result.at("codecs").at(0).at("lossless").is_null()) << "ours promises everything";
  // The bytes of a curve's point are those of its bits per sample.
  const auto& point = result.at("codecs").at(0).at("curve").at(0);
  EXPECT_DOUBLE_EQ(point.at("bits_per_sample").get<double>(), 8 * point.at("bytes").get<double>() / (96 * 72));
  const std::string csv = read(path("out/results.csv"));
  EXPECT_EQ(csv.rfind("dem,codec,result,", 0), 0u);
  EXPECT_NE(csv.find("dem,jpegxl,point,setting,"), std::string::npos);
  EXPECT_NE(csv.find("dem,zstd,lossless,lossless,"), std::string::npos);
  const std::string page = read(path("out/report.html"));
  for (const std::string& part : {std::string("JPEG XL"), std::string("BD-PSNR"), std::string("<svg "), std::string("filled by interpolation")})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  ASSERT_EQ(result.at("paper").size(), 3u);
  EXPECT_LT(result.at("paper").at(0).at("tree").at("psnr_db"), result.at("paper").at(2).at("tree").at("psnr_db"));
  EXPECT_NE(read(path("out/paper.csv")).find("\ndem,128,8,"), std::string::npos);
  for (const char* plot : {"dem-psnr", "dem-max-error", "dem-bounds"})
    for (const char* extension : {".svg", ".png"}) EXPECT_GT(std::filesystem::file_size(path(std::string("out/") + plot + extension)), 5000u);
}

TEST_F(BenchVerb, RunsOnlyThePartsAsked) {
  const std::string dem = write_mountains("dem.tif", {40, 40}), other = path("./dem.tif");
  const Outcome outcome = run("bench compression " + dem + " " + other + " " + path("out") + " --peers zstd,openjpeg --bounds 1,10 --repeats 1 --fill --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto data = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(data.at("dems").size(), 2u);
  for (const auto& result : data.at("dems")) {
    EXPECT_EQ(result.at("valid_cells"), 40 * 40) << "filled";
    ASSERT_EQ(result.at("codecs").size(), 2u);
    for (const auto& codec : result.at("codecs")) {
      EXPECT_TRUE(codec.at("curve").empty());
      EXPECT_TRUE(codec.at("lossless").is_null());
      ASSERT_EQ(codec.at("bounds").size(), 2u);
      EXPECT_LT(codec.at("bounds").at(1).at("bytes"), codec.at("bounds").at(0).at("bytes"));
    }
  }
}

TEST_F(BenchVerb, FilledVoidsOfWholeMetresAreWholeMetres) {
  Raster<double> cells(40, 30);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = static_cast<double>(i * i % 97);
  for (std::int64_t y = 10; y < 20; ++y)
    for (std::int64_t x = 10; x < 20; ++x) cells(x, y) = std::nan("");
  GeoReference geo;
  geo.nodata = -9999;
  DemWriter writer(path("dem.tif"), cells.size(), geo, {.type = ValueType::int16});
  writer.write_stored({0, 0, 40, 30}, cells.view());
  writer.commit();
  const Outcome outcome = run("bench compression " + path("dem.tif") + " " + path("out") + " --peers sct --lossless --repeats 1 --fill --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto result = nlohmann::json::parse(outcome.out).at("dems").at(0);
  EXPECT_EQ(result.at("valid_cells"), 40 * 30);
  EXPECT_EQ(result.at("quantum_m"), 1);
}

TEST_F(BenchVerb, LeavesNothingWhereAnInputIsRefused) {
  const std::string dem = write_mountains("dem.tif", {40, 40});
  write(path("broken.tif"), "II*");
  Raster<float> flat(8, 8, 5.0f);
  DemWriter writer(path("flat.tif"), {8, 8}, {});
  writer.write(0, {0, 0, 8, 8}, flat.view());
  writer.commit();
  const std::size_t before = entries();
  for (const std::string& bad : {path("none.tif"), path("broken.tif"), path("flat.tif")}) {
    const Outcome outcome = run("bench compression " + dem + " " + bad + " " + path("out") + " --peers openjpeg --lossless");
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(bad), std::string::npos) << outcome.err;
    EXPECT_EQ(entries(), before);
  }
}

TEST_F(BenchVerb, RefusesBadOptionsAndFullFolders) {
  const std::string dem = write_mountains("dem.tif", {40, 40});
  for (const std::string& bad : {std::string("--peers nonsense"), std::string("--rates 0.1,0")}) {
    const Outcome outcome = run("bench compression " + dem + " " + path("out") + " " + bad);
    EXPECT_EQ(outcome.code, 2) << bad;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
  }
  EXPECT_EQ(run("bench nonsense " + dem + " " + path("out")).code, 2);
  std::filesystem::create_directory(path("out"));
  write(path("out/mine.txt"), "mine");
  EXPECT_EQ(run("bench compression " + dem + " " + path("out") + " --lossless").code, 5);
  EXPECT_EQ(read(path("out/mine.txt")), "mine");
  Raster<float> big(1500, 1000, 5.0f);
  DemWriter writer(path("big.tif"), big.size(), {});
  writer.write(0, {0, 0, 1500, 1000}, big.view());
  writer.commit();
  const Outcome small = run("bench compression " + path("big.tif") + " " + path("new") + " --memory 64M --lossless");
  EXPECT_EQ(small.code, 6) << small.err;
  EXPECT_NE(small.err.find("-srcwin"), std::string::npos) << small.err;
}

}  // namespace
}  // namespace arete
