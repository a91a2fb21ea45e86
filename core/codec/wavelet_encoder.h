#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/codec/wavelet_coder.h"
#include "core/support/scratch.h"
#include "core/terrain/cell_store.h"
#include "core/terrain/raster_io.h"

namespace arete {

// The encoder of the wavelet coder. It works node by node: the raster is read by window, its coarser levels are kept as Scratch says.

/// How large the details of a raster are, as details of norm 1: their number and the sum of their squares, in four bins to an octave of
/// the square.
struct DetailSizes {
  static constexpr std::size_t bins = 1024;
  std::array<double, bins> count{};
  std::array<double, bins> squares{};
  void add(float detail);
  void add(const DetailSizes& other);
  /// The squared error to be expected of a quantiser with this step, roughly: details below about a step are lost, the others err by a
  /// share of it.
  double squared_error(double step) const;
  /// The size to be expected, in bits; rougher.
  double bits(double step) const;
  /// The finest step that the coefficients' range allows (coefficient_limit).
  double least_step() const;
};

/// The low-pass levels of a raster, and its details only measured: they are cheaper to compute again than to keep.
struct WaveletPyramid {
  NodeGrid grid;
  const RasterSource* cells = nullptr;  ///< level 0
  std::vector<CellStore<float>> lows;   ///< [l - 1]: level l
  DetailSizes details;
  /// Samples of a level.
  Raster<float> read(int level, const Window& window) const;
};

/// `cells` must not be void anywhere, and must outlive the result. Keeps 4/3 bytes a cell. `progress` is told how many cells of level 1 and
/// up more there are; it may be empty, and may throw.
WaveletPyramid analyse_raster(const RasterSource& cells, const NodeGrid& grid, const Scratch& scratch, int threads,
                              const std::function<void(std::int64_t)>& progress = {});

struct WaveletEncoding {
  float step = 1;      ///< of the quantiser
  float lambda = 0.2F; ///< bits against distortion in steps squared; 0.2 is near the best
  int passes = 2;      ///< see quantise_node
  int threads = 0;
  std::function<void(std::int64_t)> progress;  ///< told how many nodes more are coded; may be empty, may throw
};

struct WaveletSummary {
  WaveletParameters parameters;
  std::vector<std::byte> root;
  double squared_error = 0;  ///< estimated from the bands, m^2 summed over the cells
};

/// Quantises and codes; a stream is empty where all coefficients are zero. The same bytes for any number of threads. Memory: two rows
/// of nodes of each level, about 6 bytes times the width of the raster times the side of a node.
WaveletSummary encode_wavelet(const WaveletPyramid& pyramid, const WaveletEncoding& how, const NodeStore& nodes);

}  // namespace arete
