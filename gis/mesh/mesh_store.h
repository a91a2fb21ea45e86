#pragma once

#include <span>

#include "core/support/scratch.h"
#include "gis/mesh/mesh.h"

namespace arete {

/// A mesh that grows at its end, in memory or, beyond a limit, in files without a name. One thread appends; when it has
/// finished, several may read.
class MeshStore final : public MeshSource {
 public:
  MeshStore() = default;
  /// Throws as ScratchBytes, here and below.
  MeshStore(const Scratch& scratch, std::int64_t limit_bytes) : vertices_(scratch, limit_bytes / 2), triangles_(scratch, limit_bytes / 2) {}

  void append_vertices(std::span<const MeshVertex> vertices) { vertices_.append(std::as_bytes(vertices)); }
  void append_triangles(std::span<const MeshTriangle> triangles) { triangles_.append(std::as_bytes(triangles)); }

  std::int64_t vertices() const override { return static_cast<std::int64_t>(vertices_.size() / sizeof(MeshVertex)); }
  std::int64_t triangles() const override { return static_cast<std::int64_t>(triangles_.size() / sizeof(MeshTriangle)); }
  void read_vertices(std::int64_t first, std::span<MeshVertex> out) const override {
    vertices_.read(static_cast<std::uint64_t>(first) * sizeof(MeshVertex), std::as_writable_bytes(out));
  }
  void read_triangles(std::int64_t first, std::span<MeshTriangle> out) const override {
    triangles_.read(static_cast<std::uint64_t>(first) * sizeof(MeshTriangle), std::as_writable_bytes(out));
  }

 private:
  ScratchBytes vertices_;
  ScratchBytes triangles_;
};

}  // namespace arete
