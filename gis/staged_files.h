#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace arete {

/// A hidden folder beside an output, in which the output and its side files are made under their final names, and from which they
/// appear all at once. The destructor removes it with all that it holds.
class StagedFiles {
 public:
  /// Throws Error{disk} where `target` (or a side file of it, as GDAL writes them: .aux.xml, .ovr, .msk) exists and may not be
  /// overwritten, where it is a folder, or where its folder is missing or cannot be written to.
  /// `side_endings`: what files beside it that describe it are called after its stem: ".prj" for `mesh.prj` beside `mesh.obj`.
  StagedFiles(const std::string& target, bool overwrite, std::vector<std::string> side_endings = {});
  ~StagedFiles();
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;

  /// The path at which to make the file that will be the target.
  std::string staged() const { return (folder_ / target_.filename()).string(); }
  /// A path for something that is not kept; to be removed before publish().
  std::string scratch(const std::string& name) const { return (folder_ / "scratch" / name).string(); }

  /// Flushes every file to the disk, then moves them beside the target: side files first, the target last; flushes the folder.
  /// A side file that is there already with the same bytes is left as it is.
  /// Side files of an overwritten target that the new one does not have are removed: they describe the old one. Those that are called after
  /// its stem stay where another file than a picture has that stem too: they may be of that one.
  /// Throws Error{disk}; unless files were overwritten, nothing then has appeared.
  void publish();

 private:
  bool shares_its_stem() const;

  std::filesystem::path target_;
  std::filesystem::path folder_;
  bool overwrite_;
  std::vector<std::string> side_endings_;
};

}  // namespace arete
