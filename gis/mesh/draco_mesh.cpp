// Draco by Google, https://google.github.io/draco/spec/; in glTF by KHR_draco_mesh_compression.
#include "gis/mesh/draco_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <exception>
#include <memory>

#include <draco/compression/config/compression_shared.h>
#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <draco/metadata/geometry_metadata.h>
#include <draco/metadata/metadata_decoder.h>

#include "core/support/error.h"

namespace arete {
namespace {

constexpr int position_bits = 23;
constexpr int normal_bits = 10;
constexpr int texture_bits = 16;

/// A flat grid takes next to no bytes per triangle, so the size of a stream bounds its counts only from here on (100 MB decoded).
constexpr std::uint64_t always_decoded = std::uint64_t{1} << 22;
constexpr std::uint64_t most_per_byte = 64;

template <std::size_t N>
int add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, const std::vector<std::array<float, N>>& values) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, N, draco::DT_FLOAT32, false, N * sizeof(float), 0);
  const int id = mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(values.size()));
  for (std::uint32_t i = 0; i < values.size(); ++i) mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), values[i].data());
  return id;
}

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw Error(ErrorKind::input, where + " holds no readable Draco mesh: " + what + "; get it again");
}

/// What the stream says that it holds, before anything is allocated for it (Draco bitstream specification, sections 3 to 6).
std::uint64_t stated_count(std::span<const std::byte> bytes, const std::string& where) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) fail(where, "it has no header of Draco");
  if (header.version_major != 2 || header.version_minor < 2 || header.encoder_type != draco::TRIANGULAR_MESH)
    fail(where, "expected a triangle mesh in the bitstream 2.2, found kind " + std::to_string(header.encoder_type) + " in " +
                    std::to_string(header.version_major) + '.' + std::to_string(header.version_minor));
  buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(header.version_major, header.version_minor));
  if ((header.flags & METADATA_FLAG_MASK) != 0) {
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) fail(where, "its metadata is cut off");
  }
  std::uint8_t traversal = 0;
  std::uint32_t first = 0, second = 0;
  if ((header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING && !buffer.Decode(&traversal)) || !draco::DecodeVarint(&first, &buffer) ||
      !draco::DecodeVarint(&second, &buffer))
    fail(where, "it ends within its header");
  return std::max(first, second);
}

}  // namespace

DracoMesh encode_draco(const MeshArrays& arrays, float reach) {
  assert(reach >= 16);  // Draco passes the range on as text of six decimals
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(arrays.positions.size()));
  DracoMesh result;
  result.position_id = add_attribute(mesh, draco::GeometryAttribute::POSITION, arrays.positions);
  if (!arrays.normals.empty()) result.normal_id = add_attribute(mesh, draco::GeometryAttribute::NORMAL, arrays.normals);
  if (!arrays.texture.empty()) result.texture_id = add_attribute(mesh, draco::GeometryAttribute::TEX_COORD, arrays.texture);
  mesh.SetNumFaces(arrays.indices.size() / 3);
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i)
    mesh.SetFace(draco::FaceIndex(i), {draco::PointIndex(arrays.indices[3 * i]), draco::PointIndex(arrays.indices[3 * i + 1]),
                                       draco::PointIndex(arrays.indices[3 * i + 2])});

  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetTrackEncodedProperties(true);
  // range / (2^23 - 1) is the step, exactly: all that the quantiser computes in float32 is then exact.
  const float origin[] = {-reach, -reach, -reach};
  const float step = std::ldexp(reach, 1 - position_bits);
  encoder.SetAttributeExplicitQuantization(result.position_id, position_bits, 3, origin, step * ((1 << position_bits) - 1));
  if (!arrays.normals.empty()) encoder.SetAttributeQuantization(result.normal_id, normal_bits);
  if (!arrays.texture.empty()) encoder.SetAttributeQuantization(result.texture_id, texture_bits);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeToBuffer(&buffer);
  if (!status.ok()) throw Error(ErrorKind::format, "Draco cannot compress the mesh: " + status.error_msg_string() + "; write it without");
  const auto bytes = std::as_bytes(std::span<const char>(buffer.data(), buffer.size()));
  result.bytes.assign(bytes.begin(), bytes.end());
  result.vertices = static_cast<std::int64_t>(encoder.num_encoded_points());
  result.triangles = static_cast<std::int64_t>(encoder.num_encoded_faces());
  return result;
}

MeshArrays decode_draco(std::span<const std::byte> bytes, int position_id, const std::string& where) {
  const std::uint64_t count = stated_count(bytes, where);
  if (count > std::max(always_decoded, most_per_byte * bytes.size()))
    fail(where, std::to_string(bytes.size()) + " bytes state " + std::to_string(count) + " triangles");
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) fail(where, decoded.status().error_msg_string());
  const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
  const draco::PointAttribute* positions = mesh->GetAttributeByUniqueId(static_cast<std::uint32_t>(position_id));
  if (positions == nullptr || positions->num_components() != 3) fail(where, "it has no attribute " + std::to_string(position_id) + " of three");

  MeshArrays arrays;
  arrays.positions.resize(mesh->num_points());
  for (std::uint32_t i = 0; i < mesh->num_points(); ++i) {
    const draco::AttributeValueIndex value = positions->mapped_index(draco::PointIndex(i));
    if (value.value() >= positions->size() || !positions->ConvertValue<float, 3>(value, arrays.positions[i].data()))
      fail(where, "position " + std::to_string(i) + " is missing");
  }
  for (std::uint32_t i = 0; i < mesh->num_faces(); ++i)
    for (const draco::PointIndex& corner : mesh->face(draco::FaceIndex(i))) {
      if (corner.value() >= mesh->num_points()) fail(where, "triangle " + std::to_string(i) + " names a vertex that is not there");
      arrays.indices.push_back(corner.value());
    }
  return arrays;
}

}  // namespace arete
