// The wavelet coder of .sct by rate: decoding, one try of encoding, an overview and windows. The terrain is synthetic, or the DEM
// that ARETE_BENCH_DEM names.
#include <cmath>
#include <cstdlib>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/codec/wavelet_encoder.h"
#include "core/support/random.h"
#include "core/synthesis/mountains.h"
#include "core/terrain/fill_voids.h"
#include "gis/dem_file.h"

namespace arete {
namespace {

constexpr int node_side = 256;
constexpr int passes = 2;

const Raster<float>& terrain() {
  static const Raster<float> cells = [] {
    const char* path = std::getenv("ARETE_BENCH_DEM");
    if (!path) return synthesize_mountains({2048, 2048}, {});
    Raster<float> read = read_all(DemReader(path));
    fill_voids(read.view());
    return read;
  }();
  return cells;
}

const ViewSource& source() {
  static const ViewSource view(terrain().view());
  return view;
}

const WaveletPyramid& pyramid() {
  static const WaveletPyramid levels = analyse_raster(source(), NodeGrid(terrain().size(), node_side), {}, 0);
  return levels;
}

/// A step for about so many hundredths of a bit a cell.
float step_of(std::int64_t hundredths) {
  const double wanted = static_cast<double>(hundredths) / 100 * static_cast<double>(terrain().size().cells());
  double fine = 1e-6, coarse = 1e6;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(fine * coarse);
    (pyramid().details.bits(middle) > wanted ? fine : coarse) = middle;
  }
  return static_cast<float>(coarse);
}

struct Tree {
  WaveletSummary summary;
  std::vector<std::vector<std::byte>> nodes;
  Raster<float> read(int level, const Window& window, int threads) const {
    const StreamReader reader = [this](std::int64_t i) { return nodes[static_cast<std::size_t>(i)]; };
    return decode_wavelet(summary.parameters, summary.root, reader, level, window, threads);
  }
  double bits_per_cell() const {
    std::size_t bytes = summary.root.size();
    for (const auto& node : nodes) bytes += node.size();
    return 8.0 * static_cast<double>(bytes) / static_cast<double>(terrain().size().cells());
  }
};

Tree encode_at(std::int64_t hundredths, int threads) {
  Tree tree;
  WaveletEncoding how;
  how.step = step_of(hundredths);
  how.passes = passes;
  how.threads = threads;
  tree.summary = encode_wavelet(pyramid(), how, {[&](std::vector<std::byte> stream) { tree.nodes.push_back(std::move(stream)); },
                                                 [&](std::int64_t index) { return tree.nodes[static_cast<std::size_t>(index)]; }});
  return tree;
}

void report(benchmark::State& state, const Tree& tree, std::int64_t cells) {
  state.counters["bits/cell"] = tree.bits_per_cell();
  state.counters["cells/s"] = benchmark::Counter(static_cast<double>(cells) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void analyse_whole(benchmark::State& state) {
  const NodeGrid grid(terrain().size(), node_side);
  for (auto _ : state) benchmark::DoNotOptimize(analyse_raster(source(), grid, {}, static_cast<int>(state.range(0))).details.count[0]);
  state.counters["cells/s"] =
      benchmark::Counter(static_cast<double>(terrain().size().cells()) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void encode_once(benchmark::State& state) {
  Tree tree;
  for (auto _ : state) tree = encode_at(state.range(0), static_cast<int>(state.range(1)));
  report(state, tree, terrain().size().cells());
}

void decode_level(benchmark::State& state, int level) {
  const Tree tree = encode_at(state.range(0), 0);
  const Size size = tree.summary.parameters.grid.level_size(level);
  for (auto _ : state) benchmark::DoNotOptimize(tree.read(level, {0, 0, size.width, size.height}, static_cast<int>(state.range(1))).data());
  report(state, tree, size.cells());
}

void decode_windows(benchmark::State& state) {
  const Tree tree = encode_at(state.range(0), 0);
  const std::int64_t side = std::min<std::int64_t>({512, terrain().width(), terrain().height()});
  std::uint64_t i = 0;
  for (auto _ : state) {
    const auto x = static_cast<std::int64_t>(uniform_at(1, ++i) * static_cast<double>(terrain().width() - side));
    const auto y = static_cast<std::int64_t>(uniform_at(2, i) * static_cast<double>(terrain().height() - side));
    benchmark::DoNotOptimize(tree.read(0, {x, y, side, side}, static_cast<int>(state.range(1))).data());
  }
  report(state, tree, side * side);
}

/// Hundredths of a bit a cell, by one thread and by two.
void rates(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"centibits", "threads"})->ArgsProduct({{5, 20, 50, 200}, {1, 2}})->UseRealTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK(analyse_whole)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK(encode_once)->Apply(rates);
BENCHMARK_CAPTURE(decode_level, whole, 0)->Apply(rates);
BENCHMARK_CAPTURE(decode_level, overview_of_level_3, 3)->Apply(rates);
BENCHMARK(decode_windows)->Apply(rates);

}  // namespace
}  // namespace arete
