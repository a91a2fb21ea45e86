// glTF 2.0 specification, https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html. Read from the file by range, not by tinygltf:
// that holds all buffers in memory, refuses indices that are in Draco only, and reads past the end of damaged files (2.7.0).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include <cpl_string.h>
#include <nlohmann/json.hpp>

#include "core/support/error.h"
#include "core/support/file.h"
#include "gis/mesh/draco_mesh.h"
#include "gis/mesh/gltf.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/mesh_builder.h"
#include "gis/mesh/weld_vertices.h"

namespace arete {
namespace {

using Json = nlohmann::json;

/// Deeper than any glTF is, and shallow enough for every stack.
constexpr int deepest_json = 100;
constexpr std::size_t deepest_node = 1000;
/// Below 2^53, so that sums of a few do not overflow.
constexpr std::uint64_t greatest_count = std::uint64_t{1} << 53;
/// A small file that places one mesh over and over would make a mesh without end.
constexpr std::uint64_t instances = 64;
constexpr int triangles_mode = 4;
constexpr int unsigned_byte = 5121, unsigned_short = 5123, unsigned_int = 5125, float32 = 5126;

/// A row-major affine transform: x' = m[0] x + m[1] y + m[2] z + m[3].
using Transform = std::array<std::array<double, 4>, 3>;
constexpr Transform identity{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

Transform operator*(const Transform& a, const Transform& b) {
  Transform c;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t k = 0; k < 4; ++k) c[r][k] = a[r][0] * b[0][k] + a[r][1] * b[1][k] + a[r][2] * b[2][k] + (k == 3 ? a[r][3] : 0);
  return c;
}

bool mirrors(const Transform& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
         0;
}

/// Bytes of a buffer: a range of a file, or what a data URI held.
struct Buffer {
  std::string path;  ///< empty: in memory
  std::uint64_t start = 0, size = 0;
  std::vector<std::byte> memory;
};

/// Elements of an accessor, in a buffer.
struct Elements {
  std::size_t buffer = 0;
  std::uint64_t start = 0, count = 0, stride = 0, size = 0;
  int component = 0;
};

class Reader {
 public:
  Reader(const std::string& path, const Scratch& scratch) : path_(path), mesh_(scratch), welder_(mesh_) {}

  MeshFile read() {
    load();
    check_extensions();
    find_buffers();
    walk();
    MeshFile file;
    file.frame = frame_;
    file.format = "glTF";
    file.mesh = mesh_.finish(path_);
    return file;
  }

 private:
  [[noreturn]] void damaged(const std::string& what) const { throw Error(ErrorKind::input, "'" + path_ + "' is damaged: " + what + "; get it again"); }
  [[noreturn]] void unsupported(const std::string& what) const { throw Error(ErrorKind::format, "cannot read '" + path_ + "': " + what); }

  // JSON, member by member.

  static const Json* find(const Json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
  }
  std::uint64_t count(const Json& object, const char* key, std::optional<std::uint64_t> otherwise = {}) const {
    const Json* value = find(object, key);
    if (value == nullptr && otherwise) return *otherwise;
    if (value == nullptr || !value->is_number_unsigned() || value->get<std::uint64_t>() > greatest_count)
      damaged(std::string("expected a count as \"") + key + "\", found " + (value == nullptr ? "none" : shown(*value)));
    return value->get<std::uint64_t>();
  }
  static std::string shown(const Json& value) { return value.dump(-1, ' ', true, Json::error_handler_t::replace).substr(0, 40); }
  static std::string text(const Json& object, const char* key, const std::string& otherwise = "") {
    const Json* value = find(object, key);
    return value != nullptr && value->is_string() ? value->get<std::string>() : otherwise;
  }
  const Json& item(const char* list, std::uint64_t index) const {
    const Json* all = find(document_, list);
    if (all == nullptr || !all->is_array() || index >= all->size())
      damaged(std::string("it names number ") + std::to_string(index) + " of its " + list + ", which is not there");
    return (*all)[index];
  }
  template <std::size_t N>
  std::array<double, N> numbers(const Json& object, const char* key, const std::array<double, N>& otherwise) const {
    const Json* value = find(object, key);
    if (value == nullptr) return otherwise;
    std::array<double, N> result;
    if (!value->is_array() || value->size() != N) damaged(std::string("expected ") + std::to_string(N) + " numbers as \"" + key + "\", found " + shown(*value));
    for (std::size_t i = 0; i < N; ++i) {
      if (!(*value)[i].is_number()) damaged(std::string("expected numbers as \"") + key + "\", found " + shown(*value));
      result[i] = (*value)[i].get<double>();
    }
    return result;
  }

