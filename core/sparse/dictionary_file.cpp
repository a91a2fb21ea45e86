#include "core/sparse/dictionary_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>
#include <optional>

#include "core/support/checksum.h"
#include "core/support/error.h"
#include "core/support/file.h"
#include "core/support/sections.h"

namespace arete {
namespace {

// As in PNG: a byte above 127, the name, and line ends that a transfer as text would change.
constexpr SectionFormat atoms_format = {{0x89, 'A', 'T', 'O', 'M', '\r', '\n', 0x1a}, 1, "a dictionary of Arete (.atoms)"};

constexpr int largest_step = 32767;
constexpr int least_exponent = -126;  // below it steps would be subnormal
constexpr double norm_tolerance = 1e-3;
constexpr std::int64_t farthest_source = std::int64_t{1} << 40;

/// Values of a matrix as steps of 16 bits, each column with its own power of two.
struct Steps {
  std::vector<std::int16_t> values;
  std::vector<float> scales;
};

/// The scale is the smallest power of two in which the largest value is at most 32767 steps, and so more than 16383.5: rounding
/// errs by half a step, at most 1/32767 of the largest value. What was rounded once is rounded to the same steps again.
Steps round_columns(const Eigen::MatrixXf& matrix) {
  Steps steps;
  steps.values.reserve(static_cast<std::size_t>(matrix.size()));
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    const float largest = matrix.col(j).cwiseAbs().maxCoeff();
    int exponent = least_exponent;
    if (largest > 0) {
      exponent = std::ilogb(largest) - 14;
      if (std::ldexp(static_cast<double>(largest), -exponent) > largest_step) ++exponent;
      exponent = std::max(exponent, least_exponent);
    }
    steps.scales.push_back(std::ldexp(1.0f, exponent));
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
      steps.values.push_back(static_cast<std::int16_t>(std::lround(std::ldexp(static_cast<double>(matrix(i, j)), -exponent))));
  }
  return steps;
}

/// Sections with the arrays that they are views of. A deque leaves in place what it holds.
class SectionList {
 public:
  template <typename T>
  void add(const char* tag, ElementType type, std::int64_t rows, std::int64_t columns, const T* values) {
    const auto* bytes = reinterpret_cast<const std::byte*>(values);
    held_.emplace_back(bytes, bytes + static_cast<std::size_t>(rows * columns) * sizeof(T));
    sections_.push_back({tag, type, static_cast<std::uint64_t>(rows), static_cast<std::uint64_t>(columns), held_.back()});
  }
  void add_integer(const char* tag, std::int32_t value) { add(tag, ElementType::i32, 1, 1, &value); }
  void add_number(const char* tag, double value) { add(tag, ElementType::f64, 1, 1, &value); }
  void add_text(const char* tag, const std::string& text) {
    add(tag, ElementType::u8, static_cast<std::int64_t>(text.size()), 1, text.data());
  }
  void add_atoms(const std::string& tag, const Eigen::MatrixXf& atoms, AtomStorage storage) {
    if (storage == AtomStorage::exact) return add(tag.c_str(), ElementType::f32, atoms.rows(), atoms.cols(), atoms.data());
    const Steps steps = round_columns(atoms);
    add(tag.c_str(), ElementType::i16, atoms.rows(), atoms.cols(), steps.values.data());
    add((tag + "_scale").c_str(), ElementType::f32, 1, atoms.cols(), steps.scales.data());
  }
  const std::vector<Section>& sections() const { return sections_; }

 private:
  std::deque<std::vector<std::byte>> held_;
  std::vector<Section> sections_;
};

void add_sources(SectionList& list, const std::vector<AtomSource>& sources) {
  std::vector<std::int32_t> exemplars;
  std::vector<std::int64_t> origins;
  std::vector<std::uint8_t> symmetries;
  for (const AtomSource& source : sources) {
    exemplars.push_back(source.exemplar);
    origins.insert(origins.end(), {source.x, source.y});
    symmetries.push_back(source.symmetry);
  }
  const auto count = static_cast<std::int64_t>(sources.size());
  list.add("source_exemplar", ElementType::i32, 1, count, exemplars.data());
  list.add("source_origin", ElementType::i64, 2, count, origins.data());
  list.add("source_symmetry", ElementType::u8, 1, count, symmetries.data());
}

/// Takes the sections of a file apart. Shapes are checked before anything of their size is allocated.
class DictionaryDecoder {
 public:
  DictionaryDecoder(std::span<const std::byte> file, const std::string& name)
      : name_(name), sections_(decode_sections(atoms_format, file, name)) {}

