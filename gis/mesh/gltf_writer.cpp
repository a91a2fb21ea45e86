// glTF 2.0 specification, https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html. On coordinates of the Earth in glTF:
// github.com/KhronosGroup/glTF issue 1610, github.com/PDAL/PDAL issue 3005.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include <nlohmann/json.hpp>
#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "core/support/file.h"
#include "gis/gdal_errors.h"
#include "gis/mesh/draco_mesh.h"
#include "gis/mesh/gltf.h"
#include "gis/mesh/gltf_grid.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/mesh_bounds.h"
#include "gis/mesh/normals.h"
#include "gis/mesh/output_file.h"
#include "gis/mesh/vertex_cache.h"

namespace arete {
namespace {

using Json = nlohmann::ordered_json;

/// Indices of 16 bits name so many; 65,535 itself restarts a primitive.
constexpr std::size_t most_vertices = 65535;
/// Of all nodes that are being filled, 100 MB: fixed, as the memory given must not change the file.
constexpr std::size_t most_held = std::size_t{1} << 20;
constexpr double greatest_coordinate = 1 << 27;
constexpr std::uint64_t most_glb_bytes = std::numeric_limits<std::uint32_t>::max();
constexpr int array_buffer = 34962, element_array_buffer = 34963;
constexpr int unsigned_short = 5123, float32 = 5126;
constexpr int clamp_to_edge = 33071, linear = 9729, linear_mipmap_linear = 9987;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw Error(ErrorKind::format, "cannot write '" + path + "': " + why);
}

/// One unit of x and y in metres, and what the axes are.
struct Horizontal {
  double metres_per_unit = 1;
  bool geocentric = false;
};

Horizontal horizontal_of(const MeshFrame& frame, const std::string& path) {
  const GdalErrors quiet;
  OGRSpatialReference crs;
  if (frame.crs_wkt.empty() || crs.importFromWkt(frame.crs_wkt.c_str()) != OGRERR_NONE) return {};
  if (crs.IsGeographic())
    refuse(path, "glTF is in metres, and the mesh is in longitude and latitude; project it first, or write it geocentric");
  const double metres = crs.IsProjected() || crs.IsGeocentric() ? crs.GetLinearUnits() : 1;
  return {std::isfinite(metres) && metres > 0 ? metres : 1, crs.IsGeocentric() != 0};
}

/// A vertex on the grid, in steps from the offset.
struct Corner {
  std::array<std::int64_t, 3> place{};
  std::array<float, 3> normal{};
};

using Cell = std::array<std::int64_t, 3>;

struct PlaceHash {
  std::size_t operator()(const std::array<std::int64_t, 3>& p) const {
    std::uint64_t hash = 0;
    for (const std::int64_t n : p) hash = (hash ^ static_cast<std::uint64_t>(n)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
    return hash;
  }
};

/// A node that is being filled.
struct Node {
  MeshArrays arrays;
  std::unordered_map<std::array<std::int64_t, 3>, std::uint32_t, PlaceHash> index_of;
};

/// The binary part: bytes at the end of a file or of memory, counted.
class Bytes {
 public:
  Bytes(std::function<void(std::span<const std::byte>)> append, std::uint64_t limit, std::string path)
      : append_(std::move(append)), limit_(limit), path_(std::move(path)) {}
  std::uint64_t size() const { return size_; }
  /// Pads to a multiple of 4 behind the bytes.
  void add(std::span<const std::byte> bytes) {
    static constexpr std::array<std::byte, 3> zeros{};
    const std::size_t padding = (4 - bytes.size() % 4) % 4;
    if (bytes.size() + padding > limit_ - size_) refuse_size(path_);
    append_(bytes);
    append_(std::span(zeros).first(padding));
    size_ += bytes.size() + padding;
  }
  [[noreturn]] static void refuse_size(const std::string& path) {
    refuse(path, "a .glb holds 4 GiB, and the mesh takes more; write .gltf, compress it, or allow a larger error");
  }