  // The file and what it holds.

  void load() {
    const std::vector<std::byte> start = read_file_start(path_, 20);
    std::error_code unknown;
    const std::uint64_t size = std::filesystem::file_size(path_, unknown);
    const bool binary = start.size() >= 4 && std::memcmp(start.data(), "glTF", 4) == 0;
    if (!binary) return parse(read_file(path_));
    const auto word = [&](std::size_t at) {
      std::uint32_t value;
      std::memcpy(&value, start.data() + at, 4);
      return std::uint64_t{value};
    };
    if (start.size() < 20) damaged("it ends within its header, after " + std::to_string(start.size()) + " bytes");
    if (word(4) != 2) unsupported("it is glTF " + std::to_string(word(4)) + "; glTF 2 is read");
    if (unknown || word(8) != size) damaged("its header states " + std::to_string(word(8)) + " bytes, it has " + std::to_string(size));
    const std::uint64_t json = word(12);
    if (std::memcmp(start.data() + 16, "JSON", 4) != 0 || json > size - 20) damaged("its JSON part is not where it ought to be");
    std::vector<std::byte> head = read_file_start(path_, 20 + json + 8);
    if (head.size() < 20 + json) damaged("it ends within its JSON part");
    if (head.size() == 20 + json + 8) {
      std::uint32_t length;
      std::memcpy(&length, head.data() + 20 + json, 4);
      if (length > size - (20 + json + 8) || std::memcmp(head.data() + 24 + json, "BIN", 4) != 0)
        damaged("its binary part states " + std::to_string(length) + " bytes, " + std::to_string(size - (20 + json + 8)) + " follow");
      binary_ = Buffer{path_, 20 + json + 8, length, {}};
    }
    head.resize(20 + json);
    head.erase(head.begin(), head.begin() + 20);
    parse(head);
  }

  void parse(const std::vector<std::byte>& bytes) {
    const char* start = reinterpret_cast<const char*>(bytes.data());
    const auto guard = [&](int depth, Json::parse_event_t, Json&) {
      if (depth > deepest_json) damaged("its JSON is nested more than " + std::to_string(deepest_json) + " deep");
      return true;
    };
    try {
      document_ = Json::parse(start, start + bytes.size(), guard);
    } catch (const Json::exception& e) {
      damaged(std::string("its JSON cannot be read: ") + e.what());
    }
    const Json* asset = find(document_, "asset");
    if (asset == nullptr || find(*asset, "version") == nullptr) unsupported("it is no glTF: it has no \"asset\" with a version");
    if (text(*asset, "version").rfind("2.", 0) != 0) unsupported("it is glTF " + shown(*find(*asset, "version")) + "; glTF 2 is read");
  }

  void check_extensions() const {
    static const std::set<std::string> harmless = {"KHR_draco_mesh_compression", "KHR_materials_unlit", "KHR_texture_transform"};
    const Json* required = find(document_, "extensionsRequired");
    if (required == nullptr || !required->is_array()) return;
    for (const Json& name : *required)
      if (!name.is_string() || harmless.count(name.get<std::string>()) == 0)
        unsupported("it requires the extension " + shown(name) + ", which is not known here; write it without");
  }

  void find_buffers() {
    const Json* buffers = find(document_, "buffers");
    if (buffers == nullptr || !buffers->is_array()) return;
    for (const Json& buffer : *buffers) {
      const std::uint64_t length = count(buffer, "byteLength");
      all_bytes_ += length;
      buffers_.push_back(find(buffer, "uri") == nullptr ? binary_ : outside(text(buffer, "uri")));
      if (length > buffers_.back().size)
        damaged("a buffer states " + std::to_string(length) + " bytes, it has " + std::to_string(buffers_.back().size));
    }
  }