  Dictionary decode() const {
    Dictionary d;
    const std::int32_t method = read_integer("method");
    if (method < 0 || method > static_cast<int>(LearningMethod::constrained)) fail("its learning method is none that there is");
    d.method = static_cast<LearningMethod>(method);
    d.patch_cells = read_integer("patch_cells");
    d.factor = read_integer("factor");
    if (d.patch_cells < 2 || d.patch_cells > most_patch_cells) fail("its patch size is out of range");
    if (d.factor < 1 || d.factor > most_dictionary_factor) fail("its factor is out of range");
    d.cell_size_m = read_number("cell_size_m");
    d.detail_power = read_number("detail_power");
    d.coarse_detail_power = read_number("coarse_power");

    const Section& low = need("low", ElementType::f32);
    const std::uint64_t count = low.columns, side = static_cast<std::uint64_t>(d.patch_cells),
                        fine_side = side * static_cast<std::uint64_t>(d.factor);
    d.low = read_atoms("low", side * side, count);
    if (find("high") != nullptr) d.high = read_atoms("high", fine_side * fine_side, count);
    if (find("detail") != nullptr) d.detail = read_atoms("detail", fine_side * fine_side, count);
    if (find("upsampler") != nullptr) d.upsampler = read_upsampler(d.factor);
    d.sources = read_sources(count);
    d.exemplars = read_names();
    d.provenance = read_text("provenance");
    if (const std::string fault = find_dictionary_fault(d); !fault.empty()) fail(fault);
    return d;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::damaged, "'" + name_ + "' is damaged: " + what + "; take a fresh copy or make it again");
  }

  const Section* find(const std::string& tag) const {
    const auto found =
        std::find_if(sections_.begin(), sections_.end(), [&](const Section& section) { return section.tag == tag; });
    return found == sections_.end() ? nullptr : &*found;
  }

  const Section& need(const std::string& tag, ElementType type) const {
    const Section* section = find(tag);
    if (section == nullptr) fail("section '" + tag + "' is missing");
    if (section->type != type) fail("section '" + tag + "' has another element type than it should");
    return *section;
  }

