// Amplification, files excluded: 32 x 32 to 8192 x 8192 in four stages of 4, as the published table; and one stage alone.
#include <cstring>

#include <benchmark/benchmark.h>

#include "core/amplify/amplify.h"
#include "core/amplify/detail.h"
#include "core/sparse/patches.h"
#include "core/support/random.h"
#include "core/synthesis/mountains.h"
#include "core/terrain/resample.h"

namespace arete {
namespace {

/// Counts cells and keeps none.
class CountingSink final : public RasterSink {
 public:
  void write(int, const Window& window, RasterView<const float> cells) override {
    cells_ += window.width * window.height;
    benchmark::DoNotOptimize(cells.data);
  }
  std::int64_t cells() const { return cells_; }

 private:
  std::int64_t cells_ = 0;
};

const Raster<float>& exemplar() {
  static const Raster<float> cells = synthesize_mountains({1024, 1024}, {});
  return cells;
}

/// `atoms` patches drawn from all of the exemplar's, with both halves.
Dictionary sample_dictionary(int patch_cells, int atoms, bool detail) {
  Dictionary dictionary;
  dictionary.patch_cells = patch_cells;
  dictionary.factor = 4;
  const Raster<float> coarse = area_average(exemplar().view(), 4);
  const Patches patches = extract_patches(coarse.view(), make_patch_grid(patch_cells, 1), {PatchEdges::inside, atoms > 50'000, true, 0});
  std::vector<Eigen::Index> drawn;
  for (Eigen::Index i = 0; i < patches.count(); ++i)
    if (uniform_at(1, static_cast<std::uint64_t>(i)) * static_cast<double>(patches.count()) < atoms) drawn.push_back(i);
  dictionary.low = patches.values(Eigen::all, drawn).colwise().normalized();
  const int side = patch_cells * 4;
  dictionary.high.resize(side * side, dictionary.low.cols());
  for (std::size_t j = 0; j < drawn.size(); ++j) {
    const PatchOrigin& o = patches.origins[static_cast<std::size_t>(drawn[j])];
    auto atom = dictionary.high.col(static_cast<Eigen::Index>(j));
    cut_cells(exemplar().view(), o.x * 4, o.y * 4, side, o.symmetry, atom.data());
    atom.array() -= static_cast<float>(patches.means[static_cast<std::size_t>(drawn[j])]);
    atom /= patches.values.col(drawn[j]).norm();
    dictionary.sources.push_back({0, o.x, o.y, 0});
  }
  NoProgress silent;
  if (detail) add_detail(dictionary, {exemplar().view()}, 0, silent);
  return dictionary;
}

void amplify_stages(benchmark::State& state, AmplifyMethod method, int side, int factor, int atoms) {
  const Raster<float> input = area_average(exemplar().view().sub({0, 0, 1024, 1024}), 1024 / side);
  const Dictionary dictionary = sample_dictionary(method == AmplifyMethod::paper ? 8 : 6, atoms, method != AmplifyMethod::paper);
  CountingSink sink;
  for (auto _ : state) {
    NoProgress silent;
    AmplifyOptions options;
    options.method = method;
    options.factor = factor;
    options.memory_bytes = std::int64_t{4} << 30;
    amplify(ViewSource(input.view()), dictionary, options, sink, silent);
  }
  state.counters["cells/s"] = benchmark::Counter(static_cast<double>(sink.cells()), benchmark::Counter::kIsRate);
}

void copy_memory(benchmark::State& state) {
  const std::size_t bytes = std::size_t{256} << 20;
  const std::vector<char> from(bytes, 1);
  std::vector<char> to(bytes, 2);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), bytes);
    benchmark::ClobberMemory();
  }
  state.counters["cells/s"] = benchmark::Counter(static_cast<double>(bytes / 4) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

BENCHMARK(copy_memory)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(amplify_stages, paper_four_stages_of_4_from_32, AmplifyMethod::paper, 32, 256, 256)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(amplify_stages, paper_four_stages_of_4_from_32_complete_dictionary_of_120000, AmplifyMethod::paper, 32, 256, 120'000)
    ->UseRealTime()->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(amplify_stages, consistent_four_stages_of_4_from_32, AmplifyMethod::consistent, 32, 256, 256)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(amplify_stages, paper_one_stage_of_4_from_1024, AmplifyMethod::paper, 1024, 4, 256)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(amplify_stages, consistent_one_stage_of_4_from_1024, AmplifyMethod::consistent, 1024, 4, 256)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace arete
