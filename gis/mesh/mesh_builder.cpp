#include "gis/mesh/mesh_builder.h"

#include <algorithm>

#include "core/support/error.h"
#include "gis/mesh/mesh_blocks.h"

namespace arete {

MeshBuilder::MeshBuilder(const Scratch& scratch) : mesh_(scratch, scratch.memory_bytes / 2) {}

std::int64_t MeshBuilder::add(const MeshVertex& vertex) {
  vertex_block_.push_back(vertex);
  if (std::ssize(vertex_block_) == mesh_block) {
    mesh_.append_vertices(vertex_block_);
    vertex_block_.clear();
  }
  return vertices_++;
}

void MeshBuilder::add(const MeshTriangle& triangle) {
  const auto [low, high] = std::minmax({triangle[0], triangle[1], triangle[2]});
  least_ = std::min(least_, low);
  if (high > greatest_) {
    greatest_ = high;
    triangle_of_greatest_ = triangles_;
  }
  triangle_block_.push_back(triangle);
  if (std::ssize(triangle_block_) == mesh_block) {
    mesh_.append_triangles(triangle_block_);
    triangle_block_.clear();
  }
  ++triangles_;
}

MeshStore MeshBuilder::finish(const std::string& path) {
  if (least_ < 0)
    throw Error(ErrorKind::input,
                "'" + path + "' is damaged: a triangle names the vertex " + std::to_string(least_) + "; they count from 0");
  if (greatest_ >= vertices_)
    throw Error(ErrorKind::input, "'" + path + "' is damaged: triangle " + std::to_string(triangle_of_greatest_ + 1) +
                                      " names vertex " + std::to_string(greatest_ + 1) + " of " + std::to_string(vertices_));
  mesh_.append_vertices(vertex_block_);
  mesh_.append_triangles(triangle_block_);
  vertex_block_.clear();
  triangle_block_.clear();
  return std::move(mesh_);
}

bool PointNumbers::add(std::int64_t number) {
  const std::int64_t place = count_;
  if (number == dense_ + 1 && others_.empty()) {
    ++dense_;
  } else if (place_of(number) >= 0 || !others_.emplace(number, place).second) {
    return false;
  }
  ++count_;
  return true;
}

std::int64_t PointNumbers::place_of(std::int64_t number) const {
  if (number >= 1 && number <= dense_) return number - 1;
  const auto found = others_.find(number);
  return found == others_.end() ? -1 : found->second;
}

}  // namespace arete
