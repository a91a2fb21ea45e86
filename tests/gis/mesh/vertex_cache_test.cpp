#include "gis/mesh/vertex_cache.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace arete {
namespace {

/// Vertex i is (i, -i, 2 i); counts the blocks that are read.
class Counting final : public MeshSource {
 public:
  explicit Counting(std::int64_t count) : count_(count) {}
  std::int64_t vertices() const override { return count_; }
  std::int64_t triangles() const override { return 0; }
  void read_vertices(std::int64_t first, std::span<MeshVertex> out) const override {
    ++reads;
    for (MeshVertex& v : out) {
      ASSERT_LT(first, count_);
      const auto i = static_cast<double>(first++);
      v = {i, -i, 2 * i};
    }
  }
  void read_triangles(std::int64_t, std::span<MeshTriangle>) const override {}
  mutable int reads = 0;

 private:
  std::int64_t count_;
};

TEST(VertexCache, GivesTheVerticesOfTheMeshInAnyOrder) {
  const Counting mesh(3000001);
  VertexCache vertices(mesh);
  std::uint64_t state = 1;
  for (int i = 0; i < 20000; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const auto index = static_cast<std::int64_t>((state >> 33) % 3000001u);
    const auto x = static_cast<double>(index);
    ASSERT_EQ(vertices[index], (MeshVertex{x, -x, 2 * x}));
  }
  EXPECT_EQ(vertices[3000000], (MeshVertex{3000000, -3000000, 6000000}));
}

// 3,000,000 vertices are 733 blocks, of which 256 are kept: in order, with a neighbour behind, each is read once.
TEST(VertexCache, ReadsABlockOnceWhereIndicesAreClose) {
  const Counting mesh(3000000);
  VertexCache vertices(mesh);
  for (std::int64_t i = 0; i < 3000000; i += 100) {
    ASSERT_EQ(vertices[i].x, static_cast<double>(i));
    const std::int64_t behind = std::max<std::int64_t>(0, i - 500000);
    ASSERT_EQ(vertices[behind].x, static_cast<double>(behind));
  }
  EXPECT_EQ(mesh.reads, 733);
}

}  // namespace
}  // namespace arete
