#include "tools/output_folder.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <stdlib.h>

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

}  // namespace arete::tools
