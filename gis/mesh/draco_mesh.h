#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace arete {

/// The arrays of a mesh as graphics cards take them. Normals and texture coordinates are empty or one per position.
struct MeshArrays {
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<float, 3>> normals;
  std::vector<std::array<float, 2>> texture;
  std::vector<std::uint32_t> indices;  ///< three per triangle
};

/// A mesh in the bitstream of Draco 2.2, and what it is to be called in a file that holds it.
struct DracoMesh {
  std::vector<std::byte> bytes;
  std::int64_t vertices = 0, triangles = 0;  ///< as they will be decoded: in another order
  int position_id = 0, normal_id = 0, texture_id = 0;
};

/// Positions are multiples of `step` from -reach to reach - step, where reach = 2^22 steps and is a power of
/// two from 16 on; they come back exactly. Normals are rounded
/// to 10 bits, texture coordinates to 16 of their range.
DracoMesh encode_draco(const MeshArrays& arrays, float reach);

/// The positions and indices of a Draco mesh of whoever made it; position_id is the unique id of the attribute. Throws Error{input},
/// beginning with `where`, for bytes that are none.
MeshArrays decode_draco(std::span<const std::byte> bytes, int position_id, const std::string& where);

}  // namespace arete
