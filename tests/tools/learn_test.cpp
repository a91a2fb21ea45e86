#include <nlohmann/json.hpp>

#include "core/sparse/dictionary_file.h"
#include "tests/tools/verb_fixture.h"

namespace arete {
namespace {

using LearnVerb = VerbFixture;

TEST_F(LearnVerb, WritesADictionaryThatSaysHowItWasMade) {
  const std::string dem = write_mountains("dem.tif", {256, 192});
  const Outcome outcome = run("learn " + dem + " " + path("d.atoms") + " --atoms 30 --radius 480 --factor 4 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Dictionary dictionary = read_dictionary(path("d.atoms"));
  EXPECT_EQ(dictionary.atoms(), 30);
  EXPECT_EQ(dictionary.patch_cells, 8);  // 2 x 480 m in cells of 4 x 30 m
  EXPECT_EQ(dictionary.exemplars, std::vector<std::string>{"dem.tif"});
  EXPECT_NE(dictionary.provenance.find("--atoms 30"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(outcome.out).at("digest"), dictionary_digest(dictionary));
}

TEST_F(LearnVerb, RefusesInOneLineAndWritesNothing) {
  const std::string dem = write_mountains("dem.tif", {128, 128});
  write(path("text.tif"), "no raster");
  write(path("there.atoms"), "mine");
  const std::size_t before = entries();
  const struct {
    std::string arguments;
    int code;
  } cases[] = {{path("missing.tif") + " " + path("d.atoms"), 3}, {path("text.tif") + " " + path("d.atoms"), 3},
               {dem + " " + path("there.atoms"), 5},             {dem + " " + path("no/folder/d.atoms"), 5},
               {dem, 2},                                         {dem + " " + path("d.atoms") + " --factor 1", 2},
               {dem + " " + path("d.atoms") + " --method magic", 2}};
  for (const auto& c : cases) {
    const Outcome outcome = run("learn " + c.arguments);
    EXPECT_EQ(outcome.code, c.code) << c.arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_EQ(entries(), before) << c.arguments;
  }
  EXPECT_EQ(read(path("there.atoms")), "mine");
}

}  // namespace
}  // namespace arete
