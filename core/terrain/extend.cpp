#include "core/terrain/extend.h"

#include <algorithm>
#include <vector>

#include <Eigen/Dense>

namespace arete {
namespace {

struct Box {
  std::int64_t x0, x1, y0, y1;  // inclusive
};

Box around(std::int64_t x, std::int64_t y, int reach, Size size) {
  return {std::max<std::int64_t>(0, x - reach), std::min(size.width - 1, x + reach), std::max<std::int64_t>(0, y - reach),
          std::min(size.height - 1, y + reach)};
}

/// The fitted plane at (x, y). Elevations are taken relative to one of them, so that high terrain keeps its digits.
float fit_plane_at(RasterView<const float> known, std::int64_t x, std::int64_t y, int reach) {
  const Box box = around(x, y, reach, known.size());
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double base = 0;
  bool any = false;
  for (std::int64_t j = box.y0; j <= box.y1; ++j)
    for (std::int64_t i = box.x0; i <= box.x1; ++i) {
      const float z = known(i, j);
      if (is_void(z)) continue;
      if (!any) base = static_cast<double>(z);
      any = true;
      const Eigen::Vector3d basis(1, static_cast<double>(i - x), static_cast<double>(j - y));
      const double squared = basis[1] * basis[1] + basis[2] * basis[2], weight = 1 / (squared * squared);
      normal += weight * basis * basis.transpose();
      right += weight * (static_cast<double>(z) - base) * basis;
    }
  if (!any) return void_value;
  const double mean = right[0] / normal(0, 0);
  // Relative to the total weight and the nearest distance, a determinant near 0 means cells on one line.
  const double determinant = normal.determinant(), scale = normal(0, 0) * normal(0, 0) * normal(0, 0);
  if (determinant < 1e-3 * scale) return static_cast<float>(base + mean);
  return static_cast<float>(base + normal.ldlt().solve(right)[0]);
}

/// Which cells have a valid one within `reach`: two passes of a running maximum, rows then columns.
std::vector<char> near_valid(RasterView<const float> known, int reach) {
  const std::int64_t w = known.width, h = known.height;
  std::vector<char> rows(static_cast<std::size_t>(w * h)), near(rows.size());
  for (std::int64_t y = 0; y < h; ++y) {
    std::int64_t last = -reach - 1;
    for (std::int64_t x = 0; x < w + reach; ++x) {
      if (x < w && !is_void(known(x, y))) last = x;
      if (x >= reach && last >= x - 2 * reach) rows[static_cast<std::size_t>(y * w + x - reach)] = 1;
    }
  }
  std::vector<std::int64_t> last(static_cast<std::size_t>(w), -reach - 1);
  for (std::int64_t y = 0; y < h + reach; ++y)
    for (std::int64_t x = 0; x < w; ++x) {
      std::int64_t& row = last[static_cast<std::size_t>(x)];
      if (y < h && rows[static_cast<std::size_t>(y * w + x)]) row = y;
      if (y >= reach && row >= y - 2 * reach) near[static_cast<std::size_t>((y - reach) * w + x)] = 1;
    }
  return near;
}

}  // namespace

void extend_into_voids(RasterView<const float> known, int reach, RasterView<float> out) {
  bool any_void = false;
  for (std::int64_t y = 0; y < known.height; ++y)
    for (std::int64_t x = 0; x < known.width; ++x) {
      out(x, y) = known(x, y);
      any_void |= is_void(known(x, y));
    }
  if (!any_void) return;
  const std::vector<char> near = near_valid(known, reach);
  for (std::int64_t y = 0; y < known.height; ++y)
    for (std::int64_t x = 0; x < known.width; ++x)
      if (is_void(known(x, y)) && near[static_cast<std::size_t>(y * known.width + x)]) out(x, y) = fit_plane_at(known, x, y, reach + extend_support);
}

}  // namespace arete
