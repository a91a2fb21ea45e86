// Learning 256 atoms of 8 x 8 cells from 32,768 patches of the Davos SRTM tile: time, and the objective relative to the energy.
#include <benchmark/benchmark.h>

#include "core/sparse/constrained.h"
#include "core/sparse/ksvd.h"
#include "core/sparse/learning_steps.h"
#include "core/sparse/patches.h"
#include "gis/dem_file.h"
#include "tests/data.h"

namespace {

using namespace arete;

const Eigen::MatrixXf& training_patches() {
  static const Eigen::MatrixXf F = [] {
    PatchOptions options;
    options.leave_out_flat = true;
    const Eigen::MatrixXf all =
        extract_patches(read_all(DemReader(test_data("davos_srtm1_1arcsec.tif"))).view(), PatchGrid{8, 6, disc_weights(8)}, options).values;
    Eigen::MatrixXf some(all.rows(), 32768);
    Eigen::Index i = 0;
    for (const std::int64_t column : choose_columns(all.cols(), some.cols(), 1)) some.col(i++) = all.col(column);
    return some;
  }();
  return F;
}

void report(benchmark::State& state, const std::vector<double>& objective) {
  state.counters["iterations"] = static_cast<double>(objective.size()) - 1;
  state.counters["relative_objective"] = objective.back() / training_patches().cast<double>().squaredNorm();
}

// Arguments: sparsity, exhaustive.
void constrained(benchmark::State& state) {
  const Eigen::MatrixXf& F = training_patches();
  NoProgress progress;
  for (auto _ : state) {
    ConstrainedOptions options;
    options.sparsity = static_cast<int>(state.range(0));
    options.exhaustive = state.range(1) != 0;
    report(state, learn_constrained(F, options, progress).objective);
  }
}
BENCHMARK(constrained)
    ->ArgNames({"s", "exhaustive"})->Args({1, 0})->Args({1, 1})->Args({2, 0})->Iterations(1)->UseRealTime()->Unit(benchmark::kMillisecond);

// Arguments: sparsity, exact update.
void ksvd(benchmark::State& state) {
  const Eigen::MatrixXf& F = training_patches();
  NoProgress progress;
  for (auto _ : state) {
    KsvdOptions options;
    options.atoms = 256;
    options.sparsity = static_cast<int>(state.range(0));
    options.exact_update = state.range(1) != 0;
    report(state, learn_ksvd(F, options, progress).objective);
  }
}
BENCHMARK(ksvd)
    ->ArgNames({"s", "exact"})->Args({1, 0})->Args({1, 1})->Args({2, 0})->Iterations(1)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
