#include "core/amplify/coded_patches.h"

#include <algorithm>

#include "core/sparse/patches.h"
#include "core/support/parallel.h"

namespace arete {

CodedPatches code_patches(RasterView<const float> terrain, std::int64_t origin_x, std::int64_t origin_y, const Window& window,
                          const PatchGrid& grid, const CodingDictionary& dictionary, int sparsity, const ActivityMeter* meter,
                          int threads) {
  CodedPatches coded;
  coded.columns = patches_touching(grid, window.x, window.x + window.width);
  coded.rows = patches_touching(grid, window.y, window.y + window.height);
  const auto count = static_cast<std::size_t>(coded.columns.count() * coded.rows.count());
  coded.means.resize(count);
  coded.known.resize(count);
  if (meter) coded.activity.resize(count);
  Eigen::MatrixXf signals(grid.samples(), static_cast<Eigen::Index>(count));
  parallel_for(coded.rows.count(), threads, [&](std::int64_t j) {
    for (std::int64_t i = 0; i < coded.columns.count(); ++i) {
      const auto patch = static_cast<std::size_t>(j * coded.columns.count() + i);
      float* cells = signals.col(static_cast<Eigen::Index>(patch)).data();
      const std::int64_t x = patch_origin(grid, coded.columns.begin + i) - origin_x, y = patch_origin(grid, coded.rows.begin + j) - origin_y;
      if (!cut_cells(terrain, x, y, grid.patch_cells, 0, cells)) {
        std::fill_n(cells, grid.samples(), 0.0f);
        continue;
      }
      coded.known[patch] = 1;
      if (meter) coded.activity[patch] = meter->measure(cells);
      coded.means[patch] = make_patch(grid, cells);
    }
  });
  coded.codes = omp(dictionary, signals, sparsity, threads);
  return coded;
}

}  // namespace arete
