#include "tools/output_folder.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "core/support/error.h"

namespace {

namespace fs = std::filesystem;
using arete::tools::OutputFolder;

class OutputFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    parent_ = fs::path(testing::TempDir()) / ("arete-folder-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(parent_);
    fs::create_directories(parent_);
  }
  void TearDown() override { fs::remove_all(parent_); }
  void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
  std::string read(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  std::ptrdiff_t entries() { return std::distance(fs::directory_iterator(parent_), fs::directory_iterator()); }
  fs::path parent_;
};

TEST_F(OutputFolderTest, AppearsWhenPublished) {
  OutputFolder folder((parent_ / "out").string() + "/", false);
  write(folder.file("a.txt"), "a");
  EXPECT_FALSE(fs::exists(parent_ / "out"));
  folder.publish();
  EXPECT_EQ(read(parent_ / "out" / "a.txt"), "a");
  EXPECT_EQ(entries(), 1);
}

TEST_F(OutputFolderTest, LeavesNothingWhenNotPublished) {
  {
    OutputFolder folder((parent_ / "out").string(), false);
    write(folder.file("a.txt"), "a");
  }
  EXPECT_EQ(entries(), 0);
}

TEST_F(OutputFolderTest, ReplacesOnlyWhenAskedTo) {
  fs::create_directory(parent_ / "out");
  OutputFolder((parent_ / "out").string(), false).publish();  // an empty folder is no obstacle
  write(parent_ / "out" / "a.txt", "old");
  write(parent_ / "out" / "kept.txt", "kept");
  EXPECT_THROW(OutputFolder((parent_ / "out").string(), false), arete::Error);

  OutputFolder folder((parent_ / "out").string(), true);
  write(folder.file("a.txt"), "new");
  EXPECT_EQ(read(parent_ / "out" / "a.txt"), "old");
  folder.publish();
  EXPECT_EQ(read(parent_ / "out" / "a.txt"), "new");
  EXPECT_EQ(read(parent_ / "out" / "kept.txt"), "kept");
  EXPECT_EQ(entries(), 1);
}

TEST_F(OutputFolderTest, RefusesAFileAndAMissingParent) {
  write(parent_ / "file", "x");
  EXPECT_THROW(OutputFolder((parent_ / "file").string(), true), arete::Error);
  EXPECT_THROW(OutputFolder((parent_ / "missing" / "out").string(), true), arete::Error);
  EXPECT_EQ(entries(), 1);
}

}  // namespace