 private:
  std::function<void(std::span<const std::byte>)> append_;
  std::uint64_t limit_;
  std::string path_;
  std::uint64_t size_ = 0;
};

std::string image_type(std::span<const std::byte> bytes, const std::string& path) {
  const auto begins = [&](std::initializer_list<unsigned char> start) {
    return bytes.size() > start.size() && std::equal(start.begin(), start.end(), bytes.begin(), [](unsigned char a, std::byte b) { return std::byte{a} == b; });
  };
  if (begins({0x89, 'P', 'N', 'G'})) return "image/png";
  if (begins({0xff, 0xd8, 0xff})) return "image/jpeg";
  throw Error(ErrorKind::input, "cannot use '" + path + "' as a texture: glTF takes PNG and JPEG, and it is neither");
}

class Writer {
 public:
  Writer(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options, Bytes& bytes)
      : mesh_(mesh), frame_(frame), path_(path), options_(options), horizontal_(horizontal_of(frame, path)), bytes_(bytes) {
    if (!(std::isfinite(frame.metres_per_unit) && frame.metres_per_unit > 0)) refuse(path, "the unit of its elevations is no number of metres above 0");
  }

  /// Adds all to the bytes and returns the JSON, in which the buffer has no uri.
  Json write() {
    const MeshBounds bounds = mesh_bounds(mesh_);
    for (const double c : {bounds.low.x, bounds.low.y, bounds.low.z, bounds.high.x, bounds.high.y, bounds.high.z})
      if (!(std::abs(c) <= greatest_coordinate)) refuse(path_, "a coordinate is beyond +-2^27 units, or no number");
    grid_ = gltf_grid(bounds, options_.compress);
    start_document();
    if (options_.normals) normals_ = vertex_normals(mesh_, 1);
    VertexCache vertices(mesh_);
    for_triangle_blocks(mesh_, [&](std::int64_t, std::span<const MeshTriangle> triangles) {
      for (const MeshTriangle& t : triangles) add({corner(vertices, t[0]), corner(vertices, t[1]), corner(vertices, t[2])});
    });
    for (auto& [cell, node] : open_) close(cell, node);
    return finish_document();
  }

 private:
  using Triangle = std::array<Corner, 3>;

  Corner corner(VertexCache& vertices, std::int64_t index) {
    const MeshVertex& v = vertices[index];
    const std::array<double, 3> c{v.x, v.y, v.z};
    Corner result;
    for (std::size_t a = 0; a < 3; ++a) {
      // NaN passes by the comparisons of the bounds.
      if (!std::isfinite(c[a])) refuse(path_, "a coordinate is no number");
      result.place[a] = std::llround((c[a] - grid_.axes[a].offset) / grid_.axes[a].step);
    }
    if (!normals_.empty()) result.normal = normals_[static_cast<std::size_t>(index)];
    return result;
  }

  std::int64_t reach_steps() const { return options_.compress ? std::int64_t{1} << 22 : std::int64_t{1} << 24; }

  /// The larger of its extents along the axes that are in cells.
  std::int64_t length(const Corner& a, const Corner& b) const {
    std::int64_t longest = 0;
    for (std::size_t i = 0; i < 3; ++i)
      if (grid_.axes[i].in_cells) longest = std::max(longest, std::abs(a.place[i] - b.place[i]));
    return longest;
  }

  /// Depends on the two ends alone, in either order: both triangles at an edge halve it at the same place.
  static Corner middle(const Corner& a, const Corner& b) {
    Corner m;
    double norm = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      m.place[i] = (a.place[i] + b.place[i]) >> 1;
      m.normal[i] = a.normal[i] + b.normal[i];
      norm += double{m.normal[i]} * m.normal[i];
    }
    if (norm > 0)
      for (float& n : m.normal) n = static_cast<float>(n / std::sqrt(norm));
    return m;
  }

  void add(const Triangle& t) {
    if (t[0].place == t[1].place || t[1].place == t[2].place || t[2].place == t[0].place) return;
    const std::array<std::int64_t, 3> lengths{length(t[0], t[1]), length(t[1], t[2]), length(t[2], t[0])};
    const std::size_t i = static_cast<std::size_t>(std::max_element(lengths.begin(), lengths.end()) - lengths.begin());
    if (lengths[i] > reach_steps()) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      const Corner m = middle(t[i], t[j]);
      add({t[i], m, t[k]});
      add({m, t[j], t[k]});
      return;
    }
    Cell cell{};
    for (std::size_t a = 0; a < 3; ++a)
      if (grid_.axes[a].in_cells) cell[a] = floor_divide(std::min({t[0].place[a], t[1].place[a], t[2].place[a]}), reach_steps());
    put(cell, t);
  }

