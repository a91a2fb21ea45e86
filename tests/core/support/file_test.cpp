#include "core/support/file.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/support/error.h"

namespace arete {
namespace {

namespace fs = std::filesystem;

class File : public testing::Test {
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
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

std::vector<std::byte> bytes_of(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  std::transform(text.begin(), text.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

template <typename Action>
ErrorKind kind_of_failure(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::usage;
}

TEST_F(File, WhatIsWrittenIsRead) {
  for (const std::size_t length : {std::size_t{0}, std::size_t{1}, std::size_t{4096}, std::size_t{3'000'001}}) {
    std::vector<std::byte> bytes(length);
    for (std::size_t i = 0; i < length; ++i) bytes[i] = static_cast<std::byte>(i * 7 + i / 256);
    write_file_atomically(path("a"), bytes, true);
    EXPECT_EQ(read_file(path("a")), bytes);
    EXPECT_EQ(read_file_start(path("a"), 100).size(), std::min<std::size_t>(length, 100));
    EXPECT_EQ(files(), 1u);
  }
}

TEST_F(File, AnExistingFileIsReplacedOnlyWhenAsked) {
  write_file_atomically(path("a"), bytes_of("first"), false);
  EXPECT_EQ(kind_of_failure([&] { write_file_atomically(path("a"), bytes_of("second"), false); }), ErrorKind::disk);
  EXPECT_EQ(kind_of_failure([&] { check_output_file(path("a"), false); }), ErrorKind::disk);
  EXPECT_EQ(read_file(path("a")), bytes_of("first"));
  write_file_atomically(path("a"), bytes_of("second"), true);
  EXPECT_EQ(read_file(path("a")), bytes_of("second"));
  EXPECT_EQ(files(), 1u);
}

TEST_F(File, NewFilesHaveTheUsualPermissions) {
  const mode_t mask = ::umask(027);
  write_file_atomically(path("a"), bytes_of("x"), false);
  ::umask(mask);
  struct stat about {};
  ASSERT_EQ(::stat(path("a").c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 0777, 0640u);
}

TEST_F(File, WhatCannotBeWrittenFailsBeforeAnythingIsLeft) {
  fs::create_directory(path("folder"));
  for (const std::string& target : {path("none/a"), path("folder"), path("folder/"), std::string(), std::string("/dev/null")}) {
    EXPECT_EQ(kind_of_failure([&] { check_output_file(target, true); }), ErrorKind::disk) << target;
    EXPECT_EQ(kind_of_failure([&] { write_file_atomically(target, bytes_of("x"), true); }), ErrorKind::disk) << target;
  }
  EXPECT_EQ(files(), 1u);
  EXPECT_TRUE(fs::is_empty(path("folder")));
}

TEST_F(File, AFolderThatIsReadOnlyIsRefused) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(kind_of_failure([&] { check_output_file(path("a"), false); }), ErrorKind::disk);
  EXPECT_EQ(kind_of_failure([&] { write_file_atomically(path("a"), bytes_of("x"), false); }), ErrorKind::disk);
}

TEST_F(File, AHiddenNameThatIsTakenIsNotWrittenTo) {
  const std::string taken = path(".arete-" + std::to_string(::getpid()) + "-0");
  fs::create_symlink(path("elsewhere"), taken);
  write_file_atomically(path("a"), bytes_of("new"), false);
  EXPECT_EQ(read_file(path("a")), bytes_of("new"));
  EXPECT_FALSE(fs::exists(path("elsewhere")));
}

TEST_F(File, AFailedWriteLeavesTheOldFileAndNothingElse) {
  write_file_atomically(path("a"), bytes_of("old"), false);
  // A limit on the size of files fails a write half-way, as a full disk does.
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const struct rlimit small = {1000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_EQ(kind_of_failure([&] { write_file_atomically(path("a"), std::vector<std::byte>(5000), true); }), ErrorKind::disk);
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(read_file(path("a")), bytes_of("old"));
  EXPECT_EQ(files(), 1u);
}

TEST_F(File, WhatCannotBeReadSaysSo) {
  EXPECT_EQ(kind_of_failure([&] { read_file(path("none")); }), ErrorKind::input);
  EXPECT_EQ(kind_of_failure([&] { read_file(folder_.string()); }), ErrorKind::input);
}

}  // namespace
}  // namespace arete
