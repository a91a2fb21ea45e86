#include <cmath>

#include "core/terrain/resample.h"
#include "tests/data.h"
#include "tests/tools/verb_fixture.h"

namespace arete {
namespace {

class AmplifyVerb : public VerbFixture {
 protected:
  /// A dictionary of made mountains, learned once per test.
  std::string learn(const std::string& more = "") {
    const std::string dem = write_mountains("exemplar.tif", {256, 192}, 3);
    EXPECT_EQ(run("learn " + dem + " " + path("d.atoms") + " --atoms 40 " + more).code, 0);
    return path("d.atoms");
  }
};

TEST_F(AmplifyVerb, KeepsExtentCrsMeansAndVoidsAndTellsHowItWasMade) {
  const std::string input = write_mountains("in.tif", {60, 50});
  ASSERT_EQ(run("amplify " + input + " " + path("out.tif") + " --dict " + learn()).code, 0);
  const DemReader coarse(input), fine(path("out.tif"));
  EXPECT_EQ(fine.size(), (Size{240, 200}));
  const auto& t = *fine.georeference().transform;
  EXPECT_EQ(t[0], 500000);
  EXPECT_EQ(t[1], 7.5);
  EXPECT_EQ(t[5], -7.5);
  EXPECT_NE(fine.georeference().crs_wkt.find("UTM zone 33N"), std::string::npos);
  const Raster<float> average = area_average(read_all(fine).view(), 4), before = read_all(coarse);
  for (std::int64_t y = 0; y < 50; ++y)
    for (std::int64_t x = 0; x < 60; ++x) {
      if (is_void(before(x, y)))
        EXPECT_TRUE(is_void(average(x, y)));
      else
        EXPECT_NEAR(average(x, y), before(x, y), 5e-4);  // two units in the last place at 2400 m
    }
  const Outcome info = run("info " + path("out.tif"));
  EXPECT_NE(info.out.find("ARETE_DICTIONARY"), std::string::npos);
  EXPECT_NE(info.out.find("ARETE_COMMAND"), std::string::npos);
}

TEST_F(AmplifyVerb, GivesTheSameCellsForAnyMemoryAndThreads) {
  const std::string input = write_mountains("in.tif", {200, 150}), dictionary = learn();
  ASSERT_EQ(run("amplify " + input + " " + path("a.tif") + " --dict " + dictionary + " --memory 64M --threads 1").code, 0);
  ASSERT_EQ(run("amplify " + input + " " + path("b.tif") + " --dict " + dictionary + " --memory 2G --threads 3").code, 0);
  const Raster<float> a = read_all(DemReader(path("a.tif"))), b = read_all(DemReader(path("b.tif")));
  for (std::int64_t i = 0; i < a.size().cells(); ++i)
    ASSERT_TRUE(a.data()[i] == b.data()[i] || (is_void(a.data()[i]) && is_void(b.data()[i])));
}

TEST_F(AmplifyVerb, AddsTheBandsThatAreAskedFor) {
  const std::string input = write_mountains("in.tif", {40, 40});
  ASSERT_EQ(run("amplify " + input + " " + path("out.tif") + " --dict " + learn() + " --uncertainty --sources").code, 0);
  const Raster<float> error = read_all(DemReader(path("out.tif"), {.band = 2})), exemplar = read_all(DemReader(path("out.tif"), {.band = 3})),
                      atom = read_all(DemReader(path("out.tif"), {.band = 4}));
  EXPECT_GT(error(10, 10), 0);
  EXPECT_EQ(exemplar(10, 10), 1);
  EXPECT_TRUE(atom(10, 10) >= 0 && atom(10, 10) < 40);
}

TEST_F(AmplifyVerb, LearnsFromAnExemplarForAnyFactorAndMethod) {
  const std::string input = write_mountains("in.tif", {30, 24}), exemplar = write_mountains("exemplar.tif", {240, 192}, 5);
  for (const std::string options : {"--factor 2", "--factor 3", "--factor 5 --detail 0.5", "--factor 16", "--method paper --factor 4 --radius 120"}) {
    const Outcome outcome = run("amplify " + input + " " + path("out.tif") + " --exemplar " + exemplar + " --atoms 20 --overwrite " + options);
    EXPECT_EQ(outcome.code, 0) << options << "\n" << outcome.err;
  }
}

TEST_F(AmplifyVerb, RefusesInOneLineWithItsOwnCodeAndWritesNothing) {
  const std::string input = write_mountains("in.tif", {60, 50}), dictionary = learn();
  const std::string whole = read(input), atoms = read(dictionary);
  write(path("short.tif"), whole.substr(0, whole.size() / 2));
  write(path("text.tif"), "This is no raster.\n");
  std::string changed = atoms;
  changed[changed.size() / 2] = static_cast<char>(changed[changed.size() / 2] ^ 1);
  write(path("changed.atoms"), changed);
  write(path("there.tif"), "mine");
  const std::size_t before = entries();
  const std::string dict = " --dict " + dictionary, out = " " + path("out.tif");
  const struct {
    std::string arguments;
    int code;
  } cases[] = {{path("missing.tif") + out + dict, 3},
               {path("text.tif") + out + dict, 3},
               {path("short.tif") + out + dict, 3},
               {input + out + " --dict " + path("changed.atoms"), 8},
               {input + out + " --dict " + path("text.tif"), 4},
               {input + out + " --dict " + path("missing.atoms"), 3},
               {input + " " + path("there.tif") + dict, 5},
               {input + " " + path("no/folder/out.tif") + dict, 5},
               {input + " " + path("out.nonsense") + dict, 4},
               {input + out, 2},
               {input + out + dict + " --exemplar " + input, 2},
               {input + out + dict + " --atoms 5", 2},
               {input + out + dict + " --detail 2", 2},
               {input + out + dict + " --factor 6", 2},
               {input + out + dict + " --method paper --uncertainty", 2},
               {input + out + dict + " --memory 1M", 2}};
  for (const auto& c : cases) {
    const Outcome outcome = run("amplify " + c.arguments);
    EXPECT_EQ(outcome.code, c.code) << c.arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << c.arguments << "\n" << outcome.err;
    EXPECT_EQ(entries(), before) << c.arguments;
  }
  EXPECT_EQ(read(path("there.tif")), "mine");
}

TEST_F(AmplifyVerb, AmplifiesEveryAwkwardDem) {
  if (test_data("edge-cases/tiny_6x4.tif").empty()) GTEST_SKIP() << "no test data";
  const std::string dictionary = learn();
  const struct {
    const char* name;
    std::string options;
  } cases[] = {{"n31e035_srtm3_below_sea_level.tif", ""}, {"fuji_terrain_rgb_512.png", "--terrain-rgb"}, {"some_nodata_74x92.tif", ""},
               {"all_nodata_74x92.tif", ""},              {"geographic_anisotropic_74x92.tif", ""},      {"no_crs_6x4.tif", ""},
               {"tiny_6x4.tif", ""},                      {"skinny_8x160.tif", ""},                      {"south_up_250x250.tif", ""}};
  for (const auto& c : cases) {
    const std::string input = test_data(std::string("edge-cases/") + c.name);
    const Outcome outcome = run("amplify " + input + " " + path("out.tif") + " --overwrite --dict " + dictionary + " " + c.options);
    ASSERT_EQ(outcome.code, 0) << c.name << "\n" << outcome.err;
    const DemReader coarse(input, {.terrain_rgb = !c.options.empty()}), fine(path("out.tif"));
    const Raster<float> before = read_all(coarse), average = area_average(read_all(fine).view(), 4);
    ASSERT_EQ(average.size(), before.size()) << c.name;
    double worst = 0;
    for (std::int64_t i = 0; i < before.size().cells(); ++i) {
      ASSERT_EQ(is_void(before.data()[i]), is_void(average.data()[i])) << c.name;
      if (!is_void(before.data()[i])) worst = std::max(worst, static_cast<double>(std::abs(before.data()[i] - average.data()[i])));
    }
    EXPECT_LT(worst, 1e-3) << c.name;
  }
}

}  // namespace
}  // namespace arete
