#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/sparse/dictionary.h"

namespace arete {

// Dictionaries as files (.atoms), specified to the byte in core/sparse/dictionary-format.md.

/// How `high` and `detail` are stored. `low`, which decides which atoms are taken, and the upsampler are always exact.
enum class AtomStorage {
  compact,  ///< 16 bits and a power of two per atom: an error of at most 1/32767 of the atom's largest value, half the size
  exact     ///< 32 bits, nothing is lost
};

/// The bytes of the file: the same dictionary gives the same bytes. Throws Error{input} where the dictionary breaks a rule that
/// `find_dictionary_fault` checks.
std::vector<std::byte> encode_dictionary(const Dictionary& dictionary, AtomStorage storage = AtomStorage::compact);

/// Reads the bytes of a file; `name` stands for it in messages. Safe for untrusted input: any changed byte is noticed, nothing
/// outside `file` is read, memory stays below five times `file`. What it returns keeps the rules of `find_dictionary_fault`.
/// Throws Error{format} where it is no dictionary or one of a newer version, Error{damaged} where it is not whole or breaks a
/// rule.
Dictionary decode_dictionary(std::span<const std::byte> file, const std::string& name);

/// Encodes, then writes as write_file_atomically does, and throws what they throw.
void write_dictionary(const std::string& path, const Dictionary& dictionary, bool overwrite,
                      AtomStorage storage = AtomStorage::compact);

/// Throws what read_file and decode_dictionary throw. A file of another kind is not read beyond its first bytes.
Dictionary read_dictionary(const std::string& path);

/// Names a dictionary in metadata: 32 hexadecimal digits, XXH3 with 128 bits over encode_dictionary(dictionary, compact). A
/// dictionary just learned and the same one written (compact or exact) and read back have the same digest.
std::string dictionary_digest(const Dictionary& dictionary);

/// Whether the file begins as a dictionary does. False for what cannot be read.
bool is_dictionary_file(const std::string& path);

/// The first rule that the dictionary breaks, in words; empty where it keeps all: sizes agree (m even, K = m^2, (f m)^2 rows, N
/// columns everywhere, N sources), columns of `low` have unit norm, every value is finite, powers and cell size are not negative,
/// sources lie within the exemplars, symmetries below 8, names without zero bytes.
std::string find_dictionary_fault(const Dictionary& dictionary);

inline constexpr int most_patch_cells = 1024;
inline constexpr int most_dictionary_factor = 1024;
inline constexpr int most_upsampler_reach = 64;

}  // namespace arete
