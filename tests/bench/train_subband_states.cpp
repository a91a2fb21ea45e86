// Trains the initial states of the coefficient coder: codes the bands of the given DEMs at seven rates each, node by node in
// a mixed order, with states that are kept from node to node, and prints them as core/codec/subband_states.inc.
// Used as: train_subband_states DEM... > core/codec/subband_states.inc

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/codec/subband_models.h"
#include "core/codec/wavelet_coder.h"
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

void add_examples(const Raster<float>& cells, std::vector<Example>& examples) {
  const WaveletPyramid pyramid = analyse_raster(cells.view(), NodeGrid(cells.size(), node_side), 0);
  const NodeGrid& grid = pyramid.grid;
  double squares = 0;
  for (const Raster<float>& band : pyramid.bands[0])
    for (std::int64_t i = 0; i < band.size().cells(); ++i) squares += static_cast<double>(band.data()[i]) * band.data()[i];
  const double spread = std::sqrt(squares / static_cast<double>(cells.size().cells()));
  for (double factor : {0.12, 0.3, 0.8, 2.0, 5.0, 12.0, 30.0}) {
    const WaveletStreams streams = encode_wavelet(pyramid, static_cast<float>(spread * factor), 0.2F, 2, 0);
    std::vector<NodeCoefficients> nodes(streams.nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const NodeAddress node = grid.address(static_cast<std::int64_t>(i));
      const bool has_parent = node.level < grid.levels();
      const NodeCoefficients* parent =
          has_parent ? &nodes[static_cast<std::size_t>(grid.index({node.level + 1, node.x / 2, node.y / 2}))] : nullptr;
      const ParentView view = view_parent(grid, node, parent);
      nodes[i] = blank_coefficients(grid, node);
      if (streams.nodes[i].empty()) continue;
      SubbandModels models = initial_subband_models();
      decode_subbands(streams.nodes[i], view, models, nodes[i]);
      examples.push_back({nodes[i], has_parent ? *parent : NodeCoefficients{}, has_parent, view.origin_x, view.origin_y});
    }
  }
}

template <class Array>
void print(const Array& models, int& column) {
  for (const auto& model : models) {
    if constexpr (requires { model.state; }) {
      const int count = std::min(greatest_count, static_cast<int>(model.state & 1023U) / 4);
      const int logit = static_cast<int>(std::lround(stretch(std::clamp<Probability>(model.p(), 16, 65520)) / 24.0));
      std::printf("%d,%c", 32 * logit + count, ++column % 20 ? ' ' : '\n');
    } else if constexpr (requires { model.weights; }) {
      for (std::int32_t weight : model.weights) std::printf("%d,%c", weight, ++column % 20 ? ' ' : '\n');
    } else {
      print(model, column);
    }
  }
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
  print(models.energy, column);
  print(models.local, column);
  print(models.exponent, column);
  print(models.mantissa, column);
  print(models.sign_mean, column);
  print(models.sign_pattern, column);
  print(models.block, column);
  print(models.mixer, column);
  print(models.sign_mixer, column);
  std::printf("\n");
}
