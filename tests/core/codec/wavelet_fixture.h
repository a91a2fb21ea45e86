#pragma once

#include "core/codec/wavelet_encoder.h"

namespace arete {

/// A raster as wavelet streams in memory.
struct WaveletStreams {
  WaveletParameters parameters;
  std::vector<std::byte> root;
  std::vector<std::vector<std::byte>> nodes;
  double squared_error = 0;
};

inline NodeStore store_in(std::vector<std::vector<std::byte>>& nodes) {
  return {[&nodes](std::vector<std::byte> stream) { nodes.push_back(std::move(stream)); },
          [&nodes](std::int64_t index) { return nodes[static_cast<std::size_t>(index)]; }};
}

inline WaveletStreams encode_wavelet_streams(RasterView<const float> cells, int side, float step, int threads = 1, const Scratch& scratch = {}) {
  const ViewSource source(cells);
  const WaveletPyramid pyramid = analyse_raster(source, NodeGrid(cells.size(), side), scratch, threads);
  WaveletEncoding how;
  how.step = step;
  how.passes = 1;
  how.threads = threads;
  WaveletStreams streams;
  WaveletSummary summary = encode_wavelet(pyramid, how, store_in(streams.nodes));
  streams.parameters = summary.parameters;
  streams.root = std::move(summary.root);
  streams.squared_error = summary.squared_error;
  return streams;
}

}  // namespace arete
