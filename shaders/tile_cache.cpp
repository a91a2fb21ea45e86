#include "shaders/tile_cache.h"

#include <algorithm>
#include <set>

#include <epoxy/gl.h>

#include "core/support/error.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

constexpr std::int64_t sample_bytes = 6 * sizeof(float);
constexpr auto tile_area = static_cast<std::size_t>(tile_samples) * tile_samples;

}  // namespace

struct TileCache::Tile {
  Raster<TerrainSample> samples{tile_samples + 2, tile_samples + 2};  // and those around
  std::vector<std::array<float, 2>> heights = std::vector<std::array<float, 2>>(tile_area);
  std::vector<std::array<float, 4>> shapes = std::vector<std::array<float, 4>>(tile_area);
  bool holed = false;
};

TileCache::TileCache(const SamplePyramid& pyramid, std::int64_t memory_bytes, int threads) : pyramid_(pyramid), threads_(threads) {
  // Not more than there are.
  std::int64_t tiles = 0;
  for (int level = 0; level < pyramid.levels(); ++level)
    tiles += (pyramid.size(level).width / tile_cells + 1) * (pyramid.size(level).height / tile_cells + 1);
  make_textures(static_cast<std::size_t>(std::max<std::int64_t>(16, std::min(memory_bytes / (static_cast<std::int64_t>(tile_area) * sample_bytes), tiles))));
}

TileCache::~TileCache() {
  const GLuint textures[] = {heights_, shapes_};
  glDeleteTextures(2, textures);
}

void TileCache::make_textures(std::size_t layers) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most);
  slots_.assign(std::min(layers, static_cast<std::size_t>(most)), {});
  where_.clear();
  const auto make = [&](GLenum format) {
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &texture);
    glTextureStorage3D(texture, 1, format, tile_samples, tile_samples, static_cast<GLsizei>(slots_.size()));
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) glTextureParameteri(texture, filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glTextureParameteri(texture, wrap, GL_CLAMP_TO_EDGE);
    return texture;
  };
  heights_ = make(GL_RG32F);
  shapes_ = make(GL_RGBA32F);
}

void TileCache::grow() {
  const GLuint textures[] = {heights_, shapes_};
  glDeleteTextures(2, textures);
  const std::size_t before = slots_.size();
  make_textures(2 * before);
  if (slots_.size() == before) throw Error(ErrorKind::input, "the OpenGL driver has too few texture layers for this picture: draw a smaller one");
}

TileCache::Key TileCache::key_of(const TerrainPatch& patch) {
  const int shift = patch.level + 6;
  static_assert(tile_cells == 1 << 6);
  return {patch.level, patch.y >> shift, patch.x >> shift};
}

std::vector<std::array<std::int32_t, 4>> TileCache::table() const {
  std::vector<std::array<std::int32_t, 4>> table;
  for (const Slot& slot : slots_) {
    const int level = std::max(0, slot.key.level);
    table.push_back({slot.key.x * tile_cells << level, slot.key.y * tile_cells << level, level, 0});
  }
  return table;
}

bool TileCache::holds(std::span<const TerrainPatch> patches) const {
  std::set<Key> wanted;
  for (const TerrainPatch& patch : patches) {
    wanted.insert(key_of(patch));
    if (wanted.size() > slots_.size()) return false;
  }
  return true;
}

