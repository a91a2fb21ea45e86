#include "gis/staged_files.h"

#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "tests/gis/dem_files.h"

namespace arete {
namespace {

void put(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

std::string get(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

ErrorKind kind_of_failure(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.kind();
  }
  ADD_FAILURE() << "no error";
  return ErrorKind::usage;
}

TEST(StagedFiles, AppearTogetherAndWithoutScratch) {
  TestFolder folder;
  StagedFiles files(folder / "out.asc", false);
  put(files.staged(), "main");
  put(std::filesystem::path(files.staged()).replace_extension(".prj").string(), "side");
  put(files.scratch("work"), "scratch");
  EXPECT_FALSE(std::filesystem::exists(folder / "out.asc"));
  files.publish();
  EXPECT_EQ(get(folder / "out.asc"), "main");
  EXPECT_EQ(get(folder / "out.prj"), "side");
  EXPECT_FALSE(std::filesystem::exists(folder / "work"));
}

TEST(StagedFiles, LeaveNothingWhenOneIsInTheWay) {
  TestFolder folder;
  put(folder / "out.prj", "precious");
  {
    StagedFiles files(folder / "out.asc", false);
    put(files.staged(), "main");
    put(std::filesystem::path(files.staged()).replace_extension(".aaa").string(), "placed before the collision");
    put(std::filesystem::path(files.staged()).replace_extension(".prj").string(), "side");
    EXPECT_EQ(kind_of_failure([&] { files.publish(); }), ErrorKind::disk);
  }
  EXPECT_EQ(get(folder / "out.prj"), "precious");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"out.prj"});
}

TEST(StagedFiles, LetASideFileWithTheSameBytesBe) {
  TestFolder folder;
  put(folder / "out.prj", "the same");
  StagedFiles files(folder / "out.asc", false);
  put(files.staged(), "main");
  put(std::filesystem::path(files.staged()).replace_extension(".prj").string(), "the same");
  files.publish();
  EXPECT_EQ(get(folder / "out.asc"), "main");
  EXPECT_EQ(get(folder / "out.prj"), "the same");
}

TEST(StagedFiles, AreRefusedBesideSideFilesOfAnotherRaster) {
  TestFolder folder;
  put(folder / "out.tif.aux.xml", "of another");
  EXPECT_EQ(kind_of_failure([&] { StagedFiles(folder / "out.tif", false); }), ErrorKind::disk);
  StagedFiles files(folder / "out.tif", true);
  put(files.staged(), "main");
  files.publish();
  EXPECT_FALSE(std::filesystem::exists(folder / "out.tif.aux.xml"));
}

/// Replaces out.obj by one that has a new .prj alone.
void replace_mesh(const TestFolder& folder) {
  StagedFiles files(folder / "out.obj", true, {".prj", "_offset.xyz", ".mtl"});
  put(files.staged(), "new");
  put(std::filesystem::path(files.staged()).replace_extension(".prj").string(), "new");
  files.publish();
}

TEST(StagedFiles, LeaveNoSideFilesOfAnOverwrittenMesh) {
  TestFolder folder;
  for (const char* name : {"out.obj", "out.prj", "out_offset.xyz", "out.mtl", "out.png", "outer.mtl"}) put(folder / name, "old");
  replace_mesh(folder);
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"out.obj", "out.png", "out.prj", "outer.mtl"}));
  EXPECT_EQ(get(folder / "out.prj"), "new");
  EXPECT_EQ(get(folder / "out.png"), "old");  // a texture, or the user's own: never removed
}

TEST(StagedFiles, LeaveSideFilesThatMayBeOfAnother) {
  TestFolder folder;
  for (const char* name : {"out.obj", "out.stl", "out_offset.xyz"}) put(folder / name, "old");
  replace_mesh(folder);
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"out.obj", "out.prj", "out.stl", "out_offset.xyz"}));
  std::filesystem::remove(folder / "out.obj");
  std::filesystem::remove(folder / "out.stl");
  replace_mesh(folder);  // nothing is replaced: the offset is not of an earlier one
  EXPECT_EQ(get(folder / "out_offset.xyz"), "old");
}

TEST(StagedFiles, NeedTheMainFile) {
  TestFolder folder;
  StagedFiles files(folder / "out.tif", false);
  EXPECT_EQ(kind_of_failure([&] { files.publish(); }), ErrorKind::disk);
}

}  // namespace
}  // namespace arete
