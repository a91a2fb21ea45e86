#include "gis/mesh/dxf.h"

#include <ogrsf_frmts.h>

#include <array>
#include <cmath>

#include "core/support/error.h"
#include "gis/gdal_errors.h"
#include "gis/mesh/input_file.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/mesh_bounds.h"
#include "gis/mesh/output_file.h"
#include "gis/mesh/side_files.h"
#include "gis/mesh/vertex_cache.h"
#include "gis/mesh/weld_vertices.h"

namespace arete {
namespace {

/// R12 allows 255 characters in a line.
constexpr std::size_t longest_comment = 250;

/// Group codes 10 + i, 20 + i, 30 + i: x, y and z of corner i.
void write_point(OutputFile& file, int i, const MeshVertex& v) {
  int axis = 0;
  for (const double value : {v.x, v.y, v.z}) {
    file.integer(10 * ++axis + i);
    file.text("\n");
    file.number(value);
    file.text("\n");
  }
}

void write_header(OutputFile& file, const MeshBounds& bounds, const std::string& title) {
  if (!title.empty()) file.text("999\n" + one_line(title).substr(0, longest_comment) + "\n");
  file.text("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$EXTMIN\n");
  write_point(file, 0, bounds.low);
  file.text("9\n$EXTMAX\n");
  write_point(file, 0, bounds.high);
  file.text("0\nENDSEC\n0\nSECTION\n2\nENTITIES\n");
}

/// What the triangles of a drawing go to.
struct Faces {
  const std::string& path;
  MeshBuilder& mesh;
  VertexWelder& welder;
  std::int64_t seen = 0;
};

void add_polygon(const OGRPolygon& polygon, Faces& faces) {
  if (!polygon.Is3D() || polygon.IsEmpty()) return;
  const OGRLinearRing& ring = *polygon.getExteriorRing();
  ++faces.seen;
  const int points = ring.getNumPoints();
  if (points != 4 || !ring.get_IsClosed() || polygon.getNumInteriorRings() > 0)
    throw Error(ErrorKind::input, "'" + faces.path + "': face " + std::to_string(faces.seen) + " of the drawing has " +
                                      std::to_string(points - 1) + " corners; expected 3: triangulate the mesh first");
  MeshTriangle triangle{};
  for (int i = 0; i < 3; ++i) {
    const MeshVertex v = {ring.getX(i), ring.getY(i), ring.getZ(i)};
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
      throw Error(ErrorKind::input, "'" + faces.path + "' is damaged: face " + std::to_string(faces.seen) +
                                        " has a coordinate that is no finite number");
    triangle[static_cast<std::size_t>(i)] = faces.welder.index_of(v);
  }
  faces.mesh.add(triangle);
}

/// 3DFACE is a polygon, a polyface mesh a polyhedral surface, a block a collection.
void add_faces(const OGRGeometry& geometry, Faces& faces) {
  const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbPolygon || type == wkbTriangle) {
    add_polygon(*geometry.toPolygon(), faces);
  } else if (OGR_GT_IsSubClassOf(type, wkbPolyhedralSurface)) {
    for (const OGRPolygon* patch : *geometry.toPolyhedralSurface()) add_polygon(*patch, faces);
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) {
    for (const OGRGeometry* part : *geometry.toGeometryCollection()) add_faces(*part, faces);
  }
}

/// GDAL takes a drawing that breaks off between two entities for a whole one.
void check_end(const std::string& path) {
  InputFile file(path);
  constexpr std::uint64_t tail = 32;
  if (file.size() > tail) file.skip(file.size() - tail, "the drawing");
  if (file.peek(tail).find("EOF") == std::string_view::npos)
    throw Error(ErrorKind::input, "'" + path + "' is damaged, or no text DXF: it does not end with EOF; get it again");
}

}  // namespace

MeshRounding dxf_rounding(const MeshBounds&, const MeshWriteOptions&) { return {}; }

void write_dxf(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options) {
  const MeshBounds bounds = mesh_bounds(mesh);
  VertexCache vertices(mesh);
  OutputFile file(path);
  write_header(file, bounds, options.title);
  for_triangle_blocks(mesh, [&](std::int64_t, std::span<const MeshTriangle> triangles) {
    for (const MeshTriangle& triangle : triangles) {
      file.text("0\n3DFACE\n8\nTIN\n");
      for (int i = 0; i < 4; ++i) write_point(file, i, vertices[triangle[static_cast<std::size_t>(std::min(i, 2))]]);
    }
  });
  file.text("0\nENDSEC\n0\nEOF\n");
  file.close();
  write_prj(frame, path);
}

MeshFile read_dxf(const std::string& path, const Scratch& scratch) {
  check_end(path);
  const GdalErrors errors;
  const char* const drivers[] = {"DXF", nullptr};
  const GDALDatasetUniquePtr drawing(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, drivers));
  if (!drawing || drawing->GetLayerCount() == 0)
    throw Error(ErrorKind::format, "'" + path + "' is no DXF file" + errors.suffix());
  MeshBuilder mesh(scratch);
  VertexWelder welder(mesh);
  Faces faces{path, mesh, welder};
  for (const OGRFeatureUniquePtr& feature : *drawing->GetLayer(0))
    if (const OGRGeometry* geometry = feature->GetGeometryRef()) add_faces(*geometry, faces);
  if (errors.failed()) throw Error(ErrorKind::input, "'" + path + "' is damaged" + errors.suffix());
  if (faces.seen == 0) throw Error(ErrorKind::format, "'" + path + "' holds no three-dimensional faces (3DFACE)");
  return {mesh.finish(path), read_prj(path), "DXF"};
}

}  // namespace arete
