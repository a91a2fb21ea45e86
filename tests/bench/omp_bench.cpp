// Sparse coding: signals per second, and the bytes of signals read per second beside a plain copy of memory.
#include <cstring>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/sparse/omp.h"
#include "core/support/parallel.h"
#include "core/support/random.h"

namespace {

using namespace arete;

Eigen::MatrixXf random_matrix(std::int64_t rows, std::int64_t columns, std::uint64_t seed) {
  Eigen::MatrixXf values(rows, columns);
  for (std::int64_t j = 0; j < columns; ++j)
    for (std::int64_t i = 0; i < rows; ++i) values(i, j) = static_cast<float>(uniform_at(seed, i, j) - 0.5);
  return values;
}

// Arguments: K, N, s, signals.
void code_signals(benchmark::State& state) {
  const Eigen::MatrixXf D = random_matrix(state.range(0), state.range(1), 1).colwise().normalized();
  const Eigen::MatrixXf F = random_matrix(state.range(0), state.range(3), 2);
  const int sparsity = static_cast<int>(state.range(2));
  const CodingDictionary dictionary = prepare_coding(D, sparsity);
  for (auto _ : state) benchmark::DoNotOptimize(omp(dictionary, F, sparsity).atoms.data());
  state.SetItemsProcessed(state.iterations() * F.cols());
  state.SetBytesProcessed(state.iterations() * F.size() * 4);
}
BENCHMARK(code_signals)
    ->ArgNames({"K", "N", "s", "n"})
    ->Args({64, 128, 1, 100000})
    ->Args({64, 128, 2, 100000})
    ->Args({64, 128, 8, 100000})
    ->Args({256, 512, 4, 20000})
    ->Args({256, 1024, 1, 20000})
    ->MeasureProcessCPUTime()  // of all threads: what a busy machine still tells
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// The bandwidth that the others are compared with: a copy of 256 MiB by the same threads.
void copy_memory(benchmark::State& state) {
  constexpr std::size_t bytes = 256 << 20, piece = 1 << 20;
  std::vector<char> from(bytes, 1), to(bytes, 2);
  for (auto _ : state) {
    parallel_for(bytes / piece, 0, [&](std::int64_t i) {
      const auto at = static_cast<std::size_t>(i) * piece;
      std::memcpy(&to[at], &from[at], piece);
    });
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}
BENCHMARK(copy_memory)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
