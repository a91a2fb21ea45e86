#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace arete {

/// All bytes of a file. Throws Error{input} where it cannot be opened or is a folder, Error{disk} where reading fails half-way,
/// Error{memory} where it does not fit into memory.
std::vector<std::byte> read_file(const std::string& path);

/// The first `count` bytes of a file, fewer where it is shorter. Throws as read_file.
std::vector<std::byte> read_file_start(const std::string& path, std::size_t count);

/// Throws Error{disk} where write_file_atomically would refuse `path` before writing: it exists (unless `overwrite`), is a folder
/// or a device, its folder is missing or cannot be written to. Call it before long work. Nothing is reserved.
void check_output_file(const std::string& path, bool overwrite);

/// Writes a file that appears under its name only when it is whole: a hidden file beside it is written, flushed to the disk and
/// renamed, and the folder is flushed. Without `overwrite` it never replaces a file, even one that appeared meanwhile. Where
/// it fails nothing is left behind. Throws Error{disk}.
void write_file_atomically(const std::string& path, std::span<const std::byte> bytes, bool overwrite);

/// The same for a file that is made piece by piece. Nothing appears under the name before commit(), and nothing is left where
/// the object goes without it.
class AtomicFile {
 public:
  /// Throws Error{disk} as write_file_atomically would before writing.
  AtomicFile(const std::string& path, bool overwrite);
  ~AtomicFile();
  void write(std::span<const std::byte> bytes);
  void commit();

 private:
  class HiddenFile;
  std::string path_;
  bool overwrite_;
  std::unique_ptr<HiddenFile> file_;
};

}  // namespace arete
