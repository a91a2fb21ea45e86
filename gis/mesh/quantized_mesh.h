#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace arete {

/// What a tile covers, in degrees on WGS 84.
struct TileRectangle {
  double west = 0, south = 0, east = 0, north = 0;
};

/// A tile of level `level` in the scheme of Cesium's terrain (TMS, EPSG:4326): level 0 has two columns and one row, each level more halves
/// them; columns run from 180 W eastwards, rows from the south pole northwards.
TileRectangle terrain_tile_rectangle(int level, std::int64_t x, std::int64_t y);

/// Of u, v and height: the far side of the tile, the maximum height.
inline constexpr int quantized_end = 32767;

/// A tile of terrain in the format quantized-mesh-1.0. Source: https://github.com/CesiumGS/quantized-mesh
struct QuantizedMesh {
  std::array<double, 3> centre{};   ///< geocentric metres (EPSG:4978)
  float minimum_m = 0;              ///< height where `height` is 0
  float maximum_m = 0;              ///< height where `height` is 32767
  std::array<double, 3> sphere{};   ///< centre of a sphere about all vertices, geocentric metres
  double radius_m = 0;              ///< of that sphere
  std::array<double, 3> horizon{};  ///< where it is below the horizon all of the tile is; geocentric, in radii of the ellipsoid
  std::vector<std::uint16_t> u, v, height;  ///< of each vertex, 0..32767: from west to east, south to north, low to high
  std::vector<std::uint32_t> triangles;     ///< three vertices each, counter-clockwise seen from above
  std::vector<std::uint32_t> west, south, east, north;  ///< the vertices on each side
  std::vector<std::uint8_t> normals;        ///< two bytes per vertex (oct-encoded, extension 1); empty: none

  std::int64_t vertices() const { return static_cast<std::int64_t>(u.size()); }
  /// Exact where the range of heights is 32767 times a power of two.
  double height_m(std::size_t vertex) const {
    return minimum_m + height[vertex] * ((static_cast<double>(maximum_m) - minimum_m) / quantized_end);
  }
};

/// Puts vertices in the order in which triangles first name them, as the format's indices need, and drops those that none names.
/// Lists of sides are cleared.
void sort_by_use(QuantizedMesh& mesh);

/// Sets what follows from the vertices and where the tile lies: centre, sphere, horizon point and the lists of the sides, each along
/// its side from south to north or west to east.
void place_quantized_mesh(QuantizedMesh& mesh, const TileRectangle& rectangle);

/// The bytes of a tile; indices of 32 bits where there are more than 65536 vertices. Throws Error{format} where vertices do not stand
/// in the order of their use, or 65536 of them leave no code of 16 bits for the first.
std::vector<std::byte> encode_quantized_mesh(const QuantizedMesh& mesh);

/// The inverse. Extensions but normals are skipped. Safe for any bytes: memory is allocated in proportion to them. Throws Error{input}
/// where they end early, go on after the last extension, or name a vertex that is not there; `name` stands for the file.
QuantizedMesh decode_quantized_mesh(std::span<const std::byte> bytes, const std::string& name);

/// A unit vector as two bytes, and back. Source: Cigolle et al., A Survey of Efficient Representations for Independent Unit Vectors,
/// JCGT 3(2), 2014: oct encoding with 8 bits and unsigned components.
std::array<std::uint8_t, 2> oct_encode(const std::array<double, 3>& normal);
std::array<double, 3> oct_decode(std::uint8_t x, std::uint8_t y);

}  // namespace arete
