#include "gis/mesh/ply.h"

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "core/support/error.h"
#include "gis/mesh/input_file.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/mesh_builder.h"
#include "gis/mesh/normals.h"
#include "gis/mesh/output_file.h"
#include "gis/mesh/side_files.h"

namespace arete {
namespace {

constexpr std::int64_t most_vertices = std::int64_t{1} << 32;
constexpr int most_header_lines = 10000;

enum class Encoding { text, little, big };

/// A type of numbers: its width in bytes, and what the bytes mean.
struct Type {
  std::size_t bytes = 0;
  enum { natural, integer, real } kind = natural;
};

struct Property {
  std::string name;
  Type type;
  std::optional<Type> list;  // of the count before a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
  MeshFrame frame;
};

std::optional<Type> type_of(std::string_view name) {
  if (name == "char" || name == "int8") return Type{1, Type::integer};
  if (name == "uchar" || name == "uint8") return Type{1, Type::natural};
  if (name == "short" || name == "int16") return Type{2, Type::integer};
  if (name == "ushort" || name == "uint16") return Type{2, Type::natural};
  if (name == "int" || name == "int32") return Type{4, Type::integer};
  if (name == "uint" || name == "uint32") return Type{4, Type::natural};
  if (name == "float" || name == "float32") return Type{4, Type::real};
  if (name == "double" || name == "float64") return Type{8, Type::real};
  return std::nullopt;
}

Property read_property(const InputFile& file, std::string_view words) {
  const auto type = [&] {
    const std::string_view name = next_word(words);
    const auto found = type_of(name);
    if (!found)
      file.fail_at_line("names the type '" + one_line(std::string(name)) +
                        "'; expected one of char uchar short ushort int uint float double");
    return *found;
  };
  Property property;
  std::string_view rest = words;
  if (next_word(rest) == "list") {
    words = rest;
    property.list = type();
    if (property.list->kind == Type::real) file.fail_at_line("counts a list with a real number");
  }
  property.type = type();
  property.name = next_word(words);
  if (property.name.empty()) file.fail_at_line("holds a property without a name");
  return property;
}

Encoding read_encoding(const InputFile& file, std::string_view name) {
  if (name == "ascii") return Encoding::text;
  if (name == "binary_little_endian") return Encoding::little;
  if (name == "binary_big_endian") return Encoding::big;
  file.fail_at_line("names the format '" + one_line(std::string(name)) +
                    "'; expected ascii, binary_little_endian or binary_big_endian");
}

/// The bytes, or in text the characters with their blanks, that an element takes at least.
std::uint64_t least_bytes(const Element& element, Encoding encoding) {
  std::uint64_t bytes = 0;
  for (const Property& property : element.properties)
    bytes += encoding == Encoding::text ? 2 : property.list ? property.list->bytes : property.type.bytes;
  return bytes;
}

Header read_header(InputFile& file) {
  if (file.line() != "ply") throw Error(ErrorKind::format, "'" + file.path() + "' is no PLY file: its first line is not 'ply'");
  Header header;
  header.frame = read_prj(file.path());
  bool formatted = false;
  for (int lines = 0;; ++lines) {
    const auto line = file.line();
    if (!line || lines == most_header_lines)
      throw Error(ErrorKind::input,
                  "'" + file.path() + "' is damaged: its header has no end_header in " + std::to_string(lines) + " lines");
    std::string_view words = *line;
    const std::string_view keyword = next_word(words);
    if (keyword == "end_header") break;
    if (keyword == "format") {
      header.encoding = read_encoding(file, next_word(words));
      formatted = true;
    } else if (keyword == "element") {
      Element element;
      element.name = next_word(words);
      const auto count = parse_integer(next_word(words));
      if (!count || *count < 0)
        file.fail_at_line("counts no elements: expected 'element " + one_line(element.name) + " <count>'");
      element.count = static_cast<std::uint64_t>(*count);
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty()) file.fail_at_line("holds a property before the first element");
      header.elements.back().properties.push_back(read_property(file, words));
    } else if (keyword == "comment" && next_word(words) == "vertical_unit" && !words.empty()) {
      parse_vertical_unit(std::string(words.substr(1)), header.frame);
    }
  }
  if (!formatted) throw Error(ErrorKind::input, "'" + file.path() + "' is damaged: its header states no format");
  for (const Element& element : header.elements) {
    const std::uint64_t least = least_bytes(element, header.encoding);
    // The last word of a text needs no blank behind it.
    if (least > 0 && element.count > (file.left() + 1) / least)
      throw Error(ErrorKind::input, "'" + file.path() + "' is damaged: its header counts " + std::to_string(element.count) +
                                        " elements '" + one_line(element.name) + "', but " + std::to_string(file.left()) +
                                        " bytes follow; get it again");
  }
  return header;
}

/// The values of the elements, one after the other.
class Values {
 public:
  Values(InputFile& file, Encoding encoding) : file_(file), encoding_(encoding) {}

