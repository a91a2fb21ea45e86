#include "gis/staged_files.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "core/support/error.h"

namespace arete {
namespace fs = std::filesystem;
namespace {

constexpr const char* side_file_suffixes[] = {".aux.xml", ".ovr", ".msk"};

[[noreturn]] void fail(const fs::path& target, const std::string& reason) {
  throw Error(ErrorKind::disk, "cannot write '" + target.string() + "': " + reason);
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::symlink_status(path, ignored).type() != fs::file_type::not_found &&
         fs::symlink_status(path, ignored).type() != fs::file_type::none;
}

void flush_to_disk(const fs::path& path, const fs::path& target) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail(target, std::strerror(errno));
  const int status = ::fsync(file);
  const int reason = errno;
  ::close(file);
  // Some file systems cannot flush a folder; they say EINVAL.
  if (status != 0 && reason != EINVAL) fail(target, std::strerror(reason));
}

/// Whether a file has these very bytes already.
bool same_bytes(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  if (!fs::is_regular_file(b, ignored) || fs::file_size(a, ignored) != fs::file_size(b, ignored)) return false;
  std::ifstream first(a, std::ios::binary), second(b, std::ios::binary);
  return std::equal(std::istreambuf_iterator<char>(first), {}, std::istreambuf_iterator<char>(second), {});
}

/// Renames; without `overwrite` never over a file that appeared meanwhile.
void move_into_place(const fs::path& from, const fs::path& to, bool overwrite) {
  if (!overwrite) {
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return;
    if (errno == EEXIST) fail(to, "it exists already; give --overwrite to replace it");
    if (errno != EINVAL && errno != ENOSYS) fail(to, std::strerror(errno));
    if (is_there(to)) fail(to, "it exists already; give --overwrite to replace it");
  }
  if (::rename(from.c_str(), to.c_str()) != 0) fail(to, std::strerror(errno));
}

}  // namespace

StagedFiles::StagedFiles(const std::string& target, bool overwrite, std::vector<std::string> side_endings)
    : target_(target), overwrite_(overwrite), side_endings_(std::move(side_endings)) {
  if (target.empty() || !target_.has_filename()) fail(target_, "no file name given");
  std::error_code ignored;
  const fs::path beside = folder_of(target_);
  if (!fs::is_directory(beside, ignored)) fail(target_, "the folder '" + beside.string() + "' does not exist");
  if (fs::is_directory(target_, ignored)) fail(target_, "it is a folder");
  if (!overwrite && is_there(target_)) fail(target_, "it exists already; give --overwrite to replace it");
  for (const char* suffix : side_file_suffixes)
    if (!overwrite && is_there(target + suffix))
      fail(target_, "a file '" + target + suffix + "' of an earlier one is in its place; give --overwrite to replace it");
  std::string name = (beside / ".arete-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    fail(target_, "cannot make a file in the folder '" + beside.string() + "': " + std::strerror(errno));
  folder_ = name;
  fs::create_directory(folder_ / "scratch", ignored);
}

StagedFiles::~StagedFiles() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

/// Whether another file beside the target has its stem, but side files and pictures: textures are called so, and previews.
bool StagedFiles::shares_its_stem() const {
  const std::string stem = target_.stem().string();
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_of(target_), ignored)) {
    const fs::path name = entry.path().filename(), extension = name.extension();
    if (name == target_.filename() || name.stem() != stem || extension == ".png" || extension == ".jpg") continue;
    if (std::none_of(side_endings_.begin(), side_endings_.end(), [&](const std::string& ending) { return name == stem + ending; })) return true;
  }
  return false;
}

void StagedFiles::publish() {
  std::error_code ignored;
  const bool replaces = overwrite_ && is_there(target_);
  fs::remove_all(folder_ / "scratch", ignored);
  std::vector<fs::path> names;
  for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename());
  const auto is_target = [&](const fs::path& name) { return name == target_.filename(); };
  std::sort(names.begin(), names.end());
  std::stable_partition(names.begin(), names.end(), [&](const fs::path& name) { return !is_target(name); });
  if (names.empty() || !is_target(names.back())) fail(target_, "its driver made no file of that name");

  for (const fs::path& name : names) flush_to_disk(folder_ / name, target_);
  const fs::path beside = folder_of(target_);
  std::vector<fs::path> placed;
  try {
    for (const fs::path& name : names) {
      // A mesh in another format beside this one has the same .prj.
      if (!is_target(name) && same_bytes(folder_ / name, beside / name)) continue;
      move_into_place(folder_ / name, beside / name, overwrite_);
      placed.push_back(beside / name);
    }
  } catch (const Error&) {
    if (!overwrite_)
      for (const fs::path& path : placed) fs::remove(path, ignored);
    throw;
  }
  for (const char* suffix : side_file_suffixes) {
    const fs::path stale = target_.string() + suffix;
    if (std::find(names.begin(), names.end(), stale.filename()) == names.end()) fs::remove(stale, ignored);
  }
  if (replaces && !side_endings_.empty() && !shares_its_stem())
    for (const std::string& ending : side_endings_) {
      const fs::path stale = beside / (target_.stem().string() + ending);
      if (std::find(names.begin(), names.end(), stale.filename()) == names.end()) fs::remove(stale, ignored);
    }
  flush_to_disk(beside, target_);
}

}  // namespace arete
