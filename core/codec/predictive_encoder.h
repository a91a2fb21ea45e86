#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/codec/predictive_coder.h"
#include "core/support/scratch.h"

namespace arete {

// The encoder of the predictive coder. It works node by node: the raster is read by window, its coarser levels are kept as Scratch
// says.

/// A raster of whole numbers, read by window. Safe to call from several threads.
class NumberSource {
 public:
  virtual ~NumberSource() = default;
  virtual Size size() const = 0;
  virtual bool any_void() const = 0;
  /// Values of void cells do not matter. `voids` (data null where none is) is 1 where a cell is void.
  virtual void read(const Window& window, RasterView<std::int32_t> values, RasterView<std::uint8_t> voids) const = 0;
};

struct PredictiveEncoding {
  std::int32_t step = 1;  ///< 1 to 2^24. Decoded minus true is in [-(step - 1 - step / 2), step / 2]
  /// The step of level l >= 1 is step x coarse_step[min(l, size) - 1] / 256, 1 at least: finer where others are predicted from.
  std::vector<int> coarse_step;
  int threads = 0;
  Scratch scratch;
  std::function<void(std::int64_t)> progress;  ///< told how many nodes more are coded, 0 while levels are read; may be empty, may throw
};

struct PredictiveSummary {
  PredictParameters parameters;
  std::vector<std::byte> root;
};

/// Encodes a raster; a stream is empty where all residuals are zero. The same bytes for any number of threads. Keeps 4/3 bytes a
/// cell, 5/3 with voids.
PredictiveSummary encode_predictive(const NumberSource& source, const NodeGrid& grid, const PredictiveEncoding& how, const NodeStore& nodes);

}  // namespace arete
