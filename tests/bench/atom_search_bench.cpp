// The complete dictionary: every 8 x 8 patch of the Davos SRTM tile at pitch 6 (129,000 atoms), signals from other terrain.
#include <string>

#include <benchmark/benchmark.h>

#include "core/sparse/atom_search.h"
#include "core/sparse/patches.h"
#include "core/support/parallel.h"
#include "gis/dem_file.h"
#include "tests/data.h"

namespace {

using namespace arete;

Eigen::MatrixXf patches_of(const std::string& name, int pitch) {
  PatchOptions options;
  options.leave_out_flat = true;
  return extract_patches(read_all(DemReader(test_data(name))).view(), PatchGrid{8, pitch, disc_weights(8)}, options).values;
}

const Eigen::MatrixXf& complete_dictionary() {
  static const Eigen::MatrixXf D = patches_of("davos_srtm1_1arcsec.tif", 6).colwise().normalized();
  return D;
}

void index_atoms(benchmark::State& state) {
  const Eigen::MatrixXf& D = complete_dictionary();
  for (auto _ : state) benchmark::DoNotOptimize(AtomSearch(D).atoms());
  state.SetItemsProcessed(state.iterations() * D.cols());
}
BENCHMARK(index_atoms)->UseRealTime()->Unit(benchmark::kMillisecond);

template <typename Find>
void run(benchmark::State& state, const Eigen::MatrixXf& F, const Find& find) {
  std::vector<Match> best(static_cast<std::size_t>(F.cols()));
  constexpr std::int64_t piece = 480;
  for (auto _ : state)
    parallel_for((F.cols() + piece - 1) / piece, 0, [&](std::int64_t b) {
      find(F.col(b * piece).data(), std::min(piece, F.cols() - b * piece), &best[static_cast<std::size_t>(b * piece)]);
    });
  state.SetItemsProcessed(state.iterations() * F.cols());
}

void search_atoms(benchmark::State& state, const std::string& name) {
  const Eigen::MatrixXf F = patches_of(name, 4);
  const AtomSearch search(complete_dictionary());
  run(state, F, [&](const float* signals, std::int64_t count, Match* best) { search.strongest(signals, count, 64, best); });
}
BENCHMARK_CAPTURE(search_atoms, inyo, "inyo_srtm_30m_utm11_nan.tif")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(search_atoms, hit, "hit_tyrol_dtm_5m.asc")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(search_atoms, alr, "alr_tyrol_dtm_5m.tif")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(search_atoms, greenriver, "greenriver_lidar_1m.tif")->UseRealTime()->Unit(benchmark::kMillisecond);

void plain_product(benchmark::State& state) {
  const Eigen::MatrixXf F = patches_of("hit_tyrol_dtm_5m.asc", 4).leftCols(1920);
  const PackedAtoms atoms(complete_dictionary());
  run(state, F, [&](const float* signals, std::int64_t count, Match* best) { strongest_atoms(atoms, signals, count, 64, best); });
}
BENCHMARK(plain_product)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
