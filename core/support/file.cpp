#include "core/support/file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/support/error.h"

namespace arete {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t chunk_bytes = std::size_t{1} << 20;
constexpr int most_names_tried = 1000;

[[noreturn]] void fail_reading(ErrorKind kind, const std::string& path, const std::string& reason) {
  throw Error(kind, "cannot read '" + path + "': " + reason);
}

[[noreturn]] void fail_writing(const fs::path& path, const std::string& reason) {
  throw Error(ErrorKind::disk, "cannot write '" + path.string() + "': " + reason);
}

std::string reason_of(int error) { return std::strerror(error); }

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  /// Closing may be the first to tell of a full disk (NFS).
  bool close() { return ::close(std::exchange(number_, -1)) == 0; }

 private:
  int number_;
};

/// Reads up to `limit` bytes, to the end of the file at most. Not every file states its size (/proc).
std::vector<std::byte> read_up_to(const std::string& path, std::size_t limit) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.number() < 0) fail_reading(ErrorKind::input, path, reason_of(errno));
  struct stat about {};
  if (::fstat(file.number(), &about) != 0) fail_reading(ErrorKind::disk, path, reason_of(errno));
  if (S_ISDIR(about.st_mode)) fail_reading(ErrorKind::input, path, "it is a folder");
  std::vector<std::byte> bytes;
  try {
    const auto stated = static_cast<std::size_t>(about.st_size > 0 ? about.st_size : 0);
    bytes.reserve(std::min(limit, stated));
    std::size_t length = 0;
    while (length < limit) {
      // One byte more than stated, so that the end of the file is seen without a second block.
      const std::size_t wanted = length < stated ? stated - length + 1 : chunk_bytes;
      bytes.resize(length + std::min(wanted, limit - length));
      const ssize_t count = ::read(file.number(), bytes.data() + length, bytes.size() - length);
      if (count < 0 && errno != EINTR) fail_reading(ErrorKind::disk, path, reason_of(errno));
      if (count == 0) break;
      if (count > 0) length += static_cast<std::size_t>(count);
    }
    bytes.resize(length);
  } catch (const std::bad_alloc&) {
    fail_reading(ErrorKind::memory, path, "it does not fit into memory");
  } catch (const std::length_error&) {
    fail_reading(ErrorKind::memory, path, "it does not fit into memory");
  }
  return bytes;
}

void flush_folder(const fs::path& folder, const fs::path& target) {
  const Descriptor file(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (file.number() < 0) fail_writing(target, reason_of(errno));
  // Some file systems cannot flush a folder; they say EINVAL.
  if (::fsync(file.number()) != 0 && errno != EINVAL) fail_writing(target, reason_of(errno));
}

}  // namespace

std::vector<std::byte> read_file(const std::string& path) { return read_up_to(path, static_cast<std::size_t>(-1)); }

std::vector<std::byte> read_file_start(const std::string& path, std::size_t count) { return read_up_to(path, count); }

void check_output_file(const std::string& path, bool overwrite) {
  const fs::path target(path);
  if (path.empty() || !target.has_filename()) fail_writing(target, "no file name given");
  const fs::path folder = folder_of(target);
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) fail_writing(target, "the folder '" + folder.string() + "' does not exist");
  const fs::file_status there = fs::symlink_status(target, ignored);
  if (fs::exists(there)) {
    if (fs::is_directory(target, ignored)) fail_writing(target, "it is a folder");
    if (!fs::is_regular_file(there) && !fs::is_symlink(there)) fail_writing(target, "it is no plain file");
    if (!overwrite) fail_writing(target, "it exists already; give --overwrite to replace it");
  }
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    fail_writing(target, "cannot make a file in the folder '" + folder.string() + "': " + reason_of(errno));
}

/// A new hidden file beside its target, removed again unless it was moved into place.
class AtomicFile::HiddenFile {
 public:
  explicit HiddenFile(const fs::path& target) : target_(target), file_(create()) {}
  ~HiddenFile() {
    if (!path_.empty()) ::unlink(path_.c_str());
  }
  HiddenFile(const HiddenFile&) = delete;
  HiddenFile& operator=(const HiddenFile&) = delete;

  void write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::write(file_.number(), bytes.data(), std::min(bytes.size(), std::size_t{1} << 30));
      if (count < 0 && errno != EINTR) fail_writing(target_, reason_of(errno));
      if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
  }

  void flush() {
    if (::fsync(file_.number()) != 0) fail_writing(target_, reason_of(errno));
    if (!file_.close()) fail_writing(target_, reason_of(errno));
  }

  void move_into_place(bool overwrite) {
    const auto exists = [&] { fail_writing(target_, "it exists already; give --overwrite to replace it"); };
    if (!overwrite) {
      if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, target_.c_str(), RENAME_NOREPLACE) == 0) return path_.clear();
      if (errno == EEXIST) exists();
      if (errno != EINVAL && errno != ENOSYS) fail_writing(target_, reason_of(errno));
      // A file system without that kind of rename: a second name for the file does not replace one either.
      if (::link(path_.c_str(), target_.c_str()) == 0) return;
      if (errno == EEXIST) exists();
      if (errno != EPERM && errno != EOPNOTSUPP) fail_writing(target_, reason_of(errno));
      if (::access(target_.c_str(), F_OK) == 0) exists();
    }
    if (::rename(path_.c_str(), target_.c_str()) != 0) fail_writing(target_, reason_of(errno));
    path_.clear();
  }

 private:
  int create() {
    for (int i = 0; i < most_names_tried; ++i) {
      path_ = folder_of(target_) / (".arete-" + std::to_string(::getpid()) + "-" + std::to_string(i));
      const int number = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (number >= 0) return number;
      if (errno != EEXIST) break;
    }
    const int reason = errno;
    path_.clear();
    fail_writing(target_, "cannot make a file in the folder '" + folder_of(target_).string() + "': " + reason_of(reason));
  }

  fs::path target_;
  fs::path path_;
  Descriptor file_;
};

AtomicFile::AtomicFile(const std::string& path, bool overwrite) : path_(path), overwrite_(overwrite) {
  check_output_file(path, overwrite);
  file_ = std::make_unique<HiddenFile>(path);
}

AtomicFile::~AtomicFile() = default;

void AtomicFile::write(std::span<const std::byte> bytes) { file_->write(bytes); }

void AtomicFile::commit() {
  file_->flush();
  file_->move_into_place(overwrite_);
  flush_folder(folder_of(path_), path_);
}

void write_file_atomically(const std::string& path, std::span<const std::byte> bytes, bool overwrite) {
  AtomicFile file(path, overwrite);
  file.write(bytes);
  file.commit();
}

}  // namespace arete
