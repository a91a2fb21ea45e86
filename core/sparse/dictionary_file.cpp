// The format is specified in dictionary-format.md.
#include "core/sparse/dictionary_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>

#include "core/support/checksum.h"
#include "core/support/error.h"
#include "core/support/file.h"

namespace arete {

namespace {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

constexpr char magic[9] = "ARETEATM";
constexpr std::size_t header_bytes = 32, entry_bytes = 64, name_bytes = 16, checksum_at = 24;
constexpr std::uint32_t most_sections = 256;
constexpr std::int64_t most_patch_cells = 1024, most_factor = 1024, most_reach = 64;

enum class Element : std::uint32_t { u8 = 0, f32 = 1, i64 = 2, f64 = 3 };
std::uint64_t size_of(Element element) { return element == Element::u8 ? 1 : element == Element::f32 ? 4 : 8; }

struct Section {
  Element element = Element::u8;
  std::uint64_t rows = 0;
  std::uint64_t columns = 0;
  std::span<const std::byte> bytes;
};
using Sections = std::map<std::string, Section>;

bool is_section_name(const std::string& name) {
  return !name.empty() && name.size() < name_bytes && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

template <typename T>
void put(std::vector<std::byte>& to, std::size_t at, const T& value) {
  std::memcpy(to.data() + at, &value, sizeof value);
}

template <typename T>
T get(std::span<const std::byte> from, std::size_t at) {
  T value;
  std::memcpy(&value, from.data() + at, sizeof value);
  return value;
}

// Header and table under one sum, less the sum itself.
std::uint64_t table_checksum(std::span<const std::byte> bytes, std::size_t table_end) {
  std::vector<std::byte> covered(bytes.begin(), bytes.begin() + checksum_at);
  covered.insert(covered.end(), bytes.begin() + header_bytes, bytes.begin() + static_cast<std::ptrdiff_t>(table_end));
  return checksum64(covered.data(), covered.size());
}

// ---- writing

std::vector<std::byte> pack_sections(const Sections& sections) {
  std::uint64_t length = header_bytes + entry_bytes * sections.size();
  const std::size_t table_end = length;
  for (const auto& [name, section] : sections) length += section.bytes.size();
  std::vector<std::byte> file(length);
  std::memcpy(file.data(), magic, 8);
  put(file, 8, dictionary_format_version);
  put(file, 12, static_cast<std::uint32_t>(sections.size()));
  put(file, 16, length);
  std::size_t entry = header_bytes, offset = table_end;
  for (const auto& [name, section] : sections) {
    std::memcpy(file.data() + entry, name.data(), name.size());
    put(file, entry + 16, static_cast<std::uint32_t>(section.element));
    put(file, entry + 24, section.rows);
    put(file, entry + 32, section.columns);
    put(file, entry + 40, static_cast<std::uint64_t>(offset));
    put(file, entry + 48, static_cast<std::uint64_t>(section.bytes.size()));
    put(file, entry + 56, checksum64(section.bytes.data(), section.bytes.size()));
    std::copy(section.bytes.begin(), section.bytes.end(), file.begin() + static_cast<std::ptrdiff_t>(offset));
    entry += entry_bytes;
    offset += section.bytes.size();
  }
  put(file, checksum_at, table_checksum(file, table_end));
  return file;
}

template <typename T>
Section section_of(Element element, std::int64_t rows, std::int64_t columns, const T* values) {
  return {element, static_cast<std::uint64_t>(rows), static_cast<std::uint64_t>(columns),
          std::as_bytes(std::span(values, static_cast<std::size_t>(rows * columns)))};
}

Section matrix_section(const Eigen::MatrixXf& values) { return section_of(Element::f32, values.rows(), values.cols(), values.data()); }

Section text_section(const std::string& text) {
  return section_of(Element::u8, static_cast<std::int64_t>(text.size()), 1, text.data());
}

const std::vector<std::string> own_sections = {"parameters", "cell_size_m", "low",       "high",            "detail",
                                               "sources",    "exemplars",   "provenance", "upsampler_shape", "upsampler"};

bool is_own_section(const std::string& name) { return std::find(own_sections.begin(), own_sections.end(), name) != own_sections.end(); }

// ---- rules that a dictionary keeps, written or read; empty where it does

std::string broken_sizes(const Dictionary& d) {
  const std::int64_t m = d.patch_cells, f = d.factor, atoms = d.atoms();
  if (m < 2 || m > most_patch_cells || m % 2 != 0) return "patches of " + std::to_string(m) + " cells";
  if (f < 1 || f > most_factor) return "factor " + std::to_string(f);
  if (d.low.rows() != m * m) return "low atoms of " + std::to_string(d.low.rows()) + " samples instead of " + std::to_string(m * m);
  for (const Eigen::MatrixXf* pair : {&d.high, &d.detail})
    if (pair->size() != 0 && (pair->cols() != atoms || pair->rows() != f * m * f * m)) return "high or detail atoms of another size";
  if (static_cast<std::int64_t>(d.sources.size()) != atoms) return "another number of sources than of atoms";
  if (!d.upsampler) return {};
  const Upsampler& u = *d.upsampler;
  if (u.factor < 1 || u.factor > most_factor || u.reach < 0 || u.reach > most_reach) return "an upsampler out of range";
  const std::int64_t taps = (2 * u.reach + 1) * (2 * u.reach + 1);
  if (static_cast<std::int64_t>(u.weights.size()) != taps * u.factor * u.factor) return "an upsampler with another number of weights";
  return {};
}

std::string broken_values(const Dictionary& d) {
  if (!std::isfinite(d.cell_size_m) || d.cell_size_m < 0) return "a cell size that is no length";
  for (const AtomSource& source : d.sources)
    if (source.exemplar < -1 || source.exemplar >= static_cast<std::int64_t>(d.exemplars.size()) || source.symmetry > 7)
      return "an atom whose source does not exist";
  if (!d.low.allFinite() || !d.high.allFinite() || !d.detail.allFinite()) return "an atom that is not finite";
  for (Eigen::Index j = 0; j < d.low.cols(); ++j)
    if (std::abs(d.low.col(j).norm() - 1) > 1e-3f) return "an atom that is not of unit norm";
  if (d.upsampler && !std::all_of(d.upsampler->weights.begin(), d.upsampler->weights.end(), [](float w) { return std::isfinite(w); }))
    return "an upsampler that is not finite";
  for (const auto& [name, values] : d.arrays) {
    if (!is_section_name(name) || is_own_section(name)) return "an array with the name '" + name + "'";
    if (!values.allFinite()) return "an array that is not finite: " + name;
  }
  for (const std::string& name : d.exemplars)
    if (name.find('\0') != std::string::npos) return "an exemplar's name with a zero byte";
  if (d.method > LearningMethod::constrained) return "an unknown learning method";
  return {};
}

std::string broken_rule(const Dictionary& dictionary) {
  const std::string sizes = broken_sizes(dictionary);
  return sizes.empty() ? broken_values(dictionary) : sizes;
}

// ---- reading

class Reader {
 public:
  Reader(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Sections sections() const {
    check_header();
    const auto count = get<std::uint32_t>(bytes_, 12);
    Sections sections;
    std::uint64_t offset = header_bytes + entry_bytes * count;
    for (std::uint32_t i = 0; i < count; ++i) add_section(header_bytes + entry_bytes * i, offset, sections);
    if (offset != bytes_.size()) damaged("has bytes after its last section");
    return sections;
  }

  [[noreturn]] void damaged(const std::string& what) const {
    throw Error(ErrorKind::damaged, name_ + " " + what + ": damaged, fetch or learn it again");
  }

 private:
  void check_header() const {
    if (bytes_.size() < 8 || std::memcmp(bytes_.data(), magic, 8) != 0)
      throw Error(ErrorKind::format, name_ + " is not a dictionary: an .atoms file begins with ARETEATM");
    if (bytes_.size() < header_bytes) damaged("ends within its header");
    const auto version = get<std::uint32_t>(bytes_, 8);
    if (version == 0 || version > dictionary_format_version)
      throw Error(ErrorKind::format, name_ + " is of format version " + std::to_string(version) + ", this program reads up to " +
                                         std::to_string(dictionary_format_version) + ": use a newer arete");
    const auto length = get<std::uint64_t>(bytes_, 16);
    if (length != bytes_.size())
      damaged("has " + std::to_string(bytes_.size()) + " bytes instead of " + std::to_string(length));
    const auto count = get<std::uint32_t>(bytes_, 12);
    if (count == 0 || count > most_sections || header_bytes + entry_bytes * count > bytes_.size())
      damaged("has a table of " + std::to_string(count) + " sections");
    if (table_checksum(bytes_, header_bytes + entry_bytes * count) != get<std::uint64_t>(bytes_, checksum_at))
      damaged("fails the checksum of its header");
  }

  // Reads one entry of the table; `offset` is where its section must begin, and moves to its end.
  void add_section(std::size_t entry, std::uint64_t& offset, Sections& sections) const {
    const char* letters = reinterpret_cast<const char*>(bytes_.data() + entry);
    const std::string name(letters, strnlen(letters, name_bytes));
    const bool padded = std::all_of(letters + name.size(), letters + name_bytes, [](char c) { return c == 0; });
    if (!is_section_name(name) || !padded || sections.contains(name)) damaged("has a section without a proper name");
    const auto element = get<std::uint32_t>(bytes_, entry + 16);
    if (element > 3 || get<std::uint32_t>(bytes_, entry + 20) != 0) damaged("has a section of unknown type, " + name);
    Section section{static_cast<Element>(element), get<std::uint64_t>(bytes_, entry + 24), get<std::uint64_t>(bytes_, entry + 32), {}};
    const auto length = get<std::uint64_t>(bytes_, entry + 48);
    if (get<std::uint64_t>(bytes_, entry + 40) != offset || length > bytes_.size() - offset || !fits(section, length))
      damaged("has a section out of bounds, " + name);
    section.bytes = bytes_.subspan(offset, length);
    if (checksum64(section.bytes.data(), length) != get<std::uint64_t>(bytes_, entry + 56))
      damaged("fails the checksum of section " + name);
    offset += length;
    sections.emplace(name, section);
  }

  // rows x columns x size = length, without overflow.
  bool fits(const Section& section, std::uint64_t length) const {
    const std::uint64_t size = size_of(section.element), limit = bytes_.size();
    if (section.rows > limit || section.columns > limit) return false;  // each below 2^63
    if (section.rows != 0 && section.columns > limit / section.rows) return false;
    return section.rows * section.columns <= limit / size && section.rows * section.columns * size == length;
  }

  std::span<const std::byte> bytes_;
  const std::string& name_;
};

// Takes sections out one by one, with the type and shape that the format gives them.
class Contents {
 public:
  Contents(Sections sections, const Reader& reader) : sections_(std::move(sections)), reader_(reader) {}

  bool has(const std::string& name) const { return sections_.contains(name); }

  Section take(const std::string& name, Element element) {
    const auto found = sections_.find(name);
    if (found == sections_.end()) reader_.damaged("lacks section " + name);
    const Section section = found->second;
    if (section.element != element) reader_.damaged("has another type of section " + name);
    sections_.erase(found);
    return section;
  }

  Section take(const std::string& name, Element element, std::uint64_t rows, std::uint64_t columns) {
    const Section section = take(name, element);
    if (section.rows != rows || section.columns != columns) reader_.damaged("has another size of section " + name);
    return section;
  }

  Eigen::MatrixXf take_matrix(const std::string& name) {
    const Section section = take(name, Element::f32);
    Eigen::MatrixXf values(static_cast<Eigen::Index>(section.rows), static_cast<Eigen::Index>(section.columns));
    if (!section.bytes.empty()) std::memcpy(values.data(), section.bytes.data(), section.bytes.size());
    return values;
  }

  std::string take_text(const std::string& name) {
    const Section section = take(name, Element::u8);
    if (section.columns != 1) reader_.damaged("has another size of section " + name);
    return {reinterpret_cast<const char*>(section.bytes.data()), section.bytes.size()};
  }

  const Sections& rest() const { return sections_; }

 private:
  Sections sections_;
  const Reader& reader_;
};

void take_parameters(Contents& contents, const Reader& reader, Dictionary& dictionary) {
  const Section section = contents.take("parameters", Element::i64, 3, 1);
  const auto method = get<std::int64_t>(section.bytes, 0), m = get<std::int64_t>(section.bytes, 8), f = get<std::int64_t>(section.bytes, 16);
  if (method < 0 || method > 2 || m < 2 || m > most_patch_cells || f < 1 || f > most_factor) reader.damaged("has parameters out of range");
  dictionary.method = static_cast<LearningMethod>(method);
  dictionary.patch_cells = static_cast<int>(m);
  dictionary.factor = static_cast<int>(f);
  dictionary.cell_size_m = get<double>(contents.take("cell_size_m", Element::f64, 1, 1).bytes, 0);
}

void take_sources(Contents& contents, const Reader& reader, Dictionary& dictionary) {
  const Section section = contents.take("sources", Element::i64, 4, static_cast<std::uint64_t>(dictionary.atoms()));
  for (std::int64_t j = 0; j < dictionary.atoms(); ++j) {
    const std::size_t at = static_cast<std::size_t>(j) * 32;
    const auto exemplar = get<std::int64_t>(section.bytes, at), symmetry = get<std::int64_t>(section.bytes, at + 24);
    if (exemplar < -1 || exemplar > INT32_MAX || symmetry < 0 || symmetry > 7) reader.damaged("has an atom whose source does not exist");
    dictionary.sources.push_back({static_cast<std::int32_t>(exemplar), get<std::int64_t>(section.bytes, at + 8),
                                  get<std::int64_t>(section.bytes, at + 16), static_cast<std::uint8_t>(symmetry)});
  }
  const std::string names = contents.take_text("exemplars");
  if (!names.empty() && names.back() != '\0') reader.damaged("has an exemplar's name without end");
  for (std::size_t at = 0; at < names.size(); at = names.find('\0', at) + 1)
    dictionary.exemplars.push_back(names.substr(at, names.find('\0', at) - at));
}

void take_upsampler(Contents& contents, const Reader& reader, Dictionary& dictionary) {
  if (!contents.has("upsampler_shape")) return;
  const Section shape = contents.take("upsampler_shape", Element::i64, 2, 1);
  const auto factor = get<std::int64_t>(shape.bytes, 0), reach = get<std::int64_t>(shape.bytes, 8);
  if (factor < 1 || factor > most_factor || reach < 0 || reach > most_reach) reader.damaged("has an upsampler out of range");
  const Eigen::MatrixXf weights = contents.take_matrix("upsampler");
  dictionary.upsampler = Upsampler{static_cast<int>(factor), static_cast<int>(reach), {weights.data(), weights.data() + weights.size()}};
}

}  // namespace

std::vector<std::byte> encode_dictionary(const Dictionary& dictionary) {
  if (const std::string broken = broken_rule(dictionary); !broken.empty())
    throw Error(ErrorKind::usage, "cannot store a dictionary with " + broken);
  const std::int64_t parameters[3] = {static_cast<std::int64_t>(dictionary.method), dictionary.patch_cells, dictionary.factor};
  std::vector<std::int64_t> sources;
  for (const AtomSource& s : dictionary.sources) sources.insert(sources.end(), {s.exemplar, s.x, s.y, s.symmetry});
  std::string exemplars;
  for (const std::string& name : dictionary.exemplars) exemplars += name + '\0';

  Sections sections;
  sections["parameters"] = section_of(Element::i64, 3, 1, parameters);
  sections["cell_size_m"] = section_of(Element::f64, 1, 1, &dictionary.cell_size_m);
  sections["low"] = matrix_section(dictionary.low);
  if (dictionary.high.size() != 0) sections["high"] = matrix_section(dictionary.high);
  if (dictionary.detail.size() != 0) sections["detail"] = matrix_section(dictionary.detail);
  sections["sources"] = section_of(Element::i64, 4, dictionary.atoms(), sources.data());
  sections["exemplars"] = text_section(exemplars);
  sections["provenance"] = text_section(dictionary.provenance);
  std::int64_t shape[2] = {0, 0};
  if (dictionary.upsampler) {
    const Upsampler& u = *dictionary.upsampler;
    shape[0] = u.factor;
    shape[1] = u.reach;
    const std::int64_t phases = std::int64_t{u.factor} * u.factor;
    sections["upsampler_shape"] = section_of(Element::i64, 2, 1, shape);
    sections["upsampler"] = section_of(Element::f32, static_cast<std::int64_t>(u.weights.size()) / phases, phases, u.weights.data());
  }
  for (const auto& [name, values] : dictionary.arrays) sections[name] = matrix_section(values);
  return pack_sections(sections);
}

Dictionary decode_dictionary(std::span<const std::byte> bytes, const std::string& name) {
  const Reader reader(bytes, name);
  Contents contents(reader.sections(), reader);
  Dictionary dictionary;
  take_parameters(contents, reader, dictionary);
  dictionary.low = contents.take_matrix("low");
  if (contents.has("high")) dictionary.high = contents.take_matrix("high");
  if (contents.has("detail")) dictionary.detail = contents.take_matrix("detail");
  take_sources(contents, reader, dictionary);
  dictionary.provenance = contents.take_text("provenance");
  take_upsampler(contents, reader, dictionary);
  std::vector<std::string> others;
  for (const auto& [other, section] : contents.rest()) others.push_back(other);
  for (const std::string& other : others) dictionary.arrays[other] = contents.take_matrix(other);
  if (const std::string broken = broken_rule(dictionary); !broken.empty()) reader.damaged("holds " + broken);
  return dictionary;
}

std::string dictionary_digest(const Dictionary& dictionary) {
  const std::vector<std::byte> bytes = encode_dictionary(dictionary);
  return digest_hex(bytes.data(), bytes.size());
}

Dictionary read_dictionary(const std::filesystem::path& path) { return decode_dictionary(read_file(path), path.string()); }

void write_dictionary(const std::filesystem::path& path, const Dictionary& dictionary, bool overwrite) {
  write_file_atomically(path, encode_dictionary(dictionary), overwrite);
}

}  // namespace arete
