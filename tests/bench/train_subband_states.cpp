// Trains the initial states of the coefficient coder: codes the bands of the given DEMs at seven rates each, node by node in
// a mixed order, with states that are kept from node to node, and prints them as core/codec/subband_states.inc.
// Used as: train_subband_states DEM... > core/codec/subband_states.inc

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/codec/subband_models.h"
#include "core/codec/wavelet.h"
#include "core/codec/wavelet_encoder.h"
#include "core/support/random.h"
#include "core/terrain/fill_voids.h"
#include "gis/dem_file.h"

namespace {

using namespace arete;

constexpr int node_side = 256;
constexpr int greatest_count = 20;  // tried 12, 20, 32, 80 on DEMs that were not trained on: flat from 12 to 32

struct Example {
  NodeCoefficients coefficients, parent;
  bool has_parent;
  int origin_x, origin_y;
};

// The root mean square of the finest details.
double detail_spread(const Raster<float>& cells) {
  const std::int64_t w = (cells.width() + 1) / 2, h = (cells.height() + 1) / 2;
  Raster<float> padded(2 * w + 2 * wavelet_reach, 2 * h + 2 * wavelet_reach), low(w, h);
  for (std::int64_t y = 0; y < padded.height(); ++y)
    for (std::int64_t x = 0; x < padded.width(); ++x)
      padded(x, y) = cells(mirrored_index(x - wavelet_reach, cells.width()), mirrored_index(y - wavelet_reach, cells.height()));
  std::array<Raster<float>, band_count> bands;
  for (Raster<float>& band : bands) band = Raster<float>(w, h);
  analyse(padded.view(), low.view(), {bands[0].view(), bands[1].view(), bands[2].view()});
  double squares = 0;
  for (int b = 0; b < band_count; ++b) {
    const Size size = band_size(cells.size(), b);
    for (std::int64_t y = 0; y < size.height; ++y)
      for (std::int64_t x = 0; x < size.width; ++x) squares += std::pow(static_cast<double>(bands[static_cast<std::size_t>(b)](x, y)), 2);
  }
  return std::sqrt(squares / static_cast<double>(cells.size().cells()));
}

void add_examples(const Raster<float>& cells, std::vector<Example>& examples) {
  const ViewSource source(cells.view());
  const WaveletPyramid pyramid = analyse_raster(source, NodeGrid(cells.size(), node_side), {}, 0);
  const NodeGrid& grid = pyramid.grid;
  const double spread = detail_spread(cells);
  for (double factor : {0.12, 0.3, 0.8, 2.0, 5.0, 12.0, 30.0}) {
    WaveletEncoding how;
    how.step = static_cast<float>(spread * factor);
    std::vector<std::vector<std::byte>> streams;
    encode_wavelet(pyramid, how, {[&](std::vector<std::byte> stream) { streams.push_back(std::move(stream)); },
                                  [&](std::int64_t index) { return streams[static_cast<std::size_t>(index)]; }});
    std::vector<NodeCoefficients> nodes(streams.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const NodeAddress node = grid.address(static_cast<std::int64_t>(i));
      const bool has_parent = node.level < grid.levels();
      const NodeCoefficients* parent =
          has_parent ? &nodes[static_cast<std::size_t>(grid.index({node.level + 1, node.x / 2, node.y / 2}))] : nullptr;
      const ParentView view = view_parent(grid, node, parent);
      nodes[i] = blank_coefficients(grid, node);
      if (streams[i].empty()) continue;
      SubbandModels models = initial_subband_models();
      decode_subbands(streams[i], view, models, nodes[i]);
      examples.push_back({nodes[i], has_parent ? *parent : NodeCoefficients{}, has_parent, view.origin_x, view.origin_y});
    }
  }
}

void print(std::int32_t value, int& column) { std::printf("%d,%c", value, ++column % 20 ? ' ' : '\n'); }

std::int32_t pack(const BitModel& model) {
  const int count = std::min(greatest_count, static_cast<int>(model.state & 1023U) / 4);
  return 32 * static_cast<std::int32_t>(std::lround(stretch(std::clamp<Probability>(model.p(), 16, 65520)) / 24.0)) + count;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<Example> examples;
  for (int i = 1; i < argc; ++i) {
    const DemReader dem(argv[i]);
    Raster<float> cells = read_all(dem);
    fill_voids(cells.view());
    add_examples(cells, examples);
  }
  std::vector<std::size_t> order(examples.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [](std::size_t a, std::size_t b) { return hash_position(1, a) < hash_position(1, b); });
  SubbandModels models;  // all probabilities one half
  models.limit = 1000;
  std::size_t bytes = 0;
  for (int round = 0; round < 2; ++round)
    for (std::size_t i : order) {
      const Example& e = examples[i];
      bytes += encode_subbands(e.coefficients, {e.has_parent ? &e.parent : nullptr, e.origin_x, e.origin_y}, models).size();
    }
  std::fprintf(stderr, "%zu nodes, %zu bytes\n", examples.size(), bytes / 2);
  int column = 0;
  visit_models(models, [&](const auto& model) {
    if constexpr (requires { model.state; })
      print(pack(model), column);
    else
      for (std::int32_t weight : model.weights) print(weight, column);
  });
  std::printf("\n");
}
