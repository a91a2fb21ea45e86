#pragma once

#include <cmath>
#include <vector>

#include "core/support/random.h"
#include "core/terrain/raster.h"
#include "core/terrain/raster_io.h"
#include "gis/tin/greedy_insertion.h"
#include "gis/tin/tile_domain.h"
#include "gis/tin/triangle_errors.h"

namespace arete {

/// A raster in memory as a source.
class HeldRaster final : public RasterSource {
 public:
  explicit HeldRaster(Raster<float> cells) : cells_(std::move(cells)) {}
  Size size() const override { return cells_.size(); }
  void read(const Window& window, RasterView<float> out) const override {
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) out(x, y) = cells_(window.x + x, window.y + y);
  }
  RasterView<const float> view() const { return cells_.view(); }

 private:
  Raster<float> cells_;
};

/// Waves with noise of so many metres on them.
inline Raster<float> noisy_waves(std::int64_t width, std::int64_t height, double noise) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = static_cast<float>(500 + 80 * std::sin(static_cast<double>(x) / 37) + 60 * std::cos(static_cast<double>(x + 2 * y) / 53) +
                                       noise * uniform_at(1, static_cast<std::uint64_t>(y * width + x)));
  return cells;
}

/// Elevations that proofs compute with: whole sixteenths.
inline Raster<float> short_cells() {
  Raster<float> cells = noisy_waves(120, 90, 6);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = std::round(16 * cells.data()[i]) / 16;
  return cells;
}

/// The four sides of a tile, each simplified.
inline TileBorder border_of(const TileCells& cells, double bound) {
  const auto side = [&](bool column, std::int64_t index) {
    std::vector<float> line;
    for (std::int64_t i = 0; i < (column ? cells.height : cells.width); ++i) line.push_back(column ? cells(index, i) : cells(i, index));
    return simplify_line(line, {bound, 1.0 / 1024});
  };
  return {side(false, 0), side(false, cells.height - 1), side(true, 0), side(true, cells.width - 1)};
}

/// A tile after greedy insertion.
inline TileMesh inserted(const TileCells& cells, const TileBound& bound) {
  TileMesh mesh = triangulate_domain(cells, border_of(cells, bound.error_m), bound.height_step_m);
  insert_greedily(mesh, cells, bound);
  link_vertices(mesh);
  return mesh;
}

inline int triangles_beyond(const TileMesh& mesh, const TileCells& cells, const TileBound& bound) {
  int beyond = 0;
  for (std::int32_t t = 0; t < mesh.triangles(); ++t) {
    if (mesh.removed(t)) continue;
    const auto [a, b, c] = mesh.corners(t);
    beyond += !fit_of(mesh, cells, a, b, c, bound).keeps;
  }
  return beyond;
}

}  // namespace arete