  /// The elements of a section, which may stand at any address.
  template <typename T>
  std::vector<T> read(const std::string& tag, ElementType type, std::uint64_t rows, std::uint64_t columns) const {
    const Section& section = need(tag, type);
    if (section.rows != rows || section.columns != columns)
      fail("section '" + tag + "' has " + std::to_string(section.rows) + " x " + std::to_string(section.columns) +
           " values, expected " + std::to_string(rows) + " x " + std::to_string(columns));
    std::vector<T> values(section.bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), section.bytes.data(), section.bytes.size());
    return values;
  }

  std::int32_t read_integer(const char* tag) const { return read<std::int32_t>(tag, ElementType::i32, 1, 1)[0]; }
  double read_number(const char* tag) const { return read<double>(tag, ElementType::f64, 1, 1)[0]; }
  std::string read_text(const char* tag) const {
    const Section& section = need(tag, ElementType::u8);
    return {reinterpret_cast<const char*>(section.bytes.data()), section.bytes.size()};
  }

  Eigen::MatrixXf read_atoms(const std::string& tag, std::uint64_t rows, std::uint64_t columns) const {
    const auto size = [](std::uint64_t n) { return static_cast<Eigen::Index>(n); };
    if (find(tag)->type != ElementType::i16) {
      const auto values = read<float>(tag, ElementType::f32, rows, columns);
      return Eigen::Map<const Eigen::MatrixXf>(values.data(), size(rows), size(columns));
    }
    const auto steps = read<std::int16_t>(tag, ElementType::i16, rows, columns);
    const auto scales = read<float>(tag + "_scale", ElementType::f32, 1, columns);
    if (!std::all_of(scales.begin(), scales.end(), [](float s) { return s > 0; }))
      fail("a scale of '" + tag + "' is not positive");
    Eigen::MatrixXf atoms =
        Eigen::Map<const Eigen::Matrix<std::int16_t, Eigen::Dynamic, Eigen::Dynamic>>(steps.data(), size(rows), size(columns))
            .cast<float>();
    for (std::size_t j = 0; j < scales.size(); ++j) atoms.col(static_cast<Eigen::Index>(j)) *= scales[j];
    return atoms;
  }

  Upsampler read_upsampler(int factor) const {
    const Section& section = need("upsampler", ElementType::f32);
    Upsampler upsampler;
    upsampler.factor = factor;
    while (upsampler.reach < most_upsampler_reach &&
           static_cast<std::uint64_t>(upsampler.side() * upsampler.side()) < section.rows)
      ++upsampler.reach;
    const auto side = static_cast<std::uint64_t>(upsampler.side()), f = static_cast<std::uint64_t>(factor);
    upsampler.weights = read<float>("upsampler", ElementType::f32, side * side, f * f);
    return upsampler;
  }

  std::vector<AtomSource> read_sources(std::uint64_t count) const {
    const auto exemplars = read<std::int32_t>("source_exemplar", ElementType::i32, 1, count);
    const auto origins = read<std::int64_t>("source_origin", ElementType::i64, 2, count);
    const auto symmetries = read<std::uint8_t>("source_symmetry", ElementType::u8, 1, count);
    std::vector<AtomSource> sources(exemplars.size());
    for (std::size_t j = 0; j < sources.size(); ++j)
      sources[j] = {exemplars[j], origins[2 * j], origins[2 * j + 1], symmetries[j]};
    return sources;
  }

  std::vector<std::string> read_names() const {
    const std::string text = read_text("exemplars");
    if (!text.empty() && text.back() != '\0') fail("the names of its exemplars do not end");
    std::vector<std::string> names;
    for (std::size_t begin = 0; begin < text.size(); begin += names.back().size() + 1) names.emplace_back(text.c_str() + begin);
    return names;
  }

  const std::string& name_;
  std::vector<Section> sections_;
};

bool begins_as_dictionary(std::span<const std::byte> bytes) {
  return bytes.size() >= atoms_format.magic.size() &&
         std::memcmp(bytes.data(), atoms_format.magic.data(), atoms_format.magic.size()) == 0;
}

bool shape_is(const Eigen::MatrixXf& matrix, std::int64_t rows, std::int64_t columns) {
  return matrix.rows() == rows && matrix.cols() == columns;
}

bool is_magnitude(double value) { return std::isfinite(value) && value >= 0; }

std::string find_atom_fault(const Dictionary& d) {
  const std::int64_t m = d.patch_cells, fine = m * d.factor, count = d.atoms();
  if (count < 1) return "it has no atom";
  if (count > std::numeric_limits<std::int32_t>::max()) return "it has more atoms than codes can count";
  if (d.low.rows() != m * m)
    return "its atoms have " + std::to_string(d.low.rows()) + " samples, expected " + std::to_string(m * m);
  if (!d.low.allFinite()) return "a value of an atom is not finite";
  for (Eigen::Index j = 0; j < count; ++j)
    if (!(std::abs(d.low.col(j).cast<double>().norm() - 1) <= norm_tolerance))
      return "atom " + std::to_string(j) + " has no unit norm";
  for (const Eigen::MatrixXf* part : {&d.high, &d.detail}) {
    if (part->size() == 0) continue;
    if (!shape_is(*part, fine * fine, count)) return "its finer atoms do not have the size of its factor and patch";
    if (!part->allFinite()) return "a value of a finer atom is not finite";
  }
  return {};
}

std::string find_upsampler_fault(const Upsampler& upsampler, int factor) {
  if (upsampler.factor != factor) return "its upsampler is for another factor";
  if (upsampler.reach < 0 || upsampler.reach > most_upsampler_reach) return "the reach of its upsampler is out of range";
  const auto weights = static_cast<std::size_t>(factor) * static_cast<std::size_t>(factor) *
                       static_cast<std::size_t>(upsampler.side()) * static_cast<std::size_t>(upsampler.side());
  if (upsampler.weights.size() != weights) return "its upsampler does not have the weights of its factor and reach";
  if (!std::all_of(upsampler.weights.begin(), upsampler.weights.end(), [](float w) { return std::isfinite(w); }))
    return "a weight of its upsampler is not finite";
  return {};
}

