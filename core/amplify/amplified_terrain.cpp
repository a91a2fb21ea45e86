#include "core/amplify/amplified_terrain.h"

#include <algorithm>
#include <cmath>

namespace arete {
namespace {

std::int64_t ceil_div(std::int64_t a, std::int64_t b) { return (a + b - 1) / b; }

/// A band evaluated on whole coarse cells, cut to the window that was asked for.
class CutBand {
 public:
  CutBand(RasterView<float> wanted, const Window& asked, const Window& whole)
      : wanted_(wanted), x_(asked.x - whole.x), y_(asked.y - whole.y), aligned_(asked == whole) {
    if (wanted.data && !aligned_) cells_ = Raster<float>(whole.width, whole.height);
  }
  RasterView<float> target() { return !wanted_.data || aligned_ ? wanted_ : cells_.view(); }
  void deliver() const {
    if (!wanted_.data || aligned_) return;
    ViewSource(cells_.view()).read({x_, y_, wanted_.width, wanted_.height}, wanted_);
  }

 private:
  RasterView<float> wanted_;
  std::int64_t x_, y_;
  bool aligned_;
  Raster<float> cells_;
};

}  // namespace

Size AmplifiedTerrain::size() const {
  const Size coarse = coarse_.size();
  return {coarse.width * stage_.factor(), coarse.height * stage_.factor()};
}

Raster<float> AmplifiedTerrain::read_coarse(const Window& window) const {
  const int margin = stage_.margin();
  const Size size = coarse_.size();
  const std::int64_t left = window.x - margin, top = window.y - margin;
  Raster<float> cells(window.width + 2 * margin, window.height + 2 * margin, void_value);
  const std::int64_t x0 = std::max<std::int64_t>(0, left), y0 = std::max<std::int64_t>(0, top);
  const std::int64_t x1 = std::min(size.width, left + cells.width()), y1 = std::min(size.height, top + cells.height());
  coarse_.read({x0, y0, x1 - x0, y1 - y0}, cells.view().sub({x0 - left, y0 - top, x1 - x0, y1 - y0}));
  if (!stage_.repeats_edge()) return cells;
  for (std::int64_t y = 0; y < cells.height(); ++y)
    for (std::int64_t x = 0; x < cells.width(); ++x) {
      const std::int64_t i = std::clamp(x + left, x0, x1 - 1), j = std::clamp(y + top, y0, y1 - 1);
      if (i != x + left || j != y + top) cells(x, y) = cells(i - left, j - top);
    }
  return cells;
}

void AmplifiedTerrain::read(const Window& window, RasterView<float> out) const {
  AmplifiedBands bands;
  bands.elevation = out;
  read_bands(window, bands);
}

void AmplifiedTerrain::read_bands(const Window& window, const AmplifiedBands& bands) const {
  const int f = stage_.factor();
  const std::int64_t x = window.x / f, y = window.y / f;
  const Window coarse{x, y, ceil_div(window.x + window.width, f) - x, ceil_div(window.y + window.height, f) - y};
  const Window whole{coarse.x * f, coarse.y * f, coarse.width * f, coarse.height * f};
  CutBand elevation(bands.elevation, window, whole), uncertainty(bands.uncertainty, window, whole);
  CutBand exemplar(bands.exemplar, window, whole), atom(bands.atom, window, whole);
  const Raster<float> cells = read_coarse(coarse);
  stage_.evaluate(coarse, cells.view(), {elevation.target(), uncertainty.target(), exemplar.target(), atom.target()}, threads_);
  if (const auto* before = dynamic_cast<const AmplifiedTerrain*>(&coarse_); before && bands.uncertainty.data) {
    Raster<float> heights(coarse.width, coarse.height), errors(coarse.width, coarse.height);
    AmplifiedBands earlier;
    earlier.elevation = heights.view();
    earlier.uncertainty = errors.view();
    before->read_bands(coarse, earlier);
    const RasterView<float> total = uncertainty.target();
    for (std::int64_t j = 0; j < total.height; ++j)
      for (std::int64_t i = 0; i < total.width; ++i) total(i, j) = std::hypot(total(i, j), errors(i / f, j / f));
  }
  for (CutBand* band : {&elevation, &uncertainty, &exemplar, &atom}) band->deliver();
}

}  // namespace arete