  double real(const Type& type) {
    if (encoding_ == Encoding::text) return text();
    const std::uint64_t bits = raw(type.bytes);
    if (type.kind != Type::real) return static_cast<double>(signed_value(type, bits));
    const double value = type.bytes == 4 ? std::bit_cast<float>(static_cast<std::uint32_t>(bits)) : std::bit_cast<double>(bits);
    return value;
  }

  /// Nullopt where it is no whole number in the range of indices.
  std::optional<std::int64_t> index(const Type& type) {
    if (encoding_ != Encoding::text && type.kind != Type::real) return signed_value(type, raw(type.bytes));
    const double value = real(type);
    if (!(std::abs(value) < 0x1p53) || value != std::trunc(value)) return std::nullopt;
    return static_cast<std::int64_t>(value);
  }

  void skip(const Property& property) {
    std::uint64_t count = 1;
    if (property.list) count = length(*property.list);
    if (encoding_ != Encoding::text) return file_.skip(count * property.type.bytes, "a value");
    for (; count > 0; --count) file_.word("a number");
  }

  std::uint64_t length(const Type& type) {
    const auto count = index(type);
    if (!count || *count < 0) file_.fail_at_byte("ends the count of a list, which is no count");
    return static_cast<std::uint64_t>(*count);
  }

 private:
  double text() {
    const std::string_view word = file_.word("a number");
    const auto value = parse_number(word);
    if (!value)
      file_.fail_at_byte("ends the word '" + one_line(std::string(word.substr(0, 40))) + "' where a number was expected");
    return *value;
  }

  std::uint64_t raw(std::size_t bytes) {
    const std::span<const std::byte> data = file_.take(bytes, "a value");
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < bytes; ++i) {
      const std::size_t place = encoding_ == Encoding::little ? bytes - 1 - i : i;
      bits = bits << 8 | static_cast<std::uint64_t>(data[place]);
    }
    return bits;
  }

  static std::int64_t signed_value(const Type& type, std::uint64_t bits) {
    if (type.kind == Type::natural || type.bytes == 8) return static_cast<std::int64_t>(bits);
    const unsigned shift = static_cast<unsigned>(64 - 8 * type.bytes);
    return static_cast<std::int64_t>(bits << shift) >> shift;
  }

  InputFile& file_;
  Encoding encoding_;
};

void read_vertices(InputFile& file, Values& values, const Element& element, MeshBuilder& mesh) {
  std::vector<int> axes;  // per property: 0, 1, 2, or -1
  int found = 0;
  for (const Property& property : element.properties) {
    const int axis = property.list ? -1 : property.name == "x" ? 0 : property.name == "y" ? 1 : property.name == "z" ? 2 : -1;
    axes.push_back(axis);
    if (axis >= 0) found |= 1 << axis;
  }
  if (found != 7) throw Error(ErrorKind::input, "'" + file.path() + "' is damaged: its vertices have no x, y and z");
  for (std::uint64_t i = 0; i < element.count; ++i) {
    std::array<double, 3> place{};
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (axes[p] < 0)
        values.skip(element.properties[p]);
      else
        place[static_cast<std::size_t>(axes[p])] = values.real(element.properties[p].type);
    }
    if (!std::isfinite(place[0]) || !std::isfinite(place[1]) || !std::isfinite(place[2]))
      file.fail_at_byte("ends vertex " + std::to_string(i) + ", which has a coordinate that is no finite number");
    mesh.add(MeshVertex{place[0], place[1], place[2]});
  }
}