  Buffer outside(const std::string& uri) const {
    Buffer buffer;
    if (uri.rfind("data:", 0) == 0) {
      const std::size_t comma = uri.find(";base64,");
      if (comma == std::string::npos) unsupported("a buffer is in a data URI that is not in base64");
      std::vector<GByte> text(uri.begin() + static_cast<std::ptrdiff_t>(comma) + 8, uri.end());
      text.push_back(0);
      buffer.size = static_cast<std::uint64_t>(std::max(0, CPLBase64DecodeInPlace(text.data())));
      const auto bytes = std::as_bytes(std::span<const GByte>(text)).first(buffer.size);
      buffer.memory.assign(bytes.begin(), bytes.end());
      return buffer;
    }
    char* plain = CPLUnescapeString(uri.c_str(), nullptr, CPLES_URL);
    const std::filesystem::path name = plain;
    CPLFree(plain);
    // Only what lies beside the file or below: a file from elsewhere does not choose what is read here.
    if (name.empty() || name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end() || uri.find(':') != std::string::npos)
      unsupported("its buffer is '" + uri + "'; buffers are read from files beside it");
    buffer.path = (std::filesystem::path(path_).parent_path() / name).string();
    std::error_code missing;
    if (!std::filesystem::is_regular_file(buffer.path, missing))
      throw Error(ErrorKind::input, "cannot read '" + path_ + "': there is no file '" + buffer.path + "', which holds its coordinates");
    buffer.size = std::filesystem::file_size(buffer.path, missing);
    return buffer;
  }

  /// The range of a buffer view, which lies inside its buffer.
  Elements view(std::uint64_t index) const {
    const Json& view = item("bufferViews", index);
    Elements e;
    e.buffer = count(view, "buffer");
    if (e.buffer >= buffers_.size()) damaged("a view names buffer " + std::to_string(e.buffer) + " of " + std::to_string(buffers_.size()));
    e.start = count(view, "byteOffset", 0);
    e.count = count(view, "byteLength");
    e.stride = count(view, "byteStride", 0);
    if (e.start + e.count > buffers_[e.buffer].size)
      damaged("view " + std::to_string(index) + " ends at byte " + std::to_string(e.start + e.count) + " of a buffer of " +
              std::to_string(buffers_[e.buffer].size));
    return e;
  }

  Elements elements(std::uint64_t index, const char* type, std::uint64_t components) const {
    const Json& accessor = item("accessors", index);
    if (find(accessor, "sparse") != nullptr || find(accessor, "bufferView") == nullptr)
      unsupported("accessor " + std::to_string(index) + " is sparse or without values");
    if (text(accessor, "type") != type) damaged("accessor " + std::to_string(index) + " is no " + type);
    Elements e = view(count(accessor, "bufferView"));
    const std::uint64_t available = e.count, offset = count(accessor, "byteOffset", 0);
    e.component = static_cast<int>(std::min<std::uint64_t>(count(accessor, "componentType"), 10000));
    e.size = components * (e.component == unsigned_byte ? 1 : e.component == unsigned_short ? 2 : 4);
    e.count = count(accessor, "count");
    if (e.stride == 0) e.stride = e.size;
    if (e.stride < e.size || e.stride > 252 || e.count > available || (e.count > 0 && offset + (e.count - 1) * e.stride + e.size > available))
      damaged("accessor " + std::to_string(index) + " states " + std::to_string(e.count) + " elements, more than its view holds");
    e.start += offset;
    return e;
  }

  void read_bytes(std::size_t index, std::uint64_t at, std::span<std::byte> to) {
    const Buffer& buffer = buffers_[index];
    if (to.empty()) return;
    read_ += to.size();
    if (read_ > instances * all_bytes_) unsupported("it places its meshes more than " + std::to_string(instances) + " times each; write them out");
    if (buffer.path.empty()) return void(std::memcpy(to.data(), buffer.memory.data() + at, to.size()));
    if (opened_ != buffer.path) {
      stream_ = std::ifstream(buffer.path, std::ios::binary);
      opened_ = buffer.path;
    }
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(buffer.start + at));
    if (!stream_.read(reinterpret_cast<char*>(to.data()), static_cast<std::streamsize>(to.size())))
      throw Error(ErrorKind::disk, "cannot read '" + buffer.path + "' at byte " + std::to_string(buffer.start + at));
  }

  /// visit(element) for each, its bytes at the start.
  template <class Visit>
  void for_each(const Elements& e, const Visit& visit) {
    std::vector<std::byte> block;
    for (std::uint64_t first = 0; first < e.count; first += mesh_block) {
      const std::uint64_t n = std::min<std::uint64_t>(mesh_block, e.count - first);
      block.resize((n - 1) * e.stride + e.size);
      read_bytes(e.buffer, e.start + first * e.stride, block);
      for (std::uint64_t i = 0; i < n; ++i) visit(block.data() + i * e.stride);
    }
  }

  // The scene.

  struct Placed {
    std::uint64_t node;
    Transform above;
    std::size_t depth;
  };