std::size_t TileCache::load(std::span<const TerrainPatch> patches, std::vector<Place>& places) {
  ++time_;
  places.clear();
  std::vector<std::int32_t> missing, oldest(slots_.size());
  for (std::size_t i = 0; i < oldest.size(); ++i) oldest[i] = static_cast<std::int32_t>(i);
  const auto slot = [&](std::int32_t i) -> Slot& { return slots_[static_cast<std::size_t>(i)]; };
  // First what is there already, so that it is not replaced.
  std::size_t together = 0;
  std::set<Key> wanted;
  for (; together < patches.size(); ++together) {
    const Key key = key_of(patches[together]);
    if (wanted.size() == slots_.size() && !wanted.count(key)) break;
    wanted.insert(key);
    if (const auto found = where_.find(key); found != where_.end()) slot(found->second).used = time_;
  }
  std::stable_sort(oldest.begin(), oldest.end(), [&](std::int32_t a, std::int32_t b) { return slot(a).used < slot(b).used; });
  std::size_t next = 0;
  for (const Key& key : wanted) {
    if (where_.count(key)) continue;
    const std::int32_t taken = oldest[next++];
    if (slot(taken).key.level >= 0) where_.erase(slot(taken).key);
    slot(taken) = {key, time_, false};
    where_[key] = taken;
    missing.push_back(taken);
  }
  upload(missing);
  for (std::size_t i = 0; i < together; ++i) {
    const std::int32_t layer = where_[key_of(patches[i])];
    places.push_back({layer, slot(layer).holed});
  }
  return together;
}

void TileCache::read(const Key& key, Tile& tile) const {
  const std::int64_t x0 = std::int64_t{key.x} * tile_cells, y0 = std::int64_t{key.y} * tile_cells;
  pyramid_.read(key.level, {x0 - 1, y0 - 1, tile_samples + 2, tile_samples + 2}, tile.samples.view());
  const Size all = pyramid_.size(0);
  // Columns or rows of the DEM from the sample before to the one after; the last sample may be closer.
  const auto between = [&](std::int64_t at, std::int64_t length) {
    const auto place = [&](std::int64_t i) { return std::clamp<std::int64_t>(i << key.level, 0, length - 1); };
    return static_cast<float>(std::max<std::int64_t>(1, place(at + 1) - place(std::max<std::int64_t>(0, at - 1))));
  };
  tile.holed = false;
  for (std::int64_t y = 0; y < tile_samples; ++y)
    for (std::int64_t x = 0; x < tile_samples; ++x) {
      const auto at = [&](std::int64_t u, std::int64_t v) -> const TerrainSample& { return tile.samples(x + 1 + u, y + 1 + v); };
      const TerrainSample& here = at(0, 0);
      const auto i = static_cast<std::size_t>(y * tile_samples + x);
      tile.heights[i] = {here.height, here.valid};
      tile.shapes[i] = {here.smooth, (at(1, 0).smooth - at(-1, 0).smooth) / between(x0 + x, all.width),
                        (at(0, 1).smooth - at(0, -1).smooth) / between(y0 + y, all.height), here.water};
      tile.holed |= here.valid < 1;
    }
}

void TileCache::upload(const std::vector<std::int32_t>& slots) {
  constexpr std::size_t at_once = 64;
  std::vector<Tile> tiles(std::min(at_once, slots.size()));
  for (std::size_t begin = 0; begin < slots.size(); begin += at_once) {
    const std::size_t count = std::min(at_once, slots.size() - begin);
    parallel_for(static_cast<std::int64_t>(count), threads_, [&](std::int64_t i) {
      read(slots_[static_cast<std::size_t>(slots[begin + static_cast<std::size_t>(i)])].key, tiles[static_cast<std::size_t>(i)]);
    });
    for (std::size_t i = 0; i < count; ++i) {
      const std::int32_t layer = slots[begin + i];
      slots_[static_cast<std::size_t>(layer)].holed = tiles[i].holed;
      glTextureSubImage3D(heights_, 0, 0, 0, layer, tile_samples, tile_samples, 1, GL_RG, GL_FLOAT, tiles[i].heights.data());
      glTextureSubImage3D(shapes_, 0, 0, 0, layer, tile_samples, tile_samples, 1, GL_RGBA, GL_FLOAT, tiles[i].shapes.data());
    }
  }
  loaded_ += static_cast<std::int64_t>(slots.size());
}

}  // namespace arete
