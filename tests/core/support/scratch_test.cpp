#include "core/support/scratch.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "core/support/error.h"

namespace arete {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> bytes_of(std::size_t count, int seed) {
  std::vector<std::byte> bytes(count);
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::byte>((i * 7 + static_cast<std::size_t>(seed)) % 251);
  return bytes;
}

TEST(Scratch, SpillsBeyondItsLimitAndKeepsItsBytes) {
  const fs::path folder = fs::temp_directory_path() / "arete-scratch-test";
  fs::create_directories(folder);
  ScratchBytes scratch({1 << 20, folder.string()}, 1000);
  scratch.append(bytes_of(900, 1));
  EXPECT_TRUE(scratch.in_memory());
  scratch.append(bytes_of(900, 2));
  EXPECT_FALSE(scratch.in_memory());
  EXPECT_TRUE(fs::is_empty(folder)) << "the file has no name";
  scratch.write(100, bytes_of(50, 3));
  scratch.resize(5000);
  ScratchBytes moved = std::move(scratch);
  EXPECT_EQ(moved.size(), 5000U);
  std::vector<std::byte> expected = bytes_of(900, 1);
  const std::vector<std::byte> more = bytes_of(900, 2), over = bytes_of(50, 3);
  expected.insert(expected.end(), more.begin(), more.end());
  std::copy(over.begin(), over.end(), expected.begin() + 100);
  expected.resize(5000);
  std::vector<std::byte> found(5000);
  moved.read(0, found);
  EXPECT_EQ(found, expected);
  fs::remove_all(folder);
}

TEST(Scratch, StaysInMemoryWithoutAFolder) {
  ScratchBytes scratch({0, ""}, 0);
  scratch.append(bytes_of(3000, 1));
  EXPECT_TRUE(scratch.in_memory());
  std::vector<std::byte> found(3000);
  scratch.read(0, found);
  EXPECT_EQ(found, bytes_of(3000, 1));
}

TEST(Scratch, SaysWhereNoFileCanBeMade) {
  ScratchBytes scratch({0, "/nowhere/at/all"}, 10);
  try {
    scratch.append(bytes_of(11, 1));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::disk);
    EXPECT_NE(std::string(error.what()).find("/nowhere/at/all"), std::string::npos);
  }
}

}  // namespace
}  // namespace arete