  void walk() {
    const Json* nodes = find(document_, "nodes");
    if (nodes == nullptr || !nodes->is_array()) return;
    const std::vector<std::uint64_t> roots = scene_roots(*nodes);
    for (const std::uint64_t root : roots) read_frame(item("nodes", root));
    std::vector<bool> seen(nodes->size());
    std::vector<Placed> open;
    for (auto root = roots.rbegin(); root != roots.rend(); ++root) open.push_back({*root, identity, 0});
    while (!open.empty()) {
      const Placed placed = open.back();
      open.pop_back();
      const Json& node = item("nodes", placed.node);
      if (seen[placed.node] || placed.depth > deepest_node) damaged("node " + std::to_string(placed.node) + " has more than one parent");
      seen[placed.node] = true;
      Transform here = local(node);
      // From metres to the units of the mesh, before sums: 0.3048 / 0.3048 is 1, exactly.
      if (placed.depth == 0)
        for (std::size_t r = 0; r < 3; ++r)
          for (double& m : here[r]) m /= unit_[r];
      here = placed.above * here;
      if (find(node, "mesh") != nullptr) add_mesh(item("meshes", count(node, "mesh")), here);
      const std::vector<std::uint64_t> children = indices(node, "children");
      for (auto child = children.rbegin(); child != children.rend(); ++child) open.push_back({*child, here, placed.depth + 1});
    }
  }

  std::vector<std::uint64_t> indices(const Json& object, const char* key) const {
    std::vector<std::uint64_t> result;
    const Json* list = find(object, key);
    if (list == nullptr) return result;
    if (!list->is_array()) damaged(std::string("expected a list as \"") + key + "\", found " + shown(*list));
    for (const Json& index : *list) {
      if (!index.is_number_unsigned()) damaged(std::string("expected numbers of nodes as \"") + key + "\", found " + shown(index));
      result.push_back(index.get<std::uint64_t>());
    }
    return result;
  }

  std::vector<std::uint64_t> scene_roots(const Json& nodes) const {
    if (find(document_, "scenes") != nullptr) return indices(item("scenes", count(document_, "scene", 0)), "nodes");
    std::set<std::uint64_t> below;
    for (const Json& node : nodes)
      for (const std::uint64_t child : indices(node, "children")) below.insert(child);
    std::vector<std::uint64_t> roots;
    for (std::uint64_t i = 0; i < nodes.size(); ++i)
      if (below.count(i) == 0) roots.push_back(i);
    return roots;
  }

  void read_frame(const Json& root) {
    const Json* extras = find(root, "extras");
    const Json* about = extras == nullptr ? nullptr : find(*extras, "georeference");
    if (about == nullptr) return;
    frame_.crs_wkt = text(*about, "crs_wkt");
    frame_.vertical_unit = text(*about, "vertical_unit", "m");
    const auto metres = numbers<3>(*about, "unit_metres", {1, 1, 1});
    unit_ = {metres[0], metres[2], metres[1]};
    const Json* vertical = find(*about, "metres_per_unit");
    frame_.metres_per_unit = vertical != nullptr && vertical->is_number() ? vertical->get<double>() : metres[2];
    for (const double m : {metres[0], metres[1], metres[2], frame_.metres_per_unit})
      if (!(std::isfinite(m) && m > 0)) damaged("a unit is stated to have " + std::to_string(m) + " metres");
  }

  Transform local(const Json& node) const {
    if (find(node, "matrix") != nullptr) {
      const auto m = numbers<16>(node, "matrix", {});
      Transform result;
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t k = 0; k < 4; ++k) result[r][k] = m[4 * k + r];
      return result;
    }
    const auto t = numbers<3>(node, "translation", {0, 0, 0});
    const auto s = numbers<3>(node, "scale", {1, 1, 1});
    const auto [x, y, z, w] = numbers<4>(node, "rotation", {0, 0, 0, 1});
    return {{{(1 - 2 * (y * y + z * z)) * s[0], 2 * (x * y - z * w) * s[1], 2 * (x * z + y * w) * s[2], t[0]},
             {2 * (x * y + z * w) * s[0], (1 - 2 * (x * x + z * z)) * s[1], 2 * (y * z - x * w) * s[2], t[1]},
             {2 * (x * z - y * w) * s[0], 2 * (y * z + x * w) * s[1], (1 - 2 * (x * x + y * y)) * s[2], t[2]}}};
  }

