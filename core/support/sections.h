#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace arete {

// A file of ours as a table of sections, each an array of numbers with a name. Laid out to the byte in
// core/sparse/dictionary-format.md. Safe for untrusted input.

enum class ElementType : std::uint32_t { u8 = 1, i16 = 2, i32 = 3, i64 = 4, f32 = 5, f64 = 6 };

/// Bytes of an element; 0 for a type that is none of these.
std::size_t element_bytes(ElementType type);

/// What tells one format of ours from another.
struct SectionFormat {
  std::array<std::uint8_t, 8> magic;
  std::uint32_t version;    ///< the newest that can be read, and the one that is written; counted from 1
  const char* description;  ///< in messages: "a dictionary of Arete (.atoms)"
};

/// An array of `rows` x `columns` numbers, column by column, little-endian. Does not own its bytes.
struct Section {
  std::string tag;  ///< 1 to 16 of a-z, 0-9 and _; unique in the file
  ElementType type = ElementType::u8;
  std::uint64_t rows = 0;
  std::uint64_t columns = 0;
  std::span<const std::byte> bytes;
};

/// The whole file. The same sections give the same bytes. Each section's bytes are as long as its type and dimensions say.
std::vector<std::byte> encode_sections(const SectionFormat& format, const std::vector<Section>& sections);

/// The sections of a file, as views of `file`. Guarantees:
/// 1. every byte of the file was under a checksum or compared with what it must be: one changed byte is always noticed;
/// 2. the bytes of a section of a known type are exactly as many as its type and dimensions need; tags are unique;
/// 3. nothing is read outside `file`, whatever it holds; memory is allocated for the table only, which is shorter than `file`.
/// Throws Error{format} where the file is of another kind or of a newer version, Error{damaged} where anything else is wrong;
/// `name` stands for the file in messages.
std::vector<Section> decode_sections(const SectionFormat& format, std::span<const std::byte> file, const std::string& name);

}  // namespace arete
