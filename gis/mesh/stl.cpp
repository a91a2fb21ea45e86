#include "gis/mesh/stl.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/support/error.h"
#include "gis/mesh/input_file.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/mesh_bounds.h"
#include "gis/mesh/output_file.h"
#include "gis/mesh/side_files.h"
#include "gis/mesh/vertex_cache.h"
#include "gis/mesh/weld_vertices.h"

namespace arete {
namespace {

constexpr std::size_t header_bytes = 80;
constexpr std::size_t facet_bytes = 50;
constexpr std::int64_t most_triangles = std::numeric_limits<std::uint32_t>::max();
constexpr std::string_view offset_mark = "Arete; offset ";

using Floats = std::array<float, 3>;

Floats local(const MeshVertex& v, const MeshVertex& offset) {
  return {static_cast<float>(v.x - offset.x), static_cast<float>(v.y - offset.y), static_cast<float>(v.z - offset.z)};
}

/// Of the triangle as it is stored; zeros where it has no area, as the specification allows.
Floats facet_normal(const std::array<Floats, 3>& corners) {
  std::array<double, 3> u{}, v{};
  for (std::size_t i = 0; i < 3; ++i) {
    u[i] = double{corners[1][i]} - double{corners[0][i]};
    v[i] = double{corners[2][i]} - double{corners[0][i]};
  }
  const std::array<double, 3> n = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(length > 0) || !std::isfinite(length)) return {0, 0, 0};
  return {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length), static_cast<float>(n[2] / length)};
}

/// 80 bytes. They must not begin with "solid": that would be the text format.
std::array<char, header_bytes> header_of(const MeshVertex& offset) {
  const std::string text =
      std::string(offset_mark) + number_text(offset.x) + " " + number_text(offset.y) + " " + number_text(offset.z);
  std::array<char, header_bytes> header;
  header.fill(' ');
  std::copy_n(text.begin(), std::min(text.size(), header.size()), header.begin());
  return header;
}

/// The offset that our header states; false where the header is of another program.
bool stated_offset(std::string_view header, MeshVertex& offset) {
  if (!header.starts_with(offset_mark)) return false;
  header.remove_prefix(offset_mark.size());
  const auto x = parse_number(next_word(header)), y = parse_number(next_word(header)), z = parse_number(next_word(header));
  if (!x || !y || !z) return false;
  offset = {*x, *y, *z};
  return true;
}

double axis_rounding(double low, double high, double offset) {
  const auto largest = static_cast<float>(std::max(std::abs(low - offset), std::abs(high - offset)));
  if (largest == 0) return 0;
  const double ulp = double{std::nextafter(largest, std::numeric_limits<float>::infinity())} - double{largest};
  // The difference is rounded to float32, and the sum, which is no double in general, to one as large as the coordinate.
  const double size = std::max(std::abs(low), std::abs(high));
  const double sum = offset == 0 ? 0 : std::nextafter(size, std::numeric_limits<double>::infinity()) - size;
  return ulp / 2 + sum;
}

void read_binary(InputFile& file, const MeshVertex& offset, std::uint64_t count, VertexWelder& welder, MeshBuilder& mesh) {
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::span<const std::byte> facet = file.take(facet_bytes, "a triangle");
    MeshTriangle triangle{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Floats v{};
      std::memcpy(v.data(), facet.data() + 12 * (corner + 1), sizeof v);
      if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2]))
        file.fail_at_byte("ends triangle " + std::to_string(i) + ", which has a coordinate that is no finite number");
      triangle[corner] = welder.index_of({v[0] + offset.x, v[1] + offset.y, v[2] + offset.z});
    }
    mesh.add(triangle);
  }
}

/// Facets of text: three lines "vertex x y z" each; the lines between them say nothing more.
void read_text(InputFile& file, const MeshVertex& offset, VertexWelder& welder, MeshBuilder& mesh) {
  MeshTriangle triangle{};
  std::size_t corners = 0;
  bool ended = false;
  while (const auto line = file.line()) {
    std::string_view words = *line;
    const std::string_view keyword = next_word(words);
    ended = keyword == "endsolid" || (ended && keyword.empty());
    if (keyword == "vertex") {
      const auto x = parse_number(next_word(words)), y = parse_number(next_word(words)), z = parse_number(next_word(words));
      if (!x || !y || !z) file.fail_at_line("begins with vertex, but three numbers do not follow");
      if (corners == 3) file.fail_at_line("holds the fourth corner of a facet; expected 3");
      triangle[corners++] = welder.index_of({*x + offset.x, *y + offset.y, *z + offset.z});
    } else if (keyword == "endfacet") {
      if (corners != 3) file.fail_at_line("ends a facet with " + std::to_string(corners) + " corners; expected 3");
      mesh.add(triangle);
      corners = 0;
    }
  }
  if (!ended) file.fail_at_line("is the last, but it is not endsolid; get the file again");
}

}  // namespace

MeshRounding stl_rounding(const MeshBounds& bounds, const MeshWriteOptions&) {
  const MeshVertex offset = mesh_offset(bounds);
  return {std::max(axis_rounding(bounds.low.x, bounds.high.x, offset.x), axis_rounding(bounds.low.y, bounds.high.y, offset.y)),
          axis_rounding(bounds.low.z, bounds.high.z, offset.z)};
}

void write_stl(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions&) {
  if (mesh.triangles() > most_triangles)
    throw Error(ErrorKind::format, "cannot write '" + path + "': STL holds 4294967295 triangles, the mesh has " +
                                       std::to_string(mesh.triangles()) + "; use a larger error or another format");
  const MeshVertex offset = mesh_offset(mesh_bounds(mesh));
  VertexCache vertices(mesh);
  OutputFile file(path);
  file.binary(header_of(offset));
  file.binary(static_cast<std::uint32_t>(mesh.triangles()));
  for_triangle_blocks(mesh, [&](std::int64_t, std::span<const MeshTriangle> triangles) {
    for (const MeshTriangle& triangle : triangles) {
      std::array<Floats, 3> corners;
      for (std::size_t i = 0; i < 3; ++i) corners[i] = local(vertices[triangle[i]], offset);
      file.binary(facet_normal(corners));
      file.binary(corners);
      file.binary(std::uint16_t{0});
    }
  });
  file.close();
  write_offset(offset, path);
  write_prj(frame, path);
}

MeshFile read_stl(const std::string& path, const Scratch& scratch) {
  InputFile file(path);
  MeshVertex offset = read_offset(path);
  MeshBuilder mesh(scratch);
  VertexWelder welder(mesh);
  const std::string start(file.peek(header_bytes + 4));
  std::uint32_t count = 0;
  if (start.size() == header_bytes + 4) std::memcpy(&count, start.data() + header_bytes, sizeof count);
  const std::uint64_t expected = header_bytes + 4 + std::uint64_t{count} * facet_bytes;
  // The text format begins with "solid"; so do the headers of some binary files, which have the size that they state.
  if (start.size() == header_bytes + 4 && file.size() == expected) {
    stated_offset(std::string_view(start).substr(0, header_bytes), offset);
    file.skip(header_bytes + 4, "the header");
    read_binary(file, offset, count, welder, mesh);
  } else if (start.starts_with("solid")) {
    read_text(file, offset, welder, mesh);
  } else {
    throw Error(ErrorKind::input, "'" + path + "' is damaged, or no STL file: it has " + std::to_string(file.size()) +
                                      " bytes, its header counts " + std::to_string(count) + " triangles, which take " +
                                      std::to_string(expected) + "; get it again");
  }
  return {mesh.finish(path), read_prj(path), "STL"};
}

}  // namespace arete
