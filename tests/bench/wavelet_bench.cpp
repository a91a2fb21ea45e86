// The wavelet coder of .sct by rate: decoding, one try of encoding, an overview and windows. The terrain is synthetic, or the DEM
// that ARETE_BENCH_DEM names.
#include <cmath>
#include <cstdlib>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/codec/wavelet_coder.h"
#include "core/support/random.h"
#include "core/synthesis/mountains.h"
#include "core/terrain/fill_voids.h"
#include "gis/dem_file.h"

namespace arete {
namespace {

constexpr int node_side = 256;
constexpr float lambda = 0.2F;
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

const WaveletPyramid& pyramid() {
  static const WaveletPyramid bands = analyse_raster(terrain().view(), NodeGrid(terrain().size(), node_side), 0);
  return bands;
}

/// A step in hundredths of the spread of the finest details, so that the rates are about the same for any terrain.
float step_of(std::int64_t hundredths) {
  double squares = 0;
  for (const Raster<float>& band : pyramid().bands[0])
    for (std::int64_t i = 0; i < band.size().cells(); ++i) squares += std::pow(static_cast<double>(band.data()[i]), 2);
  return static_cast<float>(std::sqrt(squares / static_cast<double>(terrain().size().cells())) * static_cast<double>(hundredths) / 100);
}

struct Tree {
  WaveletStreams streams;
  Raster<float> read(int level, const Window& window, int threads) const {
    const StreamReader reader = [this](std::int64_t i) { return streams.nodes[static_cast<std::size_t>(i)]; };
    return decode_wavelet(streams.parameters, streams.root, reader, level, window, threads);
  }
  double bits_per_cell() const { return 8.0 * static_cast<double>(streams.bytes()) / static_cast<double>(terrain().size().cells()); }
};

Tree encode_at(std::int64_t hundredths) { return {encode_wavelet(pyramid(), step_of(hundredths), lambda, passes, 0)}; }

void report(benchmark::State& state, const Tree& tree, std::int64_t cells) {
  state.counters["bits/cell"] = tree.bits_per_cell();
  state.counters["cells/s"] = benchmark::Counter(static_cast<double>(cells) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void analyse_whole(benchmark::State& state) {
  const NodeGrid grid(terrain().size(), node_side);
  for (auto _ : state) benchmark::DoNotOptimize(analyse_raster(terrain().view(), grid, static_cast<int>(state.range(0))));
  state.counters["cells/s"] =
      benchmark::Counter(static_cast<double>(terrain().size().cells()) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void encode_once(benchmark::State& state) {
  const float step = step_of(state.range(0));
  Tree tree;
  for (auto _ : state) tree.streams = encode_wavelet(pyramid(), step, lambda, passes, static_cast<int>(state.range(1)));
  report(state, tree, terrain().size().cells());
}

void decode_level(benchmark::State& state, int level) {
  const Tree tree = encode_at(state.range(0));
  const Size size = tree.streams.parameters.grid.level_size(level);
  for (auto _ : state) benchmark::DoNotOptimize(tree.read(level, {0, 0, size.width, size.height}, static_cast<int>(state.range(1))).data());
  report(state, tree, size.cells());
}

void decode_windows(benchmark::State& state) {
  const Tree tree = encode_at(state.range(0));
  const std::int64_t side = std::min<std::int64_t>({512, terrain().width(), terrain().height()});
  std::uint64_t i = 0;
  for (auto _ : state) {
    const auto x = static_cast<std::int64_t>(uniform_at(1, ++i) * static_cast<double>(terrain().width() - side));
    const auto y = static_cast<std::int64_t>(uniform_at(2, i) * static_cast<double>(terrain().height() - side));
    benchmark::DoNotOptimize(tree.read(0, {x, y, side, side}, static_cast<int>(state.range(1))).data());
  }
  report(state, tree, side * side);
}

/// Steps from fine to coarse, by one thread and by two.
void rates(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"step", "threads"})->ArgsProduct({{30, 100, 400, 2000}, {1, 2}})->UseRealTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK(analyse_whole)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK(encode_once)->Apply(rates);
BENCHMARK_CAPTURE(decode_level, whole, 0)->Apply(rates);
BENCHMARK_CAPTURE(decode_level, overview_of_level_3, 3)->Apply(rates);
BENCHMARK(decode_windows)->Apply(rates);

}  // namespace
}  // namespace arete