  static std::int64_t floor_divide(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

  void put(const Cell& cell, const Triangle& t) {
    Node& node = open_[cell];
    if (node.arrays.positions.size() + 3 > most_vertices) {
      close(cell, node);
      node = {};
    }
    for (const Corner& c : t) {
      const auto [found, fresh] = node.index_of.try_emplace(c.place, static_cast<std::uint32_t>(node.arrays.positions.size()));
      node.arrays.indices.push_back(found->second);
      if (fresh) append(node.arrays, cell, c);
    }
    if (held_ > most_held) close_fullest();
  }

  void append(MeshArrays& arrays, const Cell& cell, const Corner& c) {
    std::array<float, 3> p;
    for (std::size_t a = 0; a < 3; ++a) p[a] = static_cast<float>(static_cast<double>(c.place[a] - centre(cell, a)) * grid_.axes[a].step);
    arrays.positions.push_back({p[0], p[2], 0 - p[1]});
    if (!normals_.empty()) arrays.normals.push_back({c.normal[0], c.normal[2], 0 - c.normal[1]});
    if (!options_.texture.empty()) {
      const MeshBounds& b = options_.texture_bounds;
      const double x = grid_.axes[0].offset + static_cast<double>(c.place[0]) * grid_.axes[0].step;
      const double y = grid_.axes[1].offset + static_cast<double>(c.place[1]) * grid_.axes[1].step;
      arrays.texture.push_back({static_cast<float>((x - b.low.x) / (b.high.x - b.low.x)), static_cast<float>((b.high.y - y) / (b.high.y - b.low.y))});
    }
    ++held_;
  }

  /// In steps from the offset. A triangle begins in its cell and ends at most one cell further: it lies within one reach of the
  /// border between the two.
  std::int64_t centre(const Cell& cell, std::size_t axis) const { return grid_.axes[axis].in_cells ? (cell[axis] + 1) * reach_steps() : 0; }

  void close_fullest() {
    const auto fullest = std::max_element(open_.begin(), open_.end(), [](const auto& a, const auto& b) {
      return a.second.arrays.positions.size() < b.second.arrays.positions.size();
    });
    close(fullest->first, fullest->second);
    open_.erase(fullest);
  }

  void close(const Cell& cell, const Node& node) {
    held_ -= node.arrays.positions.size();
    std::array<double, 3> t;
    for (std::size_t a = 0; a < 3; ++a) t[a] = static_cast<double>(centre(cell, a)) * grid_.axes[a].step;
    Json primitive = options_.compress ? compressed(node.arrays) : plain(node.arrays);
    primitive["material"] = 0;
    document_["nodes"].push_back({{"mesh", document_["meshes"].size()}, {"translation", {t[0], t[2], 0 - t[1]}}});
    document_["meshes"].push_back({{"primitives", Json::array({primitive})}});
  }

  template <class T>
  std::size_t add_view(const std::vector<T>& values, int target) {
    const std::uint64_t start = bytes_.size();
    bytes_.add(std::as_bytes(std::span<const T>(values)));
    Json view{{"buffer", 0}, {"byteOffset", start}, {"byteLength", values.size() * sizeof(T)}};
    if (target != 0) view["target"] = target;
    document_["bufferViews"].push_back(std::move(view));
    return document_["bufferViews"].size() - 1;
  }

  /// An accessor; without bytes of its own where `view` is null.
  std::size_t add_accessor(const Json& view, int component, std::int64_t count, const char* type) {
    Json accessor = Json::object();
    if (!view.is_null()) accessor["bufferView"] = view;
    accessor["componentType"] = component;
    accessor["count"] = count;
    accessor["type"] = type;
    document_["accessors"].push_back(std::move(accessor));
    return document_["accessors"].size() - 1;
  }

  void state_bounds(std::size_t accessor, const MeshArrays& arrays) {
    std::array<float, 3> low = arrays.positions.front(), high = low;
    for (const auto& p : arrays.positions)
      for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
    document_["accessors"][accessor]["min"] = low;
    document_["accessors"][accessor]["max"] = high;
  }

  Json plain(const MeshArrays& arrays) {
    const auto count = std::ssize(arrays.positions);
    Json attributes{{"POSITION", add_accessor(add_view(arrays.positions, array_buffer), float32, count, "VEC3")}};
    state_bounds(attributes["POSITION"], arrays);
    if (!arrays.normals.empty()) attributes["NORMAL"] = add_accessor(add_view(arrays.normals, array_buffer), float32, count, "VEC3");
    if (!arrays.texture.empty()) attributes["TEXCOORD_0"] = add_accessor(add_view(arrays.texture, array_buffer), float32, count, "VEC2");
    const std::vector<std::uint16_t> indices(arrays.indices.begin(), arrays.indices.end());
    const std::size_t accessor = add_accessor(add_view(indices, element_array_buffer), unsigned_short, std::ssize(indices), "SCALAR");
    return {{"attributes", attributes}, {"indices", accessor}};
  }

  Json compressed(const MeshArrays& arrays) {
    const DracoMesh draco = encode_draco(arrays, static_cast<float>(grid_.axes[0].reach));
    Json attributes{{"POSITION", add_accessor(nullptr, float32, draco.vertices, "VEC3")}}, ids{{"POSITION", draco.position_id}};
    state_bounds(attributes["POSITION"], arrays);
    if (!arrays.normals.empty()) {
      attributes["NORMAL"] = add_accessor(nullptr, float32, draco.vertices, "VEC3");
      ids["NORMAL"] = draco.normal_id;
    }
    if (!arrays.texture.empty()) {
      attributes["TEXCOORD_0"] = add_accessor(nullptr, float32, draco.vertices, "VEC2");
      ids["TEXCOORD_0"] = draco.texture_id;
    }
    const int component = draco.vertices <= static_cast<std::int64_t>(most_vertices) ? unsigned_short : 5125;
    const std::size_t accessor = add_accessor(nullptr, component, 3 * draco.triangles, "SCALAR");
    const std::size_t view = add_view(draco.bytes, 0);
    return {{"attributes", attributes},
            {"indices", accessor},
            {"extensions", {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", ids}}}}}};
  }

  /// The nodes above those of the mesh: what scales units to metres, where they are none, and what moves the mesh to its place.
  void start_document() {
    const double h = horizontal_.metres_per_unit, v = horizontal_.geocentric ? h : frame_.metres_per_unit;
    const auto& axes = grid_.axes;
    const std::array<double, 3> offset{axes[0].offset, axes[1].offset, axes[2].offset};
    document_ = {{"asset", {{"version", "2.0"}, {"generator", "Arete"}}}};
    if (options_.compress) {
      document_["extensionsUsed"] = {"KHR_draco_mesh_compression"};
      document_["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    }
    document_["scene"] = 0;
    document_["scenes"] = Json::array({{{"nodes", {0}}}});
    Json root = Json::object();
    if (!options_.title.empty()) root["name"] = options_.title;
    Json& about = root["extras"]["georeference"];
    about["crs_wkt"] = frame_.crs_wkt;
    about["vertical_unit"] = frame_.vertical_unit;
    about["metres_per_unit"] = frame_.metres_per_unit;
    about["unit_metres"] = {h, h, v};
    about["offset"] = offset;
    about["axes"] = horizontal_.geocentric ? "x = geocentric X, y = geocentric Z, z = -geocentric Y" : "x = east, y = up, z = -north";
    const Json translation{offset[0], offset[2], 0 - offset[1]};
    document_["nodes"] = Json::array();
    if (h == 1 && v == 1) {
      root["translation"] = translation;
      document_["nodes"].push_back(root);
    } else {
      root["scale"] = {h, v, h};
      root["children"] = {1};
      document_["nodes"].push_back(root);
      document_["nodes"].push_back({{"translation", translation}});
    }
    document_["meshes"] = document_["accessors"] = document_["bufferViews"] = Json::array();
    Json material{{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}};
    if (!options_.texture.empty()) {
      const std::vector<std::byte> picture = read_file(options_.texture);
      const std::string type = image_type(picture, options_.texture);
      document_["images"] = Json::array({{{"bufferView", add_view(picture, 0)}, {"mimeType", type}}});
      document_["samplers"] = Json::array({{{"magFilter", linear}, {"minFilter", linear_mipmap_linear}, {"wrapS", clamp_to_edge}, {"wrapT", clamp_to_edge}}});
      document_["textures"] = Json::array({{{"sampler", 0}, {"source", 0}}});
      material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
    }
    document_["materials"] = Json::array({material});
  }

  Json finish_document() {
    Json& nodes = document_["nodes"];
    const std::size_t above = nodes[0].contains("children") ? 2 : 1;
    Json children = Json::array();
    for (std::size_t i = above; i < nodes.size(); ++i) children.push_back(i);
    // Empty arrays are not allowed.
    if (!children.empty()) nodes[above - 1]["children"] = children;
    for (const char* name : {"meshes", "accessors", "bufferViews"})
      if (document_[name].empty()) document_.erase(name);
    if (bytes_.size() > 0) document_["buffers"] = Json::array({{{"byteLength", bytes_.size()}}});
    return std::move(document_);
  }

  const MeshSource& mesh_;
  const MeshFrame& frame_;
  const std::string& path_;
  const MeshWriteOptions& options_;
  Horizontal horizontal_;
  Bytes& bytes_;
  GltfGrid grid_;
  std::vector<std::array<float, 3>> normals_;
  std::map<Cell, Node> open_;
  std::size_t held_ = 0;  ///< vertices in open nodes
  Json document_;
};

std::string text_of(const Json& document) { return document.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// A name as a URI: all but letters, digits and -._~ by their bytes (RFC 3986).
std::string uri_of(const std::string& name) {
  static constexpr char hex[] = "0123456789ABCDEF";
  std::string uri;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || std::string("-._~").find(c) != std::string::npos;
    uri += plain ? std::string(1, c) : std::string{'%', hex[byte / 16], hex[byte % 16]};
  }
  return uri;
}

void write_two_files(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options) {
  const std::filesystem::path side = std::filesystem::path(path).replace_extension(".bin");
  OutputFile binary(side.string());
  Bytes bytes([&](std::span<const std::byte> added) { binary.write(added); }, std::uint64_t{1} << 53, path);
  Json document = Writer(mesh, frame, path, options, bytes).write();
  binary.close();
  if (document.contains("buffers")) document["buffers"][0]["uri"] = uri_of(side.filename().string());
  OutputFile file(path);
  file.text(text_of(document));
  file.close();
}

void write_one_file(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options) {
  const std::uint64_t per_vertex = 12 + (options.normals ? 12 : 0) + (options.texture.empty() ? 0 : 8);
  const double least = static_cast<double>(mesh.vertices()) * static_cast<double>(per_vertex) + 6.0 * static_cast<double>(mesh.triangles());
  if (!options.compress && least > static_cast<double>(most_glb_bytes)) Bytes::refuse_size(path);

  const std::string folder = std::filesystem::path(path).parent_path().string();
  ScratchBytes binary({options.memory_bytes, folder.empty() ? "." : folder}, options.memory_bytes / 4);
  Bytes bytes([&](std::span<const std::byte> added) { binary.append(added); }, most_glb_bytes, path);
  std::string text = text_of(Writer(mesh, frame, path, options, bytes).write());
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::uint64_t binary_chunk = bytes.size() == 0 ? 0 : 8 + bytes.size();
  const std::uint64_t total = 12 + 8 + text.size() + binary_chunk;
  if (total > most_glb_bytes) Bytes::refuse_size(path);

  OutputFile file(path);
  const auto word = [&](std::uint64_t value) { file.binary(static_cast<std::uint32_t>(value)); };
  file.text("glTF");
  word(2);
  word(total);
  word(text.size());
  file.text("JSON");
  file.text(text);
  if (binary_chunk > 0) {
    word(bytes.size());
    file.text(std::string_view("BIN\0", 4));
    std::vector<std::byte> block(std::size_t{1} << 20);
    for (std::uint64_t at = 0; at < binary.size(); at += block.size()) {
      const auto part = std::span(block).first(static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), binary.size() - at)));
      binary.read(at, part);
      file.write(part);
    }
  }
  file.close();
}

}  // namespace

MeshRounding gltf_rounding(const MeshBounds& bounds, const MeshWriteOptions& options) {
  const GltfGrid grid = gltf_grid(bounds, options.compress);
  return {std::max(grid.axes[0].step, grid.axes[1].step) / 2, grid.axes[2].step / 2};
}

void write_gltf(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  (extension == ".gltf" ? write_two_files : write_one_file)(mesh, frame, path, options);
}

}  // namespace arete
