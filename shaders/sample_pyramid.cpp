#include "shaders/sample_pyramid.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/support/parallel.h"
#include "core/terrain/sea.h"

namespace arete {
namespace {

/// Bilinear in the overview at a sample of the source.
float overview_height(const Overview& overview, std::int64_t x, std::int64_t y) {
  const auto place = [](std::int64_t sample, std::int64_t block, std::int64_t length) {
    return std::clamp((static_cast<double>(sample) + 0.5) / static_cast<double>(block) - 0.5, 0.0, static_cast<double>(length - 1));
  };
  const double u = place(x, overview.across, overview.cells.width()), v = place(y, overview.down, overview.cells.height());
  const auto i = static_cast<std::int64_t>(u), j = static_cast<std::int64_t>(v);
  const std::int64_t i1 = std::min(i + 1, overview.cells.width() - 1), j1 = std::min(j + 1, overview.cells.height() - 1);
  const double s = u - static_cast<double>(i), t = v - static_cast<double>(j);
  const double north = (1 - s) * overview.cells(i, j) + s * overview.cells(i1, j), south = (1 - s) * overview.cells(i, j1) + s * overview.cells(i1, j1);
  return static_cast<float>((1 - t) * north + t * south);
}

/// Cells read with a halo that stops at the border of the raster.
struct Neighbourhood {
  Raster<float> cells;
  Raster<std::uint8_t> sea;
  std::int64_t x = 0, y = 0;  // of the first cell

  template <typename Visit>
  void around(std::int64_t cx, std::int64_t cy, const Visit& visit) const {
    for (std::int64_t j = std::max(cy - 1, y); j <= std::min(cy + 1, y + cells.height() - 1); ++j)
      for (std::int64_t i = std::max(cx - 1, x); i <= std::min(cx + 1, x + cells.width() - 1); ++i) visit(cells(i - x, j - y));
  }
};

TerrainSample describe(const Neighbourhood& near, const Overview& overview, int level, std::int64_t x, std::int64_t y) {
  TerrainSample sample;
  sample.height = near.cells(x - near.x, y - near.y);
  if (is_void(sample.height)) {
    double sum = 0;
    int count = 0;
    near.around(x, y, [&](float z) {
      if (!is_void(z)) sum += z, ++count;
    });
    sample.height = count > 0 ? static_cast<float>(sum / count) : overview_height(overview, x << level, y << level);
    sample.valid = 0;
  }
  sample.water = near.sea(x - near.x, y - near.y);
  sample.smooth = sample.height;
  return sample;
}

/// From a level to the next: tents of weights 1 2 1. `from` has the samples 2 x - 1 to 2 x + 1 of each x.
void halve(RasterView<const TerrainSample> from, RasterView<TerrainSample> out) {
  for (std::int64_t y = 0; y < out.height; ++y)
    for (std::int64_t x = 0; x < out.width; ++x) {
      TerrainSample sum{from(2 * x + 1, 2 * y + 1).height, 0, 0, 0};
      for (std::int64_t j = 0; j < 3; ++j)
        for (std::int64_t i = 0; i < 3; ++i) {
          const float weight = (i == 1 ? 0.5f : 0.25f) * (j == 1 ? 0.5f : 0.25f);
          const TerrainSample& one = from(2 * x + i, 2 * y + j);
          sum.smooth += weight * one.smooth;
          sum.valid += weight * one.valid;
          sum.water += weight * one.water;
        }
      out(x, y) = sum;
    }
}

}  // namespace

int measured_level(const RasterSource& source, std::int64_t measured_cells) {
  const auto* levels = dynamic_cast<const LevelSource*>(&source);
  int level = 0;
  if (levels != nullptr)
    while (level < levels->levels() && levels->level_size(level).cells() > measured_cells) ++level;
  return level;
}

SamplePyramid::SamplePyramid(const RasterSource& source, const Overview& overview, std::int64_t memory_bytes, std::int64_t measured_cells, int threads, Progress& progress)
    : source_(source), overview_(overview), base_(measured_level(source, measured_cells)) {
  if (base_ > 0) levels_ = dynamic_cast<const LevelSource*>(&source);
  int count = 1;
  while (count <= base_ || size(count - 1).width > 17 || size(count - 1).height > 17) ++count;
  kept_.resize(static_cast<std::size_t>(count));
  std::int64_t bytes = 0;
  int first = count - 1;
  for (int level = count - 1; level >= base_; --level) {
    bytes += size(level).cells() * static_cast<std::int64_t>(sizeof(TerrainSample));
    if (bytes <= memory_bytes) first = level;
  }
  for (int level = first; level < count; ++level) {
    const Size cells = size(level);
    Raster<TerrainSample> made(cells.width, cells.height);
    // What is read of the source at once is as large as its tiles are.
    const std::int64_t side = std::max<std::int64_t>(64, 512 >> level);
    const std::int64_t across = (cells.width + side - 1) / side, down = (cells.height + side - 1) / side;
    progress.begin(level == first ? "reading" : "reducing", across * down);
    std::mutex reporting;
    parallel_for(across * down, threads, [&](std::int64_t i) {
      const std::int64_t x = i % across * side, y = i / across * side;
      const Window window{x, y, std::min(side, cells.width - x), std::min(side, cells.height - y)};
      make(level, window, made.view().sub(window));
      const std::lock_guard lock(reporting);
      progress.advance(1);
    });
    progress.end();
    kept_[static_cast<std::size_t>(level)] = std::move(made);
  }
}

Size SamplePyramid::size(int level) const {
  const std::int64_t step = std::int64_t{1} << level;
  const auto samples = [step](std::int64_t cells) { return (cells - 1 + step - 1) / step + 1; };
  return {samples(source_.size().width), samples(source_.size().height)};
}

void SamplePyramid::read(int level, const Window& window, RasterView<TerrainSample> out) const {
  const Raster<TerrainSample>& kept = kept_[static_cast<std::size_t>(level)];
  if (kept.size().cells() == 0) return make(level, window, out);
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x)
      out(x, y) = kept(std::clamp<std::int64_t>(window.x + x, 0, kept.width() - 1), std::clamp<std::int64_t>(window.y + y, 0, kept.height() - 1));
}

