#include "tools/output_folder.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include "core/support/error.h"

namespace arete::tools {
namespace fs = std::filesystem;

OutputFolder::OutputFolder(const std::string& path, bool overwrite) : path_(fs::absolute(path).lexically_normal()) {
  if (!path_.has_filename()) path_ = path_.parent_path();  // a trailing slash
  std::error_code ignored;
  if (fs::exists(path_, ignored)) {
    if (!fs::is_directory(path_, ignored)) throw Error(ErrorKind::disk, path + ": expected a folder, found a file");
    if (!overwrite && !fs::is_empty(path_, ignored))
      throw Error(ErrorKind::disk, path + ": the folder is not empty; choose another, or give --overwrite to replace files in it");
  }
  std::string pattern = (path_.parent_path() / (".arete-XXXXXX")).string();
  if (mkdtemp(pattern.data()) == nullptr)
    throw Error(ErrorKind::disk, path + ": cannot write beside it, in " + path_.parent_path().string() + ": " + std::strerror(errno));
  staging_ = pattern;
  fs::permissions(staging_, fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec | fs::perms::others_read |
                                fs::perms::others_exec, ignored);
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!staging_.empty()) fs::remove_all(staging_, ignored);
}

void OutputFolder::publish() {
  try {
    if (!fs::exists(path_)) {
      fs::rename(staging_, path_);
    } else {
      for (const auto& entry : fs::directory_iterator(staging_)) fs::rename(entry.path(), path_ / entry.path().filename());
      fs::remove(staging_);
    }
    staging_.clear();
  } catch (const fs::filesystem_error& error) {
    throw Error(ErrorKind::disk, path_.string() + ": cannot put the results there: " + error.code().message());
  }
}

void OutputFolder::publish_whole() {
  if (const int folder = ::open(staging_.c_str(), O_RDONLY | O_CLOEXEC); folder >= 0) {
    const int status = ::syncfs(folder), reason = errno;
    ::close(folder);
    if (status != 0) throw Error(ErrorKind::disk, path_.string() + ": cannot write: " + std::strerror(reason));
  }
  try {
    if (!fs::exists(path_)) {
      fs::rename(staging_, path_);
      staging_.clear();
      return;
    }
    // The old folder lies inside the hidden one while the new one takes its name; the destructor removes both.
    std::string aside = (path_.parent_path() / ".arete-XXXXXX").string();
    if (mkdtemp(aside.data()) == nullptr) throw Error(ErrorKind::disk, path_.string() + ": cannot write beside it: " + std::strerror(errno));
    fs::rename(path_, fs::path(aside) / "old");
    fs::rename(staging_, path_);
    staging_ = aside;
  } catch (const fs::filesystem_error& error) {
    throw Error(ErrorKind::disk, path_.string() + ": cannot put the results there: " + error.code().message());
  }
}

}  // namespace arete::tools
