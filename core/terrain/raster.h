#pragma once

#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

namespace arete {

/// Columns and rows.
struct Size {
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::int64_t cells() const { return width * height; }
  bool operator==(const Size&) const = default;
};

/// A rectangle of cells: columns [x, x + width), rows [y, y + height). May reach outside a raster where a function says so.
struct Window {
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t width = 0;
  std::int64_t height = 0;
  Size size() const { return {width, height}; }
  bool operator==(const Window&) const = default;
};

/// A void cell of an elevation raster inside core.
inline constexpr float void_value = std::numeric_limits<float>::quiet_NaN();
inline bool is_void(float elevation) { return std::isnan(elevation); }

/// A window on someone else's cells, row-major, x fastest, row 0 north; `stride` cells from a row to the next.
/// Elevations are in metres unless a function says otherwise; a void cell is NaN.
template <typename T>
struct RasterView {
  T* data = nullptr;
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::int64_t stride = 0;

  T* row(std::int64_t y) const { return data + y * stride; }
  T& operator()(std::int64_t x, std::int64_t y) const {
    assert(x >= 0 && x < width && y >= 0 && y < height);
    return data[y * stride + x];
  }
  Size size() const { return {width, height}; }
  RasterView sub(const Window& w) const {
    assert(w.x >= 0 && w.y >= 0 && w.x + w.width <= width && w.y + w.height <= height);
    return {data + w.y * stride + w.x, w.width, w.height, stride};
  }
  operator RasterView<const T>() const
    requires(!std::is_const_v<T>)
  {
    return {data, width, height, stride};
  }
};

/// Owns width x height cells, contiguous, row-major. Moves, never copies by accident (`clone` copies on purpose).
template <typename T>
class Raster {
 public:
  Raster() = default;
  Raster(std::int64_t width, std::int64_t height)
      : cells_(std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(width * height))), size_{width, height} {}
  Raster(std::int64_t width, std::int64_t height, T value) : Raster(width, height) {
    for (std::int64_t i = 0; i < size_.cells(); ++i) cells_[static_cast<std::size_t>(i)] = value;
  }
  Raster(Raster&& other) noexcept { *this = std::move(other); }
  Raster& operator=(Raster&& other) noexcept {
    cells_ = std::move(other.cells_);
    size_ = std::exchange(other.size_, {});
    return *this;
  }

  Raster clone() const {
    Raster copy(size_.width, size_.height);
    for (std::int64_t i = 0; i < size_.cells(); ++i) copy.data()[i] = data()[i];
    return copy;
  }

  std::int64_t width() const { return size_.width; }
  std::int64_t height() const { return size_.height; }
  Size size() const { return size_; }
  T* data() { return cells_.get(); }
  const T* data() const { return cells_.get(); }
  T& operator()(std::int64_t x, std::int64_t y) { return view()(x, y); }
  const T& operator()(std::int64_t x, std::int64_t y) const { return view()(x, y); }
  RasterView<T> view() { return {cells_.get(), size_.width, size_.height, size_.width}; }
  RasterView<const T> view() const { return {cells_.get(), size_.width, size_.height, size_.width}; }

 private:
  std::unique_ptr<T[]> cells_;
  Size size_;
};

}  // namespace arete
