#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace arete {

/// The bytes of a file. Throws Error{input} where it is missing, a folder or unreadable, Error{disk} where reading fails.
std::vector<std::byte> read_file(const std::filesystem::path& path);

/// Writes a file whole or not at all: a temporary name beside it, flushed to the disk, then renamed. Without `overwrite` a file that exists
/// is left alone, even one that appears meanwhile. Throws Error{disk} where it exists, or its folder is missing, read-only or full.
void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes, bool overwrite);

}  // namespace arete
