#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include "core/support/scratch.h"
#include "core/terrain/raster.h"

namespace arete {

/// A raster that is written and read by window, in memory or, where it is larger than the limit, in a file without a name. Cells
/// that were never written are 0. Windows lie inside. Windows that do not overlap may be written from several threads at once, any
/// may be read. Throws as ScratchBytes.
template <class T>
class CellStore {
 public:
  CellStore() = default;
  CellStore(const Size& size, const Scratch& scratch, std::int64_t limit_bytes) : size_(size), bytes_(scratch, limit_bytes) {
    bytes_.resize(static_cast<std::uint64_t>(size.cells()) * sizeof(T));
  }
  const Size& size() const { return size_; }
  bool in_memory() const { return bytes_.in_memory(); }

  void write(const Window& window, RasterView<const T> cells) {
    for (std::int64_t y = 0; y < window.height; ++y)
      bytes_.write(position(window, y), std::as_bytes(std::span(cells.row(y), static_cast<std::size_t>(window.width))));
  }
  void read(const Window& window, RasterView<T> cells) const {
    for (std::int64_t y = 0; y < window.height; ++y)
      bytes_.read(position(window, y), std::as_writable_bytes(std::span(cells.row(y), static_cast<std::size_t>(window.width))));
  }
  Raster<T> read(const Window& window) const {
    Raster<T> cells(window.width, window.height);
    read(window, cells.view());
    return cells;
  }

 private:
  std::uint64_t position(const Window& window, std::int64_t y) const {
    return static_cast<std::uint64_t>((window.y + y) * size_.width + window.x) * sizeof(T);
  }
  Size size_;
  ScratchBytes bytes_;
};

}  // namespace arete
