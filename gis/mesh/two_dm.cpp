#include "gis/mesh/two_dm.h"

#include <algorithm>
#include <array>

#include "core/support/error.h"
#include "gis/mesh/input_file.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/mesh_builder.h"
#include "gis/mesh/output_file.h"
#include "gis/mesh/side_files.h"

namespace arete {
namespace {

/// Elements that are no triangles with straight sides, as the specification names them.
constexpr std::array<std::string_view, 7> other_elements = {"E2L", "E3L", "E4Q", "E6T", "E8Q", "E9Q", "E5Q"};

/// The nodes, their numbers, and what the comments say. Elements may come before the nodes that they name.
void read_nodes(InputFile& file, MeshBuilder& mesh, PointNumbers& numbers, MeshFrame& frame) {
  while (const auto line = file.line()) {
    std::string_view words = *line;
    const std::string_view card = next_word(words);
    if (card == "ND") {
      const auto number = parse_integer(next_word(words));
      const auto x = parse_number(next_word(words)), y = parse_number(next_word(words)), z = parse_number(next_word(words));
      if (!number || !x || !y || !z) file.fail_at_line("is no node: expected ND, a number, and x y z");
      if (!numbers.add(*number)) file.fail_at_line("gives the node " + std::to_string(*number) + " a second time");
      mesh.add(MeshVertex{*x, *y, *z});
    } else if (card == "#" && next_word(words) == "vertical_unit" && !words.empty()) {
      parse_vertical_unit(std::string(words.substr(1)), frame);
    }
  }
}

void read_elements(InputFile& file, MeshBuilder& mesh, const PointNumbers& numbers) {
  while (const auto line = file.line()) {
    std::string_view words = *line;
    const std::string_view card = next_word(words);
    if (std::find(other_elements.begin(), other_elements.end(), card) != other_elements.end())
      file.fail_at_line("holds an element " + std::string(card) + "; expected triangles E3T: triangulate the mesh first");
    if (card != "E3T") continue;
    const auto number = parse_integer(next_word(words));
    MeshTriangle triangle{};
    for (std::int64_t& corner : triangle) {
      const auto node = parse_integer(next_word(words));
      if (!number || !node) file.fail_at_line("is no element: expected E3T, a number, and three nodes");
      corner = numbers.place_of(*node);
      if (corner < 0) file.fail_at_line("names the node " + std::to_string(*node) + ", which there is not");
    }
    mesh.add(triangle);
  }
}

}  // namespace

MeshRounding two_dm_rounding(const MeshBounds&, const MeshWriteOptions&) { return {}; }

void write_2dm(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options) {
  OutputFile file(path);
  file.text("MESH2D\nNUM_MATERIALS_PER_ELEM 1\n");
  if (!options.title.empty()) {
    std::string title = one_line(options.title);
    std::replace(title.begin(), title.end(), '"', '\'');
    file.text("MESHNAME \"" + title + "\"\n");
  }
  if (frame.metres_per_unit != 1) file.text("# vertical_unit " + vertical_unit_text(frame) + "\n");
  for_triangle_blocks(mesh, [&](std::int64_t first, std::span<const MeshTriangle> triangles) {
    for (const MeshTriangle& triangle : triangles) {
      file.text("E3T ");
      file.integer(++first);
      for (const std::int64_t corner : triangle) {
        file.text(" ");
        file.integer(corner + 1);
      }
      file.text(" 1\n");  // the material
    }
  });
  for_vertex_blocks(mesh, [&](std::int64_t first, std::span<const MeshVertex> vertices) {
    for (const MeshVertex& v : vertices) {
      file.text("ND ");
      file.integer(++first);
      for (const double value : {v.x, v.y, v.z}) {
        file.text(" ");
        file.number(value);
      }
      file.text("\n");
    }
  });
  file.close();
  write_prj(frame, path);
}

MeshFile read_2dm(const std::string& path, const Scratch& scratch) {
  MeshBuilder mesh(scratch);
  PointNumbers numbers;
  MeshFrame frame = read_prj(path);
  {
    InputFile file(path);
    std::string_view first = file.line().value_or("");
    if (next_word(first) != "MESH2D")
      throw Error(ErrorKind::format, "'" + path + "' is no 2DM file: its first line is not MESH2D");
    read_nodes(file, mesh, numbers, frame);
  }
  InputFile file(path);
  read_elements(file, mesh, numbers);
  return {mesh.finish(path), frame, "2DM"};
}

}  // namespace arete
