#include "gis/dictionary_search.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/sparse/dictionary_file.h"
#include "core/support/error.h"

namespace arete {
namespace {

namespace fs = std::filesystem;

class DictionarySearch : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("arete-dictionary-search-" + std::to_string(getpid()));
    fs::create_directories(folder_ / "trees");
    fs::create_directories(folder_ / "set");
  }
  void TearDown() override {
    unsetenv("ARETE_DICTIONARIES");
    fs::remove_all(folder_);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  fs::path folder_;
};

// Two atoms of 4 x 4 cells; `column` tells dictionaries apart.
Dictionary small_dictionary(std::int64_t column) {
  Dictionary d;
  d.patch_cells = 4;
  d.factor = 2;
  d.low = Eigen::MatrixXf::Constant(16, 2, 0.25F);
  d.low.col(1).tail(8) *= -1;
  d.high = Eigen::MatrixXf::Constant(64, 2, 0.3F);
  d.exemplars = {"a.tif"};
  d.sources = {{0, column, 0, 0}, {0, column, 4, 0}};
  return d;
}

std::string message_of(const DictionaryFinder& find, const std::string& digest) {
  try {
    find(digest);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "";
}

TEST_F(DictionarySearch, FindsByDigestBesideTheTreeAndWhereTheEnvironmentSays) {
  const Dictionary beside = small_dictionary(1), set = small_dictionary(2);
  write_dictionary(path("trees/one.atoms"), beside, false);
  write_dictionary(path("set/two.atoms"), set, false);
  const DictionaryFinder find = dictionary_finder(path("trees/dem.sct"));
  EXPECT_EQ(find(dictionary_digest(beside)), beside.low);
  EXPECT_NE(message_of(find, dictionary_digest(set)), "");
  setenv("ARETE_DICTIONARIES", ("/nowhere:" + path("set")).c_str(), 1);
  EXPECT_EQ(find(dictionary_digest(set)), set.low);
}

TEST_F(DictionarySearch, KnowsADictionaryThatIsStoredExactly) {
  const Dictionary d = small_dictionary(3);
  write_dictionary(path("trees/exact.atoms"), d, false, AtomStorage::exact);
  const std::optional<FoundDictionary> found = find_dictionary(dictionary_digest(d), path("trees/dem.sct"));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->path, path("trees/exact.atoms"));
  EXPECT_EQ(found->bytes, fs::file_size(found->path));
}

TEST_F(DictionarySearch, PassesOverWhatIsNoDictionaryOrDamaged) {
  const Dictionary d = small_dictionary(4);
  std::ofstream(path("trees/a.atoms")) << "not a dictionary";
  std::ofstream(path("trees/b.atoms"), std::ios::binary).write("\x89" "ATOM\r\n\x1a and no more", 20);
  fs::create_directories(path("trees/c.atoms"));
  write_dictionary(path("trees/d.atoms"), d, false);
  EXPECT_EQ(dictionary_finder(path("trees/dem.sct"))(dictionary_digest(d)), d.low);
}

TEST_F(DictionarySearch, SaysWhichDictionaryIsMissingAndWhereItLooked) {
  setenv("ARETE_DICTIONARIES", path("set").c_str(), 1);
  const std::string digest(32, 'a'), said = message_of(dictionary_finder(path("trees/dem.sct")), digest);
  for (const std::string& part : {digest, path("trees/dem.sct"), "'" + path("trees") + "', '" + path("set") + "'", std::string("ARETE_DICTIONARIES")})
    EXPECT_NE(said.find(part), std::string::npos) << part << " in: " << said;
  EXPECT_EQ(said.find('\n'), std::string::npos);
}

TEST_F(DictionarySearch, NamesAreFoundWithAndWithoutTheirEnding) {
  write_dictionary(path("set/two.atoms"), small_dictionary(2), false);
  setenv("ARETE_DICTIONARIES", path("set").c_str(), 1);
  EXPECT_EQ(locate_dictionary("two"), path("set/two.atoms"));
  EXPECT_EQ(locate_dictionary("two.atoms"), path("set/two.atoms"));
  EXPECT_EQ(locate_dictionary(path("set/two.atoms")), path("set/two.atoms"));
  for (const std::string& none : {std::string("three"), path("two"), std::string("set/two")}) EXPECT_THROW(locate_dictionary(none), Error) << none;
}

// The tests run from a build folder beside the sources, as scripts/build makes it; a build elsewhere has none to find.
TEST_F(DictionarySearch, ShippedDictionariesAreFound) {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path();
  if (!fs::equivalent(program / "../../..", ARETE_SOURCE_DIR)) GTEST_SKIP() << "not built beside the sources";
  EXPECT_EQ(locate_dictionary("alps_srtm_30m_x4"), (fs::path(ARETE_SOURCE_DIR) / "dictionaries/alps_srtm_30m_x4.atoms").string());
}

}  // namespace
}  // namespace arete
