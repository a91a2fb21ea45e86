#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "gis/mesh/mesh_store.h"

namespace arete {

/// A mesh that a reader collects vertex by vertex.
class MeshBuilder {
 public:
  /// The mesh takes half of scratch.memory_bytes and spills beyond.
  explicit MeshBuilder(const Scratch& scratch);
  std::int64_t vertices() const { return vertices_; }
  std::int64_t triangles() const { return triangles_; }
  /// Returns its index.
  std::int64_t add(const MeshVertex& vertex);
  /// The indices are those of vertices that were added, or will be: finish() checks them.
  void add(const MeshTriangle& triangle);
  /// The mesh. Throws Error{input}, `path` being the file, where a triangle names a vertex that there is not.
  MeshStore finish(const std::string& path);

 private:
  MeshStore mesh_;
  std::vector<MeshVertex> vertex_block_;
  std::vector<MeshTriangle> triangle_block_;
  std::int64_t vertices_ = 0, triangles_ = 0;
  std::int64_t least_ = 0, greatest_ = -1;
  std::int64_t triangle_of_greatest_ = 0;
};

/// The order in which numbered points came: formats number them from 1, most without gaps. Those without gaps cost nothing.
class PointNumbers {
 public:
  /// False where the number was there before.
  bool add(std::int64_t number);
  /// Its place, from 0; -1 where there is no such point.
  std::int64_t place_of(std::int64_t number) const;

 private:
  std::int64_t dense_ = 0;  // 1 ... dense_ came in order
  std::int64_t count_ = 0;
  std::unordered_map<std::int64_t, std::int64_t> others_;
};

}  // namespace arete
