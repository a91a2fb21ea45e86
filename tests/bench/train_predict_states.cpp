// Trains the initial states of the coder of residuals: codes the given DEMs at several bounds each, node by node in a mixed
// order, with states that are kept from node to node, and prints them as core/codec/predict_states.inc.
// Used as: train_predict_states DEM... > core/codec/predict_states.inc

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "core/codec/value_map.h"
#include "core/support/random.h"
#include "gis/dem_file.h"
#include "tests/core/codec/predict_fixture.h"

namespace {

using namespace arete;

constexpr int node_side = 256;
constexpr int greatest_count = 31;  // what the table holds; the gain from 31 to 100 is 0.03 %

// A DEM as it was decoded: coding it again gives the same residuals.
struct Coded {
  NodeGrid grid;
  PredictParameters parameters;
  std::vector<Raster<std::int32_t>> levels;
  std::vector<Raster<std::uint8_t>> voids;
};

struct Example {
  std::size_t dem;
  NodeAddress node;
};

template <typename T>
std::vector<Raster<T>> take_levels(const Raster<T>& finest, const NodeGrid& grid) {
  std::vector<Raster<T>> levels;
  for (int l = 0; l <= grid.levels(); ++l) {
    const Size size = grid.level_size(l);
    Raster<T> level(size.width, size.height);
    for (std::int64_t y = 0; y < size.height; ++y)
      for (std::int64_t x = 0; x < size.width; ++x) level(x, y) = finest(x << l, y << l);
    levels.push_back(std::move(level));
  }
  return levels;
}

Coded code_dem(const Raster<double>& values, ValueType type, double max_error) {
  const StoredValues stored(values.data(), static_cast<std::size_t>(values.size().cells()));
  StoredRange range;
  range.add(stored);
  ValueSurvey survey(type, range);
  survey.add(stored);
  const std::optional<BoundedMap> map = map_within(survey, max_error);
  Raster<std::int32_t> numbers(values.width(), values.height());
  Raster<std::uint8_t> voids(values.width(), values.height());
  for (std::int64_t i = 0; i < numbers.size().cells(); ++i) {
    voids.data()[i] = std::isnan(values.data()[i]);
    numbers.data()[i] = voids.data()[i] != 0 ? 0 : map->map.number_of(values.data()[i]);
  }
  PredictiveEncoding how;
  how.step = map->step;
  const PredictiveStreams streams = encode_streams(numbers.view(), voids.view(), NodeGrid(values.size(), node_side), how);
  const Raster<std::int32_t> decoded = decode(streams, 0, {0, 0, values.width(), values.height()}, void_reader(voids));
  return {streams.grid, streams.parameters, take_levels(decoded, streams.grid), take_levels(voids, streams.grid)};
}

std::size_t learn(const Coded& dem, const NodeAddress& node, ResidualModels& models) {
  const auto l = static_cast<std::size_t>(node.level);
  const LevelView coarse{dem.levels[l].view(), dem.voids[l].view(), 0, 0, dem.grid.level_size(node.level)};
  const Window cells = dem.grid.cells(node);
  Raster<std::int32_t> decoded(cells.width, cells.height);
  return encode_node(coarse, cells, dem.parameters, dem.parameters.levels[l - 1],
                     {dem.levels[l - 1].view().sub(cells), dem.voids[l - 1].view().sub(cells)}, models, decoded.view())
      .size();
}

// The mean difference of a cell from the mean of its diagonal neighbours: what a coarser level does not say.
double mean_detail(const Raster<double>& values) {
  double sum = 0;
  std::int64_t count = 0;
  for (std::int64_t y = 1; y + 1 < values.height(); ++y)
    for (std::int64_t x = 1; x + 1 < values.width(); ++x) {
      const double around = values(x - 1, y - 1) + values(x + 1, y - 1) + values(x - 1, y + 1) + values(x + 1, y + 1);
      const double difference = std::abs(values(x, y) - around / 4);
      if (!std::isnan(difference)) sum += difference, ++count;
    }
  return sum / static_cast<double>(count);
}

class Printer {
 public:
  void print(const BitModel& model) {
    const int count = std::min(greatest_count, static_cast<int>(model.state & 1023U) / 4);
    put(32 * static_cast<int>(std::lround(stretch(std::clamp<Probability>(model.p(), 16, 65520)) / 24.0)) + count);
  }
  template <int count>
  void print(const BitMixer<count>& mixer) {
    for (std::int32_t weight : mixer.weights) put(weight);
  }
  template <class T, std::size_t size>
  void print(const std::array<T, size>& parts) {
    for (const T& part : parts) print(part);
  }

 private:
  void put(int number) { std::printf("%d,%c", number, ++column_ % 20 ? ' ' : '\n'); }
  int column_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  std::vector<Coded> dems;
  for (int i = 1; i < argc; ++i) {
    const DemReader dem(argv[i]);
    Raster<double> values(dem.size().width, dem.size().height);
    dem.read_stored({0, 0, values.width(), values.height()}, values.view());
    const double scale = mean_detail(values);
    for (double factor : {0.1, 0.25, 0.6, 1.5, 3.0, 6.0}) dems.push_back(code_dem(values, dem.value_type(), scale * factor));
  }
  std::vector<Example> examples;
  for (std::size_t d = 0; d < dems.size(); ++d)
    for (std::int64_t i = 0; i < dems[d].grid.node_count(); ++i) examples.push_back({d, dems[d].grid.address(i)});
  const auto key = [&](const Example& e) { return hash_position(e.dem, static_cast<std::uint64_t>(dems[e.dem].grid.index(e.node))); };
  std::sort(examples.begin(), examples.end(), [&](const Example& a, const Example& b) { return key(a) < key(b); });
  ResidualModels models;  // all probabilities one half
  models.limit = 1000;
  std::size_t bytes = 0;
  for (int round = 0; round < 2; ++round)
    for (const Example& e : examples) bytes += learn(dems[e.dem], e.node, models);
  std::fprintf(stderr, "%zu nodes, %zu bytes\n", examples.size(), bytes / 2);
  Printer printer;
  for_each_state(models, [&](const auto& part) { printer.print(part); });
  std::printf("\n");
}
