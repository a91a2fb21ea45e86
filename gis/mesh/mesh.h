#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace arete {

/// A vertex of a TIN. In which plane x and y lie is said by whoever holds the mesh.
struct MeshVertex {
  double x = 0;
  double y = 0;
  double z = 0;
  bool operator==(const MeshVertex&) const = default;
};

/// Three vertices by index, counter-clockwise where x points right and y up: the normal points to the sky.
using MeshTriangle = std::array<std::int64_t, 3>;

/// A triangle mesh as it is handed from who made it to who writes, draws or checks it: counted, and read by range, so that it may be
/// larger than memory. Triangles that follow each other lie close together, and so do the vertices that they name.
class MeshSource {
 public:
  virtual ~MeshSource() = default;
  virtual std::int64_t vertices() const = 0;
  virtual std::int64_t triangles() const = 0;
  /// Vertices [first, first + out.size()). Several threads may read. Throws Error{disk} where it cannot be read.
  virtual void read_vertices(std::int64_t first, std::span<MeshVertex> out) const = 0;
  virtual void read_triangles(std::int64_t first, std::span<MeshTriangle> out) const = 0;
};

/// The least and the greatest coordinates of vertices.
struct MeshBounds {
  MeshVertex low;
  MeshVertex high;
};

/// Where the coordinates of a mesh lie on Earth: x east, y north (longitude, latitude; or geocentric X, Y, Z), z up.
struct MeshFrame {
  std::string crs_wkt;              ///< WKT2, with the vertical part; empty where unknown
  std::string vertical_unit = "m";  ///< of z
  double metres_per_unit = 1;       ///< one unit of z in metres
};

}  // namespace arete
