#include "core/sparse/patches.h"

#include <algorithm>
#include <cmath>

#include "core/support/parallel.h"

namespace arete {

namespace {

struct Row {
  std::vector<float> values;
  std::vector<double> means;
  std::vector<PatchOrigin> origins;
};

double norm_of(const float* values, std::int64_t count) {
  double sum = 0;
  for (std::int64_t i = 0; i < count; ++i) sum += static_cast<double>(values[i]) * values[i];
  return std::sqrt(sum);
}

// The origins along one direction of the raster.
std::vector<std::int64_t> origins_along(const PatchGrid& grid, std::int64_t cells, PatchEdges edges) {
  std::vector<std::int64_t> origins;
  if (edges == PatchEdges::inside)
    for (std::int64_t o = 0; o + grid.patch_cells <= cells; o += grid.pitch) origins.push_back(o);
  else
    for (std::int64_t k = 0; k < patches_along(grid, cells); ++k) origins.push_back(patch_origin(grid, k));
  return origins;
}

void append_patches_at(RasterView<const float> terrain, const PatchGrid& grid, const PatchOptions& options, std::int64_t x,
                       std::int64_t y, std::vector<float>& cells, Row& row) {
  const int symmetries = options.symmetries ? 8 : 1;
  for (int symmetry = 0; symmetry < symmetries; ++symmetry) {
    const PatchOrigin origin{x, y, static_cast<std::uint8_t>(symmetry)};
    if (!cut_cells(terrain, x, y, grid.patch_cells, origin.symmetry, cells.data())) return;
    const double mean = make_patch(grid, cells.data());
    if (options.leave_out_flat && is_flat_patch(norm_of(cells.data(), grid.samples()), mean, grid.samples())) return;
    row.values.insert(row.values.end(), cells.begin(), cells.end());
    row.means.push_back(mean);
    row.origins.push_back(origin);
  }
}

}  // namespace

bool cut_cells(RasterView<const float> terrain, std::int64_t x, std::int64_t y, int patch_cells, std::uint8_t symmetry, float* cells) {
  for (int j = 0; j < patch_cells; ++j)
    for (int i = 0; i < patch_cells; ++i) {
      const CellIndex from = source_cell(i, j, patch_cells, symmetry);
      const float z = terrain(std::clamp<std::int64_t>(x + from.x, 0, terrain.width - 1),
                              std::clamp<std::int64_t>(y + from.y, 0, terrain.height - 1));
      if (is_void(z)) return false;
      cells[j * patch_cells + i] = z;
    }
  return true;
}

double make_patch(const PatchGrid& grid, float* cells) {
  const std::int64_t samples = grid.samples();
  double sum = 0;
  for (std::int64_t i = 0; i < samples; ++i) sum += cells[i];
  const double mean = sum / static_cast<double>(samples);
  for (std::int64_t i = 0; i < samples; ++i)
    cells[i] = static_cast<float>((cells[i] - mean) * grid.weights[static_cast<std::size_t>(i)]);
  return mean;
}

bool is_flat_patch(double norm, double mean, std::int64_t samples) {
  return norm <= std::max(1e-6, 0x1p-20 * std::abs(mean) * std::sqrt(static_cast<double>(samples)));
}

Patches extract_patches(RasterView<const float> terrain, const PatchGrid& grid, const PatchOptions& options) {
  const auto xs = origins_along(grid, terrain.width, options.edges);
  const auto ys = origins_along(grid, terrain.height, options.edges);
  std::vector<Row> rows(ys.size());
  if (terrain.width > 0 && terrain.height > 0)
    parallel_for(static_cast<std::int64_t>(ys.size()), options.threads, [&](std::int64_t j) {
      const auto index = static_cast<std::size_t>(j);
      std::vector<float> cells(static_cast<std::size_t>(grid.samples()));
      for (const std::int64_t x : xs) append_patches_at(terrain, grid, options, x, ys[index], cells, rows[index]);
    });

  Patches patches;
  std::size_t count = 0;
  for (const Row& row : rows) count += row.means.size();
  patches.values.resize(grid.samples(), static_cast<Eigen::Index>(count));
  patches.means.reserve(count);
  patches.origins.reserve(count);
  float* to = patches.values.data();
  for (const Row& row : rows) {
    to = std::copy(row.values.begin(), row.values.end(), to);
    patches.means.insert(patches.means.end(), row.means.begin(), row.means.end());
    patches.origins.insert(patches.origins.end(), row.origins.begin(), row.origins.end());
  }
  return patches;
}

}  // namespace arete
