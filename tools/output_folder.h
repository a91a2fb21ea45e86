#pragma once

#include <filesystem>
#include <string>

namespace arete::tools {

/// A folder that a verb fills, and that appears under its name only when it is complete: until publish() the files lie in a hidden
/// folder beside it, which the destructor removes.
class OutputFolder {
 public:
  /// Throws Error{disk} where `path` is no folder, is a folder that holds something (unless `overwrite`), or its parent is missing
  /// or cannot be written to.
  OutputFolder(const std::string& path, bool overwrite);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write the file `name`.
  std::string file(const std::string& name) const { return (staging_ / name).string(); }
  /// Makes the folder appear. Files of the same name in a folder that existed are replaced, others are kept.
  void publish();
  /// Makes the folder appear as a whole: where one existed it goes, with all that it held. Flushed to the disk first.
  void publish_whole();
  /// Where everything is to be written.
  std::string staging() const { return staging_.string(); }

 private:
  std::filesystem::path path_;
  std::filesystem::path staging_;
};

}  // namespace arete::tools