void SamplePyramid::read_source(int level, const Window& window, RasterView<TerrainSample> out) const {
  // A level of the source may lack the last row and column.
  const Size all = levels_ != nullptr ? levels_->level_size(level) : source_.size();
  const auto inside = [](std::int64_t at, std::int64_t length) { return std::clamp<std::int64_t>(at, 0, length - 1); };
  // Neighbours, and their neighbours for water.
  Neighbourhood near;
  near.x = inside(window.x - 2, all.width);
  near.y = inside(window.y - 2, all.height);
  const Window read{near.x, near.y, inside(window.x + window.width + 1, all.width) + 1 - near.x, inside(window.y + window.height + 1, all.height) + 1 - near.y};
  near.cells = Raster<float>(read.width, read.height);
  if (levels_ != nullptr) levels_->read_level(level, read, near.cells.view());
  else source_.read(read, near.cells.view());
  near.sea = find_sea(near.cells.view());
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x)
      out(x, y) = describe(near, overview_, level, inside(window.x + x, all.width), inside(window.y + y, all.height));
}

void SamplePyramid::make(int level, const Window& window, RasterView<TerrainSample> out) const {
  if (level <= base_) return read_source(level, window, out);
  // The border is repeated on every level alike: samples inside come first, then those beyond are copies.
  const Size all = size(level);
  const std::int64_t x0 = std::clamp<std::int64_t>(window.x, 0, all.width - 1), x1 = std::clamp<std::int64_t>(window.x + window.width - 1, 0, all.width - 1);
  const std::int64_t y0 = std::clamp<std::int64_t>(window.y, 0, all.height - 1), y1 = std::clamp<std::int64_t>(window.y + window.height - 1, 0, all.height - 1);
  const Window from{2 * x0 - 1, 2 * y0 - 1, 2 * (x1 - x0) + 3, 2 * (y1 - y0) + 3};
  Raster<TerrainSample> samples(from.width, from.height);
  read(level - 1, from, samples.view());
  Raster<TerrainSample> inside(x1 - x0 + 1, y1 - y0 + 1);
  halve(samples.view(), inside.view());
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x)
      out(x, y) = inside(std::clamp(window.x + x, x0, x1) - x0, std::clamp(window.y + y, y0, y1) - y0);
}

}  // namespace arete
