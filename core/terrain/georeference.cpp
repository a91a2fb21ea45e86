#include "core/terrain/georeference.h"

namespace arete {

std::array<double, 2> cell_at(const std::array<double, 6>& transform, double x, double y) {
  const auto& t = transform;
  const double determinant = t[1] * t[5] - t[2] * t[4], dx = x - t[0], dy = y - t[3];
  return {(dx * t[5] - dy * t[2]) / determinant, (dy * t[1] - dx * t[4]) / determinant};
}

GeoReference refine(const GeoReference& geo, int factor) {
  GeoReference finer = geo;
  if (finer.transform)
    for (int i : {1, 2, 4, 5}) (*finer.transform)[static_cast<std::size_t>(i)] /= factor;
  return finer;
}

GeoReference coarsen(const GeoReference& geo, int factor) {
  GeoReference coarser = geo;
  if (coarser.transform)
    for (int i : {1, 2, 4, 5}) (*coarser.transform)[static_cast<std::size_t>(i)] *= factor;
  return coarser;
}

GeoReference crop(const GeoReference& geo, const Window& window) {
  GeoReference part = geo;
  if (part.transform) {
    auto& t = *part.transform;
    t[0] += static_cast<double>(window.x) * t[1] + static_cast<double>(window.y) * t[2];
    t[3] += static_cast<double>(window.x) * t[4] + static_cast<double>(window.y) * t[5];
  }
  return part;
}

}  // namespace arete
