#include "gis/mesh/obj.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <optional>

#include "core/support/error.h"
#include "gis/mesh/input_file.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/mesh_bounds.h"
#include "gis/mesh/mesh_builder.h"
#include "gis/mesh/normals.h"
#include "gis/mesh/output_file.h"
#include "gis/mesh/side_files.h"

namespace arete {
namespace fs = std::filesystem;
namespace {

void write_numbers(OutputFile& file, const char* keyword, std::initializer_list<double> values) {
  file.text(keyword);
  for (const double value : values) {
    file.text(" ");
    file.number(value);
  }
  file.text("\n");
}

/// The colours are those of the picture: no light is added to it.
void write_material(const std::string& path, const std::string& texture) {
  OutputFile file(path);
  file.text("newmtl terrain\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd " + fs::path(texture).filename().string() + "\n");
  file.close();
}

void write_vertices(OutputFile& file, const MeshSource& mesh, const MeshVertex& offset) {
  for_vertex_blocks(mesh, [&](std::int64_t, std::span<const MeshVertex> vertices) {
    for (const MeshVertex& v : vertices) write_numbers(file, "v", {v.x - offset.x, v.y - offset.y, v.z - offset.z});
  });
}

/// Texture coordinates have their origin at the lower left of the picture. As floats: 2^-24 of a picture is no pixel.
void write_texture_places(OutputFile& file, const MeshSource& mesh, const MeshBounds& box) {
  const double width = box.high.x - box.low.x, height = box.high.y - box.low.y;
  const auto place = [](double from_low, double length) { return length > 0 ? std::clamp(from_low / length, 0.0, 1.0) : 0.0; };
  for_vertex_blocks(mesh, [&](std::int64_t, std::span<const MeshVertex> vertices) {
    for (const MeshVertex& v : vertices)
      file.text("vt " + number_text(static_cast<float>(place(v.x - box.low.x, width))) + " " +
                number_text(static_cast<float>(place(v.y - box.low.y, height))) + "\n");
  });
}

void write_normals(OutputFile& file, const MeshSource& mesh, const MeshFrame& frame) {
  for (const std::array<float, 3>& n : vertex_normals(mesh, vertical_scale(frame)))
    file.text("vn " + number_text(n[0]) + " " + number_text(n[1]) + " " + number_text(n[2]) + "\n");
}

void write_faces(OutputFile& file, const MeshSource& mesh, bool texture, bool normals) {
  for_triangle_blocks(mesh, [&](std::int64_t, std::span<const MeshTriangle> triangles) {
    for (const MeshTriangle& triangle : triangles) {
      file.text("f");
      for (const std::int64_t corner : triangle) {
        file.text(" ");
        file.integer(corner + 1);
        if (texture || normals) file.text("/");
        if (texture) file.integer(corner + 1);
        if (normals) file.text("/");
        if (normals) file.integer(corner + 1);
      }
      file.text("\n");
    }
  });
}

MeshVertex read_vertex(const InputFile& file, std::string_view words) {
  const auto x = parse_number(next_word(words)), y = parse_number(next_word(words)), z = parse_number(next_word(words));
  if (!x || !y || !z) file.fail_at_line("begins with v, but three numbers do not follow");
  return {*x, *y, *z};
}

/// A corner is v, v/vt, v//vn or v/vt/vn; v counts from 1, or back from the last vertex (-1).
std::int64_t read_corner(const InputFile& file, std::string_view word, std::int64_t vertices) {
  const auto number = parse_integer(word.substr(0, word.find('/')));
  if (!number || *number == 0 || *number < -vertices)
    file.fail_at_line("names the corner '" + one_line(std::string(word.substr(0, 40))) + "'; expected the number of a vertex");
  return *number > 0 ? *number - 1 : vertices + *number;
}

MeshTriangle read_face(const InputFile& file, std::string_view words, std::int64_t vertices) {
  MeshTriangle triangle{};
  std::size_t corners = 0;
  for (std::string_view word = next_word(words); !word.empty(); word = next_word(words)) {
    if (corners < 3) triangle[corners] = read_corner(file, word, vertices);
    ++corners;
  }
  if (corners != 3)
    file.fail_at_line("holds a face with " + std::to_string(corners) + " corners; expected 3: triangulate the mesh first");
  return triangle;
}

/// Where all vertices moved together: "# offset x y z".
std::optional<MeshVertex> stated_offset(std::string_view words) {
  const auto x = parse_number(next_word(words)), y = parse_number(next_word(words)), z = parse_number(next_word(words));
  if (!x || !y || !z) return std::nullopt;
  return MeshVertex{*x, *y, *z};
}

void read_comment(std::string_view words, MeshFrame& frame, MeshVertex& offset) {
  const std::string_view keyword = next_word(words);
  if (keyword == "offset")
    offset = stated_offset(words).value_or(offset);
  else if (keyword == "vertical_unit" && !words.empty())
    parse_vertical_unit(std::string(words.substr(1)), frame);
}

}  // namespace

MeshRounding obj_rounding(const MeshBounds& bounds, const MeshWriteOptions&) {
  const MeshVertex offset = mesh_offset(bounds);
  return {
      std::max(offset_rounding(bounds.low.x, bounds.high.x, offset.x), offset_rounding(bounds.low.y, bounds.high.y, offset.y)),
      offset_rounding(bounds.low.z, bounds.high.z, offset.z)};
}

void write_obj(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options) {
  const MeshVertex offset = mesh_offset(mesh_bounds(mesh));
  const std::string name = fs::path(path).stem().string();
  OutputFile file(path);
  if (!options.title.empty()) file.text("# " + one_line(options.title) + "\n");
  file.text("# vertical_unit " + vertical_unit_text(frame) + "\n");
  write_numbers(file, "# offset", {offset.x, offset.y, offset.z});
  const bool texture = !options.texture.empty();
  if (texture) file.text("mtllib " + name + ".mtl\n");
  write_vertices(file, mesh, offset);
  if (texture) write_texture_places(file, mesh, options.texture_bounds);
  if (options.normals) write_normals(file, mesh, frame);
  if (texture) file.text("usemtl terrain\n");
  write_faces(file, mesh, texture, options.normals);
  file.close();
  if (texture) write_material((fs::path(path).parent_path() / (name + ".mtl")).string(), options.texture);
  write_offset(offset, path);
  write_prj(frame, path);
}

MeshFile read_obj(const std::string& path, const Scratch& scratch) {
  InputFile file(path);
  MeshFrame frame = read_prj(path);
  MeshVertex offset = read_offset(path);
  MeshBuilder mesh(scratch);
  while (const auto line = file.line()) {
    std::string_view words = *line;
    const std::string_view keyword = next_word(words);
    if (keyword == "v") {
      const MeshVertex v = read_vertex(file, words);
      mesh.add(MeshVertex{v.x + offset.x, v.y + offset.y, v.z + offset.z});
    } else if (keyword == "f") {
      mesh.add(read_face(file, words, mesh.vertices()));
    } else if (keyword == "#" && mesh.vertices() == 0) {
      read_comment(words, frame, offset);
    }
  }
  if (mesh.vertices() == 0) throw Error(ErrorKind::format, "'" + path + "' is no OBJ file: no line of it begins with v");
  return {mesh.finish(path), frame, "OBJ"};
}

}  // namespace arete
