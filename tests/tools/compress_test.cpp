#include <algorithm>
#include <cmath>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "core/terrain/value_type.h"
#include "core/tree/elevation_tree.h"

#include "tests/tools/verb_fixture.h"

namespace arete {
namespace {

class CompressVerb : public VerbFixture {};

TEST_F(CompressVerb, ReachesItsTargetAndVerifies) {
  const std::string dem = write_mountains("dem.tif", {200, 150});
  for (const std::string target : {"--psnr 50", "--rmse 2", "--bpp 1.5"}) {
    const Outcome made = run("compress " + dem + " " + path("dem.sct") + " --overwrite --json " + target);
    ASSERT_EQ(made.code, 0) << made.err;
    const auto said = nlohmann::json::parse(made.out);
    EXPECT_EQ(said["bytes"], std::filesystem::file_size(path("dem.sct")));
    EXPECT_EQ(said["valid_cells"], 200 * 150 - 1);
    const Outcome checked = run("verify " + path("dem.sct") + " --dem " + dem + " --json");
    ASSERT_EQ(checked.code, 0) << checked.err;
    const auto found = nlohmann::json::parse(checked.out);
    EXPECT_EQ(found["claim_kept"], true);
    EXPECT_EQ(found["rmse_m"], said["rmse_m"]) << target;
  }
}

TEST_F(CompressVerb, ComesBackAsTheSameDem) {
  const std::string dem = write_mountains("dem.tif", {120, 90});
  ASSERT_EQ(run("compress " + dem + " " + path("dem.sct") + " --rmse 0.5").code, 0);
  const Outcome back = run("decompress " + path("dem.sct") + " " + path("back.tif"));
  ASSERT_EQ(back.code, 0) << back.err;
  const DemReader original(dem), decoded(path("back.tif"));
  EXPECT_EQ(decoded.size(), original.size());
  EXPECT_EQ(decoded.georeference().transform, original.georeference().transform);
  EXPECT_EQ(decoded.georeference().crs_wkt, original.georeference().crs_wkt);
  EXPECT_EQ(decoded.data_type(), original.data_type());
  const Raster<float> a = read_all(original), b = read_all(decoded);
  double squares = 0;
  for (std::int64_t i = 0; i < a.size().cells(); ++i) {
    ASSERT_EQ(is_void(a.data()[i]), is_void(b.data()[i])) << i;
    if (!is_void(a.data()[i])) squares += std::pow(a.data()[i] - b.data()[i], 2);
  }
  EXPECT_LE(std::sqrt(squares / (120 * 90 - 1)), 0.5);
}

TEST_F(CompressVerb, RefusesTargetsThatAreNoneInOneLine) {
  const std::string dem = write_mountains("dem.tif", {40, 30});
  for (const std::string target : {"--max-error -1", "--max-error 0", "--rmse nan", "--bpp inf", "--bytes x"}) {
    const Outcome refused = run("compress " + dem + " " + path("dem.sct") + " " + target);
    EXPECT_EQ(refused.code, 2) << target;
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
    EXPECT_LT(refused.err.size(), 150U) << refused.err;
    EXPECT_FALSE(std::filesystem::exists(path("dem.sct")));
  }
}

TEST_F(CompressVerb, SaysWhereFlatWaterIsExact) {
  const std::string dem = write_mountains("dem.tif", {120, 90});
  Raster<float> cells = read_all(DemReader(dem));
  for (std::int64_t y = 50; y < 90; ++y)
    for (std::int64_t x = 0; x < 60; ++x) cells(x, y) = 300;
  DemWriter writer(path("lake.tif"), cells.size(), DemReader(dem).georeference(), {.type = ValueType::int16});
  writer.write(0, {0, 0, 120, 90}, cells.view());
  writer.commit(nullptr);
  ASSERT_EQ(run("compress " + path("lake.tif") + " " + path("lake.sct") + " --rmse 5 --flat exact").code, 0);
  EXPECT_NE(run("info " + path("lake.sct")).out.find("flat water is exact"), std::string::npos);
  ASSERT_EQ(run("decompress " + path("lake.sct") + " " + path("back.tif")).code, 0);
  const Raster<float> back = read_all(DemReader(path("back.tif")));
  for (std::int64_t y = 50; y < 90; ++y)
    for (std::int64_t x = 0; x < 60; ++x) ASSERT_EQ(back(x, y), 300);
}

TEST_F(CompressVerb, WindowsAndLevels) {
  const std::string dem = write_mountains("dem.tif", {200, 150});
  ASSERT_EQ(run("compress " + dem + " " + path("dem.sct") + " --rmse 1").code, 0);
  ASSERT_EQ(run("decompress " + path("dem.sct") + " " + path("all.tif")).code, 0);
  ASSERT_EQ(run("decompress " + path("dem.sct") + " " + path("part.tif") + " --window 30 20 50 40").code, 0);
  ASSERT_EQ(run("decompress " + path("dem.sct") + " " + path("coarse.tif") + " --level 2").code, 0);
  const DemReader all(path("all.tif")), part(path("part.tif")), coarse(path("coarse.tif"));
  Raster<float> wanted(50, 40), found(50, 40);
  all.read({30, 20, 50, 40}, wanted.view());
  part.read({0, 0, 50, 40}, found.view());
  for (std::int64_t i = 0; i < 2000; ++i) ASSERT_TRUE(wanted.data()[i] == found.data()[i] || (is_void(wanted.data()[i]) && is_void(found.data()[i])));
  EXPECT_EQ((*part.georeference().transform)[0], 500000 + 30 * 30);
  EXPECT_EQ(coarse.size(), (Size{50, 38}));
  EXPECT_EQ((*coarse.georeference().transform)[1], 120);
}

TEST_F(CompressVerb, InfoSaysWhatItIs) {
  const std::string dem = write_mountains("dem.tif", {100, 80});
  ASSERT_EQ(run("compress " + dem + " " + path("dem.sct") + " --psnr 55").code, 0);
  const Outcome info = run("info --json " + path("dem.sct"));
  ASSERT_EQ(info.code, 0) << info.err;
  const auto said = nlohmann::json::parse(info.out);
  EXPECT_EQ(said["kind"], "tree");
  EXPECT_EQ(said["width"], 100);
  EXPECT_EQ(said["claim"], "psnr");
  EXPECT_EQ(said["claimed"], 55);
  EXPECT_EQ(said["voids"], true);
  EXPECT_NE(run("info " + path("dem.sct")).out.find("UTM zone 33N"), std::string::npos);
}

// Each refusal: its exit code, one line, nothing new in the folder.
TEST_F(CompressVerb, RefusesInOneLine) {
  const std::string dem = write_mountains("dem.tif", {60, 60});
  ASSERT_EQ(run("compress " + dem + " " + path("good.sct") + " --psnr 50").code, 0);
  std::string bytes = read(path("good.sct"));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write(path("bad.sct"), bytes);
  write(path("text.sct"), "ncols 3");
  const std::size_t before = entries();
  const std::vector<std::pair<std::string, int>> cases = {
      {"compress " + path("missing.tif") + " " + path("x.sct") + " --psnr 50", 3},
      {"compress " + dem + " " + path("good.sct") + " --psnr 50", 5},
      {"compress " + dem + " " + path("none/x.sct") + " --psnr 50", 5},
      {"compress " + dem + " " + path("x.sct") + " --psnr 50 --rmse 3", 2},
      {"compress " + dem + " " + path("x.sct") + " --rmse -1", 2},
      {"compress " + dem + " " + path("x.sct") + " --bytes 20", 2},
      {"decompress " + path("bad.sct") + " " + path("x.tif"), 8},
      {"decompress " + path("text.sct") + " " + path("x.tif"), 4},
      {"decompress " + path("good.sct") + " " + path("x.tif") + " --level 30", 2},
      {"decompress " + path("good.sct") + " " + path("x.tif") + " --window 0 0 61 5", 2},
      {"verify " + path("bad.sct"), 8},
      {"verify " + dem, 4},
  };
  for (const auto& [arguments, code] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.out, "") << arguments;
    EXPECT_EQ(entries(), before) << arguments;
  }
}

// The nodata value lies amid the elevations, as 0 does on a coast: cells that are decoded to it stay elevations, the next value of their type.
TEST_F(CompressVerb, NoCellIsVoidBecauseItIsDecodedToTheNodataValue) {
  constexpr double nodata = 100;
  for (const std::string type : {"Byte", "Int16", "UInt16", "Int32", "UInt32", "Float32", "Float64"}) {
    SCOPED_TRACE(type);
    const Size size{90, 70};
    Raster<double> cells(size.width, size.height);
    for (std::int64_t y = 0; y < size.height; ++y)
      for (std::int64_t x = 0; x < size.width; ++x) {
        const double height = std::round(nodata + 12 * std::sin(0.1 * static_cast<double>(x)) * std::cos(0.13 * static_cast<double>(y)));
        cells(x, y) = x > 60 && y < 20 ? std::nan("") : height == nodata ? nodata + (x % 2 ? 1 : -1) : height;
      }
    GeoReference geo;
    geo.nodata = nodata;
    DemWriter writer(path("dem.tif"), size, geo, {.overwrite = true, .type = *value_type_named(type)});
    writer.write_stored({0, 0, size.width, size.height}, cells.view());
    writer.commit();
    ASSERT_EQ(run("compress " + path("dem.tif") + " " + path("dem.sct") + " --overwrite --max-error 3.5").code, 0);
    ASSERT_EQ(run("decompress " + path("dem.sct") + " " + path("back.tif") + " --overwrite").code, 0);

    Raster<double> decoded(size.width, size.height), back(size.width, size.height);
    ElevationTree::open(path("dem.sct")).read_stored(0, {0, 0, size.width, size.height}, decoded.view());
    const DemReader written(path("back.tif"));
    written.read_stored({0, 0, size.width, size.height}, back.view());
    EXPECT_EQ(written.georeference().nodata, nodata);
    int moved = 0;
    for (std::int64_t i = 0; i < size.cells(); ++i) {
      ASSERT_EQ(std::isnan(back.data()[i]), std::isnan(cells.data()[i])) << i;
      if (std::isnan(back.data()[i])) continue;
      const double next = type == "Float32" ? static_cast<double>(std::nextafterf(100, 200)) : type == "Float64" ? std::nextafter(100.0, 200.0) : 101;
      ASSERT_EQ(back.data()[i], decoded.data()[i] == nodata ? next : decoded.data()[i]) << i;
      moved += decoded.data()[i] == nodata;
    }
    EXPECT_GT(moved, 10) << "nothing was tested";
  }
}

// A small dictionary on the mountains' own scale: the tree names it, and every reader finds it where it lies.
TEST_F(CompressVerb, NamesADictionaryThatReadersFind) {
  const std::string dem = write_mountains("dem.tif", {160, 120});
  ASSERT_EQ(run("learn " + dem + " " + path("own.atoms") + " --factor 2 --atoms 24").code, 0);
  const Outcome made = run("compress " + dem + " " + path("dem.sct") + " --profile paper --sparsity 2 --dictionary " + path("own.atoms") + " --json");
  ASSERT_EQ(made.code, 0) << made.err;
  const auto said = nlohmann::json::parse(made.out);
  const auto dictionary_bytes = std::filesystem::file_size(path("own.atoms")), tree_bytes = std::filesystem::file_size(path("dem.sct"));
  EXPECT_EQ(said["bytes"], tree_bytes);
  EXPECT_EQ(said["bytes_with_dictionary"], tree_bytes + dictionary_bytes);
  EXPECT_EQ(said["dictionary"], nlohmann::json::parse(run("info --json " + path("own.atoms")).out)["digest"]);

  const auto info = nlohmann::json::parse(run("info --json " + path("dem.sct")).out);
  EXPECT_EQ(info["dictionary"], said["dictionary"]);
  EXPECT_EQ(info["bytes_with_dictionary"], said["bytes_with_dictionary"]);
  const std::vector<std::string> readers = {"verify " + path("dem.sct") + " --dem " + dem, "sample " + path("dem.sct") + " --cells --point 50.5 60.5",
                                            "decompress " + path("dem.sct") + " " + path("back.tif") + " --overwrite"};
  for (const std::string& reader : readers) {
    const Outcome outcome = run(reader);
    EXPECT_EQ(outcome.code, 0) << reader << "\n" << outcome.err;
  }

  std::filesystem::create_directories(path("elsewhere"));
  std::filesystem::rename(path("own.atoms"), path("elsewhere/own.atoms"));
  for (const std::string& reader : readers) {
    const Outcome outcome = run(reader);
    EXPECT_EQ(outcome.code, 3) << reader;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(said["dictionary"].get<std::string>()), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(run("info " + path("dem.sct")).code, 0);
  setenv("ARETE_DICTIONARIES", path("elsewhere").c_str(), 1);
  for (const std::string& reader : readers) EXPECT_EQ(run(reader).code, 0) << reader;
  EXPECT_EQ(run("compress " + dem + " " + path("again.sct") + " --profile paper --sparsity 2 --dictionary own").code, 0);
  unsetenv("ARETE_DICTIONARIES");
  EXPECT_EQ(read(path("again.sct")), read(path("dem.sct")));
}

TEST_F(CompressVerb, SaysWhatADictionaryFits) {
  const std::string dem = write_mountains("dem.tif", {160, 120});
  ASSERT_EQ(run("learn " + dem + " " + path("own.atoms") + " --factor 4 --atoms 24").code, 0);
  const std::string paper = "compress " + dem + " " + path("dem.sct") + " --profile paper --dictionary ";
  const Outcome radius = run(paper + path("own.atoms") + " --radius 7");
  EXPECT_EQ(radius.code, 2);
  EXPECT_NE(radius.err.find("have 3"), std::string::npos) << radius.err;
  const Outcome missing = run(paper + "nothing");
  EXPECT_EQ(missing.code, 3);
  EXPECT_EQ(missing.error_lines(), 1);
  EXPECT_EQ(run(paper + path("own.atoms") + " --atoms 9").code, 2);
  EXPECT_EQ(run("compress " + dem + " " + path("dem.sct") + " --profile best --dictionary " + path("own.atoms")).code, 2);
  // Landforms on cells of 120 m, a DEM of 30 m.
  const Outcome spacing = run(paper + path("own.atoms"));
  EXPECT_EQ(spacing.code, 0) << spacing.err;
  EXPECT_NE(spacing.err.find("15 to 60 m"), std::string::npos) << spacing.err;
}

TEST_F(CompressVerb, VerifyNoticesAnotherDem) {
  const std::string dem = write_mountains("dem.tif", {60, 60});
  const std::string other = write_mountains("other.tif", {60, 60}, 2);
  ASSERT_EQ(run("compress " + dem + " " + path("dem.sct") + " --rmse 1").code, 0);
  const Outcome outcome = run("verify " + path("dem.sct") + " --dem " + other);
  EXPECT_EQ(outcome.code, 8);
  EXPECT_EQ(outcome.error_lines(), 1);
  EXPECT_NE(outcome.err.find("breaks its claim"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace arete
