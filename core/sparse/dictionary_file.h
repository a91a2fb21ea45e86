#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/sparse/dictionary.h"

namespace arete {

/// The newest version of the .atoms format that this program writes and reads (dictionary-format.md).
inline constexpr std::uint32_t dictionary_format_version = 1;

/// The bytes of an .atoms file. The same dictionary gives the same bytes.
/// Throws Error{usage} for a dictionary that breaks its own rules (sizes that do not fit, names of arrays).
std::vector<std::byte> encode_dictionary(const Dictionary& dictionary);

/// The dictionary that the bytes hold. Safe for untrusted input: every length is checked against the real one before anything is
/// allocated. `name` is for messages. Throws Error{format} where it is no .atoms file or of a newer version, Error{damaged} where it is
/// shortened, changed (any single byte) or breaks its own rules.
Dictionary decode_dictionary(std::span<const std::byte> bytes, const std::string& name = "dictionary");

/// Names a dictionary in metadata: XXH3-128 of its encoded bytes, 32 hexadecimal digits.
std::string dictionary_digest(const Dictionary& dictionary);

Dictionary read_dictionary(const std::filesystem::path& path);
/// Whole or not at all, as write_file_atomically.
void write_dictionary(const std::filesystem::path& path, const Dictionary& dictionary, bool overwrite);

}  // namespace arete
