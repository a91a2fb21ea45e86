#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "core/codec/predictive_encoder.h"
#include "core/support/random.h"
#include "core/synthesis/spectral.h"
#include "tests/data.h"

namespace arete {

/// Fractal terrain in whole units.
inline Raster<std::int32_t> fractal_terrain(std::int64_t width, std::int64_t height, double relief, std::uint64_t seed = 1) {
  SpectralOptions options;
  options.relief_m = relief;
  options.seed = seed;
  const Raster<float> heights = synthesize_spectral({width, height}, options);
  Raster<std::int32_t> terrain(width, height);
  for (std::int64_t i = 0; i < terrain.size().cells(); ++i) terrain.data()[i] = static_cast<std::int32_t>(std::lround(heights.data()[i]));
  return terrain;
}

/// Gabilan Mesa in centimetres (it is stored as whole ones), 921 x 859; empty where the data is absent.
inline Raster<std::int32_t> gabilan_centimetres() {
  const std::string path = test_data("gabilan_lidar_1m.bil");
  if (path.empty()) return {};
  Raster<std::int32_t> terrain(921, 859);
  std::ifstream in(path, std::ios::binary);
  std::vector<float> heights(static_cast<std::size_t>(terrain.size().cells()));
  in.read(reinterpret_cast<char*>(heights.data()), static_cast<std::streamsize>(heights.size() * sizeof(float)));
  for (std::size_t i = 0; i < heights.size(); ++i) terrain.data()[i] = static_cast<std::int32_t>(std::lround(100.0 * heights[i]));
  return terrain;
}

/// Voids (1): everything beyond a disc, holes inside it, and single cells.
inline Raster<std::uint8_t> ragged_mask(std::int64_t width, std::int64_t height) {
  Raster<std::uint8_t> voids(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      const double dx = (x + 0.5) / width - 0.5, dy = (y + 0.5) / height - 0.5;
      const bool inside = dx * dx + dy * dy < 0.2;
      const bool hole = std::sin(x * 0.11) * std::sin(y * 0.07) > 0.9 || uniform_at(9, x, y) < 0.002;
      voids(x, y) = !inside || hole;
    }
  return voids;
}

/// The mask of a level as VoidReader wants it; `voids` must outlive the result.
inline VoidReader void_reader(const Raster<std::uint8_t>& voids) {
  return [&voids](int level, const Window& window) {
    Raster<std::uint8_t> part(window.width, window.height);
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) part(x, y) = voids((window.x + x) << level, (window.y + y) << level);
    return part;
  };
}

/// A raster as predictive streams in memory.
struct PredictiveStreams {
  NodeGrid grid;
  PredictParameters parameters;
  std::vector<std::byte> root;
  std::vector<std::vector<std::byte>> nodes;
  std::int64_t bytes() const {
    std::size_t sum = root.size() + encode_parameters(parameters).size();
    for (const auto& node : nodes) sum += node.size();
    return static_cast<std::int64_t>(sum);
  }
};

/// Numbers in memory; `voids` data null: none.
class NumbersInMemory final : public NumberSource {
 public:
  NumbersInMemory(RasterView<const std::int32_t> values, RasterView<const std::uint8_t> voids) : values_(values), voids_(voids) {}
  Size size() const override { return values_.size(); }
  bool any_void() const override { return voids_.data != nullptr; }
  void read(const Window& window, RasterView<std::int32_t> values, RasterView<std::uint8_t> voids) const override {
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) {
        values(x, y) = values_(window.x + x, window.y + y);
        if (voids.data != nullptr) voids(x, y) = voids_(window.x + x, window.y + y);
      }
  }

 private:
  RasterView<const std::int32_t> values_;
  RasterView<const std::uint8_t> voids_;
};

inline PredictiveStreams encode_streams(RasterView<const std::int32_t> values, RasterView<const std::uint8_t> voids, const NodeGrid& grid,
                                        const PredictiveEncoding& how) {
  PredictiveStreams streams{grid, {}, {}, {}};
  const NodeStore store{[&](std::vector<std::byte> stream) { streams.nodes.push_back(std::move(stream)); }, {}};
  PredictiveSummary summary = encode_predictive(NumbersInMemory(values, voids), grid, how, store);
  streams.parameters = std::move(summary.parameters);
  streams.root = std::move(summary.root);
  return streams;
}


inline Raster<std::int32_t> decode(const PredictiveStreams& streams, int level, const Window& window, const VoidReader& voids = {},
                                   int threads = 1) {
  return decode_predictive(streams.grid, streams.parameters, streams.root,
                           [&](std::int64_t i) { return streams.nodes[static_cast<std::size_t>(i)]; }, voids, level, window, threads);
}

/// The largest |a - b| where `voids` (data null: nowhere) is 0.
inline std::int64_t largest_difference(RasterView<const std::int32_t> a, RasterView<const std::int32_t> b,
                                       RasterView<const std::uint8_t> voids = {}) {
  std::int64_t largest = 0;
  for (std::int64_t y = 0; y < a.height; ++y)
    for (std::int64_t x = 0; x < a.width; ++x)
      if (voids.data == nullptr || voids(x, y) == 0)
        largest = std::max(largest, std::abs(std::int64_t{a(x, y)} - std::int64_t{b(x, y)}));
  return largest;
}

}  // namespace arete
