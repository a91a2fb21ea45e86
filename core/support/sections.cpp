#include "core/support/sections.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <set>

#include "core/support/checksum.h"
#include "core/support/error.h"

namespace arete {
namespace {

static_assert(std::endian::native == std::endian::little, "the files are little-endian; this machine would have to swap bytes");

// Where the fields of the header are, and those of an entry of the table.
constexpr std::size_t at_checksum = 8, at_version = 16, at_count = 20, at_length = 24, header_bytes = 32;
constexpr std::size_t entry_type = 16, entry_zero = 20, entry_rows = 24, entry_columns = 32, entry_offset = 40, entry_length = 48,
                      entry_checksum = 56, entry_bytes = 64;
constexpr std::size_t most_tag_bytes = 16;

template <typename T>
void put(std::byte* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

template <typename T>
T get(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

bool is_tag(const std::string& tag) {
  return !tag.empty() && tag.size() <= most_tag_bytes &&
         std::all_of(tag.begin(), tag.end(), [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; });
}

/// rows x columns x element bytes == length, without overflow.
bool dimensions_fit(const Section& section, std::uint64_t length) {
  const std::uint64_t size = element_bytes(section.type);
  if (length % size != 0) return false;
  const std::uint64_t elements = length / size;
  if (section.rows == 0 || section.columns == 0) return elements == 0;
  return elements % section.rows == 0 && elements / section.rows == section.columns;
}

class Decoder {
 public:
  Decoder(const SectionFormat& format, std::span<const std::byte> file, const std::string& name)
      : format_(format), file_(file), name_(name) {}

  std::vector<Section> decode() const {
    check_header();
    const auto count = get<std::uint32_t>(file_.data() + at_count);
    std::vector<Section> sections;
    std::set<std::string> tags;
    std::size_t end = header_bytes + std::size_t{count} * entry_bytes;
    for (std::uint32_t i = 0; i < count; ++i) {
      sections.push_back(read_entry(file_.data() + header_bytes + std::size_t{i} * entry_bytes, end));
      end += sections.back().bytes.size();
      if (!tags.insert(sections.back().tag).second) fail("section '" + sections.back().tag + "' is there twice");
    }
    if (end != file_.size())
      fail("its sections end at byte " + std::to_string(end) + ", the file at " + std::to_string(file_.size()));
    return sections;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::damaged, "'" + name_ + "' is damaged: " + what + "; take a fresh copy or make it again");
  }

  void check_header() const {
    if (file_.size() < format_.magic.size() || std::memcmp(file_.data(), format_.magic.data(), format_.magic.size()) != 0)
      throw Error(ErrorKind::format, "'" + name_ + "' is not " + format_.description + ": its first bytes are others");
    if (file_.size() < header_bytes) fail("it ends within its header");
    const auto version = get<std::uint32_t>(file_.data() + at_version);
    if (version > format_.version)
      throw Error(ErrorKind::format, "'" + name_ + "' is " + format_.description + " of version " + std::to_string(version) +
                                         ", this program reads versions up to " + std::to_string(format_.version) +
                                         ": update Arete (or the file is damaged)");
    const auto length = get<std::uint64_t>(file_.data() + at_length);
    if (length != file_.size())
      fail("it has " + std::to_string(file_.size()) + " bytes, its header says " + std::to_string(length));
    const std::uint64_t count = get<std::uint32_t>(file_.data() + at_count);
    if (count > (file_.size() - header_bytes) / entry_bytes)
      fail("its table of " + std::to_string(count) + " sections does not fit");
    const std::size_t table_end = header_bytes + count * entry_bytes;
    if (checksum64(file_.data() + at_version, table_end - at_version) != get<std::uint64_t>(file_.data() + at_checksum))
      fail("the checksum of its header does not agree");
    if (version == 0) fail("it is of version 0, which there never was");
  }

  Section read_entry(const std::byte* entry, std::size_t expected_offset) const {
    Section section;
    const char* tag = reinterpret_cast<const char*>(entry);
    const char* tag_end = std::find(tag, tag + most_tag_bytes, '\0');
    section.tag.assign(tag, tag_end);
    if (!is_tag(section.tag) || !std::all_of(tag_end, tag + most_tag_bytes, [](char c) { return c == '\0'; }))
      fail("a section has no proper name");
    const std::string where = "section '" + section.tag + "' ";
    section.type = static_cast<ElementType>(get<std::uint32_t>(entry + entry_type));
    section.rows = get<std::uint64_t>(entry + entry_rows);
    section.columns = get<std::uint64_t>(entry + entry_columns);
    if (get<std::uint32_t>(entry + entry_zero) != 0) fail(where + "has a value where zero must be");
    if (get<std::uint64_t>(entry + entry_offset) != expected_offset) fail(where + "does not begin where the one before it ends");
    const auto length = get<std::uint64_t>(entry + entry_length);
    if (length > file_.size() - expected_offset) fail(where + "reaches beyond the end of the file");
    if (element_bytes(section.type) != 0 && !dimensions_fit(section, length))
      fail(where + "is not as long as its dimensions say");
    section.bytes = file_.subspan(expected_offset, length);
    if (checksum64(section.bytes.data(), section.bytes.size()) != get<std::uint64_t>(entry + entry_checksum))
      fail("the checksum of " + where + "does not agree");
    return section;
  }

  const SectionFormat& format_;
  std::span<const std::byte> file_;
  const std::string& name_;
};

}  // namespace

std::size_t element_bytes(ElementType type) {
  switch (type) {
    case ElementType::u8:
      return 1;
    case ElementType::i16:
      return 2;
    case ElementType::i32:
    case ElementType::f32:
      return 4;
    case ElementType::i64:
    case ElementType::f64:
      return 8;
  }
  return 0;
}

std::vector<std::byte> encode_sections(const SectionFormat& format, const std::vector<Section>& sections) {
  const std::size_t table_end = header_bytes + sections.size() * entry_bytes;
  std::size_t length = table_end;
  for (const Section& section : sections) length += section.bytes.size();
  std::vector<std::byte> file(length);
  std::byte* entry = file.data() + header_bytes;
  std::size_t offset = table_end;
  for (const Section& section : sections) {
    assert(is_tag(section.tag) && dimensions_fit(section, section.bytes.size()));
    std::memcpy(entry, section.tag.data(), section.tag.size());
    put(entry + entry_type, static_cast<std::uint32_t>(section.type));
    put(entry + entry_rows, section.rows);
    put(entry + entry_columns, section.columns);
    put(entry + entry_offset, static_cast<std::uint64_t>(offset));
    put(entry + entry_length, static_cast<std::uint64_t>(section.bytes.size()));
    put(entry + entry_checksum, checksum64(section.bytes.data(), section.bytes.size()));
    std::copy(section.bytes.begin(), section.bytes.end(), file.begin() + static_cast<std::ptrdiff_t>(offset));
    offset += section.bytes.size();
    entry += entry_bytes;
  }
  std::memcpy(file.data(), format.magic.data(), format.magic.size());
  put(file.data() + at_version, format.version);
  put(file.data() + at_count, static_cast<std::uint32_t>(sections.size()));
  put(file.data() + at_length, static_cast<std::uint64_t>(length));
  put(file.data() + at_checksum, checksum64(file.data() + at_version, table_end - at_version));
  return file;
}

std::vector<Section> decode_sections(const SectionFormat& format, std::span<const std::byte> file, const std::string& name) {
  return Decoder(format, file, name).decode();
}

}  // namespace arete