  void add_mesh(const Json& mesh, const Transform& place) {
    const Json* primitives = find(mesh, "primitives");
    if (primitives == nullptr || !primitives->is_array()) damaged("a mesh has no primitives");
    for (const Json& primitive : *primitives) {
      if (count(primitive, "mode", triangles_mode) != triangles_mode) unsupported("it holds points, lines, strips or fans; triangles are read");
      const Json* extensions = find(primitive, "extensions");
      const Json* draco = extensions == nullptr ? nullptr : find(*extensions, "KHR_draco_mesh_compression");
      if (draco != nullptr) {
        add_draco(*draco, place);
      } else {
        add_plain(primitive, place);
      }
    }
  }

  std::int64_t vertex(const std::array<float, 3>& p, const Transform& m) {
    const auto row = [&](std::size_t r) { return m[r][0] * p[0] + m[r][1] * p[1] + m[r][2] * p[2] + m[r][3]; };
    const MeshVertex v{row(0), 0 - row(2), row(1)};
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) damaged("a vertex is no number");
    return welder_.index_of(v);
  }

  /// The triangle of three vertices of `places`.
  void triangle(const std::vector<std::int64_t>& places, std::array<std::uint64_t, 3> corners, bool mirrored) {
    for (const std::uint64_t c : corners)
      if (c >= places.size()) damaged("a triangle names vertex " + std::to_string(c) + " of " + std::to_string(places.size()));
    if (mirrored) std::swap(corners[1], corners[2]);
    mesh_.add(MeshTriangle{places[corners[0]], places[corners[1]], places[corners[2]]});
  }

  void add_draco(const Json& draco, const Transform& place) {
    const Elements e = view(count(draco, "bufferView"));
    const Json* attributes = find(draco, "attributes");
    if (attributes == nullptr) damaged("a Draco mesh has no attributes");
    std::vector<std::byte> bytes(e.count);
    read_bytes(e.buffer, e.start, bytes);
    const MeshArrays arrays = decode_draco(bytes, static_cast<int>(std::min<std::uint64_t>(count(*attributes, "POSITION"), 1 << 30)), "'" + path_ + "'");
    std::vector<std::int64_t> places;
    for (const auto& p : arrays.positions) places.push_back(vertex(p, place));
    const bool mirrored = mirrors(place);
    for (std::size_t i = 0; i + 2 < arrays.indices.size(); i += 3) triangle(places, {arrays.indices[i], arrays.indices[i + 1], arrays.indices[i + 2]}, mirrored);
  }

  void add_plain(const Json& primitive, const Transform& place) {
    const Json* attributes = find(primitive, "attributes");
    if (attributes == nullptr) damaged("a primitive has no attributes");
    const Elements positions = elements(count(*attributes, "POSITION"), "VEC3", 3);
    if (positions.component != float32) unsupported("its positions are no float32");
    std::vector<std::int64_t> places;
    for_each(positions, [&](const std::byte* at) {
      std::array<float, 3> p;
      std::memcpy(p.data(), at, sizeof p);
      places.push_back(vertex(p, place));
    });
    const bool mirrored = mirrors(place);
    std::array<std::uint64_t, 3> corners{};
    std::size_t corner = 0;
    const auto add = [&](std::uint64_t index) {
      corners[corner++] = index;
      if (corner == 3) triangle(places, corners, mirrored), corner = 0;
    };
    if (find(primitive, "indices") == nullptr) {
      for (std::uint64_t i = 0; i < places.size(); ++i) add(i);
    } else {
      const Elements e = elements(count(primitive, "indices"), "SCALAR", 1);
      if (e.component != unsigned_byte && e.component != unsigned_short && e.component != unsigned_int) damaged("its indices are no unsigned integers");
      for_each(e, [&](const std::byte* at) {
        std::uint32_t index = 0;
        std::memcpy(&index, at, e.size);  // little endian, as the file
        add(index);
      });
    }
    if (corner != 0) damaged("a primitive has indices that make no whole triangle");
  }

  std::string path_;
  Json document_;
  Buffer binary_;
  std::vector<Buffer> buffers_;
  std::ifstream stream_;
  std::string opened_;
  std::uint64_t all_bytes_ = 0, read_ = 0;
  MeshFrame frame_;
  std::array<double, 3> unit_{1, 1, 1};  ///< of the axes of glTF, in metres
  MeshBuilder mesh_;
  VertexWelder welder_;
};

}  // namespace

MeshFile read_gltf(const std::string& path, const Scratch& scratch) { return Reader(path, scratch).read(); }

}  // namespace arete
