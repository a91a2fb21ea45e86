#include "core/codec/predict_planes.h"

#include <algorithm>

namespace arete {
namespace {

constexpr int margin = lattice_margin;

// Fills void cells from the valid ones among their eight neighbours, ring by ring, as far as any filter reaches.
void fill_void_lattice(Plane<std::int32_t>& values, const Plane<std::uint8_t>& voids, const Window& inside) {
  const int x0 = static_cast<int>(inside.x), x1 = static_cast<int>(inside.x + inside.width);
  const int y0 = static_cast<int>(inside.y), y1 = static_cast<int>(inside.y + inside.height);
  Plane<std::uint8_t> unknown = voids;
  for (int ring = 0; ring < margin; ++ring) {
    const Plane<std::int32_t> before = values;
    const Plane<std::uint8_t> was_unknown = unknown;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        if (!was_unknown.row(y)[x]) continue;
        std::int64_t sum = 0, count = 0;
        for (int v = std::max(y - 1, y0); v <= std::min(y + 1, y1 - 1); ++v)
          for (int u = std::max(x - 1, x0); u <= std::min(x + 1, x1 - 1); ++u)
            if (!was_unknown.row(v)[u]) sum += before.row(v)[u], ++count;
        if (count == 0) continue;
        // rounded down, so that it does not depend on the sign convention of a division
        values.row(y)[x] = static_cast<std::int32_t>(sum >= 0 ? sum / count : -((-sum + count - 1) / count));
        unknown.row(y)[x] = 0;
      }
  }
}

// The value `outside` steps beyond an edge on the straight line through the edge and the cell as far inside.
std::int32_t extend(std::int32_t edge, std::int32_t inside, const PredictParameters& p) {
  const std::int64_t value = 2 * std::int64_t{edge} - inside;
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(value, p.lowest, p.highest));
}

// `inside`: the rectangle of the lattice plane that lies in the level.
void extend_lattice(Plane<std::int32_t>& values, const NodePlanes& planes, const Window& inside, const PredictParameters& parameters) {
  const int x0 = static_cast<int>(inside.x), x1 = static_cast<int>(inside.x + inside.width) - 1;
  const int y0 = static_cast<int>(inside.y), y1 = static_cast<int>(inside.y + inside.height) - 1;
  for (int y = y0; y <= y1; ++y) {
    std::int32_t* row = values.row(y);
    for (int x = x0 - 1; x >= -margin; --x) row[x] = extend(row[x0], row[std::min(2 * x0 - x, x1)], parameters);
    for (int x = x1 + 1; x < planes.width + margin; ++x) row[x] = extend(row[x1], row[std::max(2 * x1 - x, x0)], parameters);
  }
  for (int x = -margin; x < planes.width + margin; ++x) {
    for (int y = y0 - 1; y >= -margin; --y)
      values.row(y)[x] = extend(values.row(y0)[x], values.row(std::min(2 * y0 - y, y1))[x], parameters);
    for (int y = y1 + 1; y < planes.height + margin; ++y)
      values.row(y)[x] = extend(values.row(y1)[x], values.row(std::max(2 * y1 - y, y0))[x], parameters);
  }
}

}  // namespace

NodePlanes make_planes(const LevelView& coarse, const Window& cells, RasterView<const std::uint8_t> voids, const PredictParameters& parameters) {
  NodePlanes planes;
  planes.block_width = static_cast<int>(cells.width);
  planes.block_height = static_cast<int>(cells.height);
  planes.width = (planes.block_width + 1) / 2;
  planes.height = (planes.block_height + 1) / 2;
  planes.any_void = coarse.voids.data != nullptr || voids.data != nullptr;
  for (Plane<std::int32_t>& plane : planes.values) plane = Plane<std::int32_t>(planes.width, planes.height, 0);
  for (std::size_t p = 1; p < 4; ++p) planes.magnitudes[p] = Plane<std::int32_t>(planes.width, planes.height, 0);

  const std::int64_t origin_x = cells.x / 2, origin_y = cells.y / 2;
  Window inside;
  inside.x = -std::min<std::int64_t>(margin, origin_x);
  inside.y = -std::min<std::int64_t>(margin, origin_y);
  inside.width = std::min<std::int64_t>(planes.width + margin, coarse.level.width - origin_x) - inside.x;
  inside.height = std::min<std::int64_t>(planes.height + margin, coarse.level.height - origin_y) - inside.y;

  Plane<std::int32_t>& lattice = planes.values[0];
  const std::int64_t dx = origin_x - coarse.x, dy = origin_y - coarse.y;
  for (std::int64_t y = inside.y; y < inside.y + inside.height; ++y)
    std::copy_n(coarse.values.row(y + dy) + inside.x + dx, inside.width, lattice.row(static_cast<int>(y)) + inside.x);
  if (planes.any_void) {
    Plane<std::uint8_t>& lattice_voids = planes.voids[0];
    lattice_voids = Plane<std::uint8_t>(planes.width, planes.height, 0);
    bool any = false;
    for (std::int64_t y = inside.y; y < inside.y + inside.height && coarse.voids.data != nullptr; ++y)
      for (std::int64_t x = inside.x; x < inside.x + inside.width; ++x) {
        if (coarse.voids.row(y + dy)[x + dx] == 0) continue;
        any = true;
        lattice_voids.row(static_cast<int>(y))[x] = 1;
        lattice.row(static_cast<int>(y))[x] = std::clamp(0, parameters.lowest, parameters.highest);
      }
    if (any) fill_void_lattice(lattice, lattice_voids, inside);
    for (int p = 1; p < 4; ++p) {
      planes.voids[static_cast<std::size_t>(p)] = Plane<std::uint8_t>(planes.width, planes.height, 0);
      for (int y = 0; y < coded_height(planes, p) && voids.data != nullptr; ++y)
        for (int x = 0; x < coded_width(planes, p); ++x)
          planes.voids[static_cast<std::size_t>(p)].row(y)[x] = voids.row(2 * y + odd_y(p))[2 * x + odd_x(p)];
    }
  }
  extend_lattice(lattice, planes, inside, parameters);
  return planes;
}

void copy_block(const NodePlanes& planes, RasterView<std::int32_t> values) {
  for (int p = 0; p < 4; ++p)
    for (int y = 0; y < coded_height(planes, p); ++y) {
      const std::int32_t* from = planes.values[static_cast<std::size_t>(p)].row(y);
      std::int32_t* to = values.row(2 * y + odd_y(p)) + odd_x(p);
      for (int x = 0; x < coded_width(planes, p); ++x) to[2 * x] = from[x];
    }
}

}  // namespace arete
