#include "shaders/tile_cache.h"

#include <algorithm>

#include <epoxy/gl.h>

#include "core/support/parallel.h"

namespace arete {

TileCache::TileCache(const SamplePyramid& pyramid, std::int64_t memory_bytes, int threads) : pyramid_(pyramid), threads_(threads) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most);
  const std::int64_t tile_bytes = std::int64_t{tile_samples} * tile_samples * static_cast<std::int64_t>(sizeof(TerrainSample));
  // Not more than there are nodes.
  std::int64_t nodes = 0;
  for (int level = 0; level < pyramid.levels(); ++level)
    nodes += (pyramid.size(level).width / node_cells + 1) * (pyramid.size(level).height / node_cells + 1);
  const std::int64_t layers = std::clamp<std::int64_t>(std::min(memory_bytes / tile_bytes, nodes), 2, most);
  slots_.resize(static_cast<std::size_t>(layers));
  glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &texture_);
  glTextureStorage3D(texture_, 1, GL_RGBA32F, tile_samples, tile_samples, static_cast<GLsizei>(layers));
  glTextureParameteri(texture_, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(texture_, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(texture_, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(texture_, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

TileCache::~TileCache() { glDeleteTextures(1, &texture_); }

std::size_t TileCache::load(std::span<const TerrainPatch> patches, std::vector<std::int32_t>& layers) {
  ++time_;
  layers.clear();
  std::vector<std::int32_t> missing, oldest(slots_.size());
  for (std::size_t i = 0; i < oldest.size(); ++i) oldest[i] = static_cast<std::int32_t>(i);
  const auto slot = [&](std::int32_t i) -> Slot& { return slots_[static_cast<std::size_t>(i)]; };
  // First what is there already, so that it is not replaced.
  std::size_t together = 0;
  std::map<Key, bool> wanted;
  for (; together < patches.size(); ++together) {
    const Key key{patches[together].level, patches[together].y, patches[together].x};
    if (wanted.size() == slots_.size() && !wanted.count(key)) break;
    wanted[key] = true;
    if (const auto found = where_.find(key); found != where_.end()) slot(found->second).used = time_;
  }
  std::stable_sort(oldest.begin(), oldest.end(), [&](std::int32_t a, std::int32_t b) { return slot(a).used < slot(b).used; });
  std::size_t next = 0;
  for (std::size_t i = 0; i < together; ++i) {
    const Key key{patches[i].level, patches[i].y, patches[i].x};
    auto found = where_.find(key);
    if (found == where_.end()) {
      const std::int32_t taken = oldest[next++];
      if (slot(taken).key.level >= 0) where_.erase(slot(taken).key);
      slot(taken) = {key, time_};
      found = where_.emplace(key, taken).first;
      missing.push_back(taken);
    }
    layers.push_back(found->second);
  }
  upload(missing);
  return together;
}

void TileCache::upload(const std::vector<std::int32_t>& slots) {
  constexpr std::size_t at_once = 64;
  std::vector<Raster<TerrainSample>> tiles(std::min(at_once, slots.size()));
  for (Raster<TerrainSample>& tile : tiles) tile = Raster<TerrainSample>(tile_samples, tile_samples);
  for (std::size_t begin = 0; begin < slots.size(); begin += at_once) {
    const std::size_t count = std::min(at_once, slots.size() - begin);
    parallel_for(static_cast<std::int64_t>(count), threads_, [&](std::int64_t i) {
      const Key& key = slots_[static_cast<std::size_t>(slots[begin + static_cast<std::size_t>(i)])].key;
      pyramid_.read(key.level, {(key.x >> key.level) - 1, (key.y >> key.level) - 1, tile_samples, tile_samples}, tiles[static_cast<std::size_t>(i)].view());
    });
    for (std::size_t i = 0; i < count; ++i)
      glTextureSubImage3D(texture_, 0, 0, 0, slots[begin + i], tile_samples, tile_samples, 1, GL_RGBA, GL_FLOAT, tiles[i].data());
  }
  loaded_ += static_cast<std::int64_t>(slots.size());
}

}  // namespace arete