std::string find_source_fault(const Dictionary& d) {
  if (d.sources.size() != static_cast<std::size_t>(d.atoms())) return "it does not have one source for each atom";
  const auto within = [](std::int64_t v) { return v >= -farthest_source && v <= farthest_source; };
  for (const AtomSource& source : d.sources) {
    if (source.exemplar < -1 || source.exemplar >= static_cast<std::int64_t>(d.exemplars.size()))
      return "an atom comes from an exemplar that is not listed";
    if (!within(source.x) || !within(source.y)) return "an atom comes from beyond any raster";
    if (source.symmetry > 7) return "an atom has a symmetry that is none of the 8";
  }
  for (const std::string& name : d.exemplars)
    if (name.find('\0') != std::string::npos) return "the name of an exemplar has a zero byte";
  return {};
}

}  // namespace

std::string find_dictionary_fault(const Dictionary& d) {
  if (d.method != LearningMethod::all && d.method != LearningMethod::ksvd && d.method != LearningMethod::constrained)
    return "its learning method is none that there is";
  if (d.patch_cells < 2 || d.patch_cells > most_patch_cells || d.patch_cells % 2 != 0)
    return "its patches have " + std::to_string(d.patch_cells) + " cells a side, expected an even number from 2 to " +
           std::to_string(most_patch_cells);
  if (d.factor < 1 || d.factor > most_dictionary_factor)
    return "its factor is " + std::to_string(d.factor) + ", expected 1 to " + std::to_string(most_dictionary_factor);
  if (!is_magnitude(d.cell_size_m) || !is_magnitude(d.detail_power) || !is_magnitude(d.coarse_detail_power))
    return "its cell size or the power of its detail is no number from 0 up";
  if (std::string fault = find_atom_fault(d); !fault.empty()) return fault;
  if (d.upsampler)
    if (std::string fault = find_upsampler_fault(*d.upsampler, d.factor); !fault.empty()) return fault;
  return find_source_fault(d);
}

std::vector<std::byte> encode_dictionary(const Dictionary& d, AtomStorage storage) {
  if (const std::string fault = find_dictionary_fault(d); !fault.empty())
    throw Error(ErrorKind::input, "cannot store the dictionary: " + fault);
  SectionList list;
  list.add_integer("method", static_cast<std::int32_t>(d.method));
  list.add_integer("patch_cells", d.patch_cells);
  list.add_integer("factor", d.factor);
  list.add_number("cell_size_m", d.cell_size_m);
  list.add_number("detail_power", d.detail_power);
  list.add_number("coarse_power", d.coarse_detail_power);
  list.add("low", ElementType::f32, d.low.rows(), d.low.cols(), d.low.data());
  if (d.high.size() > 0) list.add_atoms("high", d.high, storage);
  if (d.detail.size() > 0) list.add_atoms("detail", d.detail, storage);
  if (d.upsampler)
    list.add("upsampler", ElementType::f32, d.upsampler->side() * d.upsampler->side(), d.factor * d.factor,
             d.upsampler->weights.data());
  add_sources(list, d.sources);
  std::string names;
  for (const std::string& name : d.exemplars) names += name + '\0';
  list.add_text("exemplars", names);
  list.add_text("provenance", d.provenance);
  return encode_sections(atoms_format, list.sections());
}

Dictionary decode_dictionary(std::span<const std::byte> file, const std::string& name) {
  return DictionaryDecoder(file, name).decode();
}

void write_dictionary(const std::string& path, const Dictionary& dictionary, bool overwrite, AtomStorage storage) {
  write_file_atomically(path, encode_dictionary(dictionary, storage), overwrite);
}

Dictionary read_dictionary(const std::string& path) {
  const std::vector<std::byte> start = read_file_start(path, atoms_format.magic.size());
  return decode_dictionary(begins_as_dictionary(start) ? read_file(path) : start, path);
}

std::string dictionary_digest(const Dictionary& dictionary) {
  const std::vector<std::byte> bytes = encode_dictionary(dictionary, AtomStorage::compact);
  return digest_hex(bytes.data(), bytes.size());
}

bool is_dictionary_file(const std::string& path) {
  try {
    return begins_as_dictionary(read_file_start(path, atoms_format.magic.size()));
  } catch (const Error&) {
    return false;
  }
}

}  // namespace arete
