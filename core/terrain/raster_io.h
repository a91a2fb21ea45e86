#pragma once

#include "core/terrain/raster.h"

namespace arete {

/// Elevations that can be read by window: a file, an array, or another terrain evaluated on demand.
class RasterSource {
 public:
  virtual ~RasterSource() = default;
  virtual Size size() const = 0;
  /// Fills `out` (window.width x window.height) with metres, NaN where void. The window lies inside the raster.
  /// The values do not depend on the window they are read by. Safe to call from several threads.
  virtual void read(const Window& window, RasterView<float> out) const = 0;
};

/// Elevations at several resolutions. Level 0 is the raster; cell i of level l stands for cell 2^l i of it, as detailed as cells so far apart can be.
class LevelSource : public RasterSource {
 public:
  /// Levels 0 to levels().
  virtual int levels() const = 0;
  virtual Size level_size(int level) const = 0;
  /// As read(), of a level. The window lies inside that level.
  virtual void read_level(int level, const Window& window, RasterView<float> out) const = 0;
  Size size() const final { return level_size(0); }
  void read(const Window& window, RasterView<float> out) const final { read_level(0, window, out); }
};

/// A level of another source, which must outlive it.
class SourceLevel final : public RasterSource {
 public:
  SourceLevel(const LevelSource& source, int level) : source_(source), level_(level) {}
  Size size() const override { return source_.level_size(level_); }
  void read(const Window& window, RasterView<float> out) const override { source_.read_level(level_, window, out); }

 private:
  const LevelSource& source_;
  int level_;
};

/// Takes the windows of a result as they are finished, from one thread at a time, each cell of each band once.
class RasterSink {
 public:
  virtual ~RasterSink() = default;
  /// `band` counts from 0. Elevations in metres, NaN where void.
  virtual void write(int band, const Window& window, RasterView<const float> cells) = 0;
};

/// Reads from cells in memory. The view must outlive the source.
class ViewSource final : public RasterSource {
 public:
  explicit ViewSource(RasterView<const float> cells) : cells_(cells) {}
  Size size() const override { return cells_.size(); }
  void read(const Window& window, RasterView<float> out) const override {
    const RasterView<const float> from = cells_.sub(window);
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) out(x, y) = from(x, y);
  }

 private:
  RasterView<const float> cells_;
};

/// A window of another source, which must outlive it.
class CroppedSource final : public RasterSource {
 public:
  CroppedSource(const RasterSource& source, const Window& window) : source_(source), window_(window) {}
  Size size() const override { return window_.size(); }
  void read(const Window& window, RasterView<float> out) const override {
    source_.read({window_.x + window.x, window_.y + window.y, window.width, window.height}, out);
  }

 private:
  const RasterSource& source_;
  Window window_;
};

/// Writes band 0 to cells in memory; other bands are dropped.
class ViewSink final : public RasterSink {
 public:
  explicit ViewSink(RasterView<float> cells) : cells_(cells) {}
  void write(int band, const Window& window, RasterView<const float> from) override {
    if (band != 0) return;
    const RasterView<float> to = cells_.sub(window);
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) to(x, y) = from(x, y);
  }

 private:
  RasterView<float> cells_;
};

/// The whole of a source in memory.
inline Raster<float> read_all(const RasterSource& source) {
  const Size size = source.size();
  Raster<float> cells(size.width, size.height);
  source.read({0, 0, size.width, size.height}, cells.view());
  return cells;
}

}  // namespace arete
