#include "core/support/file.h"

#include <cstring>
#include <functional>
#include <string>

#include <unistd.h>

#include <gtest/gtest.h>

#include "core/support/error.h"

namespace arete {
namespace {

namespace fs = std::filesystem;

class Files : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "arete-file-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override {
    fs::permissions(folder_, fs::perms::owner_all);
    fs::remove_all(folder_);
  }
  static std::vector<std::byte> bytes_of(const std::string& text) {
    std::vector<std::byte> bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    return bytes;
  }
  std::size_t files() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator())); }
  static ErrorKind kind_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& error) {
      return error.kind();
    }
    ADD_FAILURE() << "no error";
    return ErrorKind::usage;
  }

  fs::path folder_;
};

TEST_F(Files, AreReadAsTheyWereWritten) {
  for (const std::string text : {"", "x", "two\nlines\0and a zero"}) {
    write_file_atomically(folder_ / "a", bytes_of(text), true);
    EXPECT_EQ(read_file(folder_ / "a"), bytes_of(text));
  }
  EXPECT_EQ(files(), 1u);
}

TEST_F(Files, ThatExistAreOnlyReplacedOnWish) {
  write_file_atomically(folder_ / "a", bytes_of("old"), false);
  EXPECT_EQ(kind_of([&] { write_file_atomically(folder_ / "a", bytes_of("new"), false); }), ErrorKind::disk);
  EXPECT_EQ(read_file(folder_ / "a"), bytes_of("old"));
  write_file_atomically(folder_ / "a", bytes_of("new"), true);
  EXPECT_EQ(read_file(folder_ / "a"), bytes_of("new"));
  EXPECT_EQ(files(), 1u);
}

TEST_F(Files, CannotBeWrittenWhereThereIsNoFolderOrNoPermission) {
  EXPECT_EQ(kind_of([&] { write_file_atomically(folder_ / "none" / "a", bytes_of("x"), false); }), ErrorKind::disk);
  EXPECT_EQ(kind_of([&] { write_file_atomically(folder_, bytes_of("x"), true); }), ErrorKind::disk);
  if (::geteuid() == 0) GTEST_SKIP() << "the superuser may write anywhere";
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(kind_of([&] { write_file_atomically(folder_ / "a", bytes_of("x"), false); }), ErrorKind::disk);
}

TEST_F(Files, ThatAreMissingOrFoldersAreAnInputError) {
  EXPECT_EQ(kind_of([&] { read_file(folder_ / "none"); }), ErrorKind::input);
  EXPECT_EQ(kind_of([&] { read_file(folder_); }), ErrorKind::input);
}

}  // namespace
}  // namespace arete