MeshTriangle read_triangle(InputFile& file, Values& values, const Property& property, std::uint64_t face) {
  const std::uint64_t corners = values.length(*property.list);
  if (corners != 3)
    file.fail_at_byte("begins face " + std::to_string(face) + " with " + std::to_string(corners) +
                      " corners; expected 3: triangulate the mesh first");
  MeshTriangle triangle{};
  for (std::int64_t& corner : triangle) {
    const auto index = values.index(property.type);
    if (!index || *index < 0) file.fail_at_byte("ends a vertex index of face " + std::to_string(face) + ", which is none");
    corner = *index;
  }
  return triangle;
}

void read_faces(InputFile& file, Values& values, const Element& element, MeshBuilder& mesh) {
  std::optional<std::size_t> corners;
  for (std::size_t p = 0; p < element.properties.size(); ++p)
    if (element.properties[p].list &&
        (element.properties[p].name == "vertex_indices" || element.properties[p].name == "vertex_index"))
      corners = p;
  if (!corners) throw Error(ErrorKind::input, "'" + file.path() + "' is damaged: its faces have no list vertex_indices");
  for (std::uint64_t i = 0; i < element.count; ++i)
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (p == *corners)
        mesh.add(read_triangle(file, values, element.properties[p], i));
      else
        values.skip(element.properties[p]);
    }
}

void skip_elements(Values& values, const Element& element) {
  if (element.properties.empty()) return;
  for (std::uint64_t i = 0; i < element.count; ++i)
    for (const Property& property : element.properties) values.skip(property);
}

void write_header(OutputFile& file, const MeshSource& mesh, const MeshFrame& frame, const MeshWriteOptions& options) {
  file.text("ply\nformat binary_little_endian 1.0\n");
  if (!options.title.empty()) file.text("comment " + one_line(options.title) + "\n");
  file.text("comment vertical_unit " + vertical_unit_text(frame) + "\nelement vertex " + std::to_string(mesh.vertices()) + "\n");
  for (const char* name : {"x", "y", "z"}) file.text("property double " + std::string(name) + "\n");
  if (options.normals)
    for (const char* name : {"nx", "ny", "nz"}) file.text("property float " + std::string(name) + "\n");
  const bool beyond_int = mesh.vertices() > std::int64_t{std::numeric_limits<std::int32_t>::max()} + 1;
  file.text("element face " + std::to_string(mesh.triangles()) + "\nproperty list uchar " + (beyond_int ? "uint" : "int") +
            " vertex_indices\nend_header\n");
}

}  // namespace

MeshRounding ply_rounding(const MeshBounds&, const MeshWriteOptions&) { return {}; }

void write_ply(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options) {
  if (mesh.vertices() > most_vertices)
    throw Error(ErrorKind::format, "cannot write '" + path + "': PLY holds 4294967296 vertices, the mesh has " +
                                       std::to_string(mesh.vertices()) + "; use a larger error or write it in parts");
  const std::vector<std::array<float, 3>> normals =
      options.normals ? vertex_normals(mesh, vertical_scale(frame)) : std::vector<std::array<float, 3>>();
  OutputFile file(path);
  write_header(file, mesh, frame, options);
  for_vertex_blocks(mesh, [&](std::int64_t first, std::span<const MeshVertex> vertices) {
    for (const MeshVertex& vertex : vertices) {
      file.binary(vertex.x);
      file.binary(vertex.y);
      file.binary(vertex.z);
      if (options.normals) file.binary(normals[static_cast<std::size_t>(first)]);
      ++first;
    }
  });
  for_triangle_blocks(mesh, [&](std::int64_t, std::span<const MeshTriangle> triangles) {
    for (const MeshTriangle& triangle : triangles) {
      file.binary(std::uint8_t{3});
      for (const std::int64_t corner : triangle) file.binary(static_cast<std::uint32_t>(corner));
    }
  });
  file.close();
  write_prj(frame, path);
}

MeshFile read_ply(const std::string& path, const Scratch& scratch) {
  InputFile file(path);
  const Header header = read_header(file);
  MeshBuilder mesh(scratch);
  Values values(file, header.encoding);
  for (const Element& element : header.elements) {
    if (element.name == "vertex" && mesh.vertices() == 0)
      read_vertices(file, values, element, mesh);
    else if (element.name == "face")
      read_faces(file, values, element, mesh);
    else
      skip_elements(values, element);
  }
  return {mesh.finish(path), header.frame, "PLY"};
}

}  // namespace arete
