#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/support/error.h"
#include "core/support/file.h"
#include "core/support/random.h"
#include "tests/golden/describe_tree.h"

namespace arete {
namespace {

namespace fs = std::filesystem;

// Files below this many bytes have each byte changed in all 255 ways.
constexpr std::size_t small_bytes = 150;

const fs::path golden_folder = fs::path(ARETE_SOURCE_DIR) / "tests/golden/trees";

std::vector<fs::path> golden_trees() {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(golden_folder))
    if (entry.path().extension() == ".sct") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

class GoldenTree : public testing::TestWithParam<fs::path> {
 protected:
  std::vector<std::byte> bytes() const { return read_file(GetParam().string()); }
};

// Reads all that is in the bytes: true where that is an error of a kind that damage has.
bool is_noticed(std::span<const std::byte> bytes) {
  try {
    const ElevationTree tree(TreeFile(view_bytes(bytes), "golden.sct"));
    Raster<double> cells(tree.size().width, tree.size().height);
    tree.read_stored(0, {0, 0, tree.size().width, tree.size().height}, cells.view());
  } catch (const Error& error) {
    return error.kind() == ErrorKind::damaged || error.kind() == ErrorKind::format;
  }
  return false;
}

// The text was made by print_trees and agrees with the independent decoder, which a test of its own checks.
TEST(GoldenTrees, AreReadAsExpected) {
  std::ifstream file(golden_folder / "expected.txt");
  std::stringstream expected;
  expected << file.rdbuf();
  std::string found;
  for (const fs::path& path : golden_trees()) found += describe_tree(ElevationTree::open(path.string()), path.filename().string());
  EXPECT_EQ(found, expected.str());
}

TEST_P(GoldenTree, EveryTruncationIsNoticed) {
  const std::vector<std::byte> whole = bytes();
  for (std::size_t length = 0; length < whole.size(); ++length) EXPECT_TRUE(is_noticed(std::span(whole).first(length))) << length;
}

TEST_P(GoldenTree, EveryChangedByteIsNoticed) {
  std::vector<std::byte> changed = bytes();
  ASSERT_FALSE(is_noticed(changed));
  for (std::size_t i = 0; i < changed.size(); ++i) {
    const std::byte before = changed[i];
    if (changed.size() < small_bytes) {
      for (int change = 1; change < 256; ++change) {
        changed[i] = before ^ static_cast<std::byte>(change);
        ASSERT_TRUE(is_noticed(changed)) << "byte " << i << " changed by " << change;
      }
    } else {
      for (int change : {1, 128, 255, 1 + static_cast<int>(hash_position(5, i) % 255)}) {
        changed[i] = before ^ static_cast<std::byte>(change);
        ASSERT_TRUE(is_noticed(changed)) << "byte " << i << " changed by " << change;
      }
    }
    changed[i] = before;
  }
}

INSTANTIATE_TEST_SUITE_P(Files, GoldenTree, testing::ValuesIn(golden_trees()), [](const auto& tested) { return tested.param.stem().string(); });

}  // namespace
}  // namespace arete
