#include "core/sparse/patches.h"

#include <algorithm>
#include <cmath>

#include "core/support/parallel.h"

namespace arete {

namespace {

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

Patches cut_patches(RasterView<const float> terrain, const PatchGrid& grid, const std::vector<PatchOrigin>& origins, bool leave_out_flat,
                    int threads) {
  constexpr std::int64_t piece = 1024;
  const auto count = static_cast<std::int64_t>(origins.size());
  Patches patches{Eigen::MatrixXf(grid.samples(), count), std::vector<double>(origins.size()), origins};
  std::vector<char> present(origins.size());
  parallel_for((count + piece - 1) / piece, threads, [&](std::int64_t p) {
    for (std::int64_t i = p * piece; i < std::min(count, (p + 1) * piece); ++i) {
      const auto index = static_cast<std::size_t>(i);
      float* cells = patches.values.col(i).data();
      if (!cut_cells(terrain, origins[index].x, origins[index].y, grid.patch_cells, origins[index].symmetry, cells)) continue;
      patches.means[index] = make_patch(grid, cells);
      present[index] = !leave_out_flat || !is_flat_patch(norm_of(cells, grid.samples()), patches.means[index], grid.samples());
    }
  });

  std::int64_t kept = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    const auto from = static_cast<std::size_t>(i), to = static_cast<std::size_t>(kept);
    if (!present[from]) continue;
    if (kept != i) {
      std::copy_n(patches.values.col(i).data(), grid.samples(), patches.values.col(kept).data());
      patches.means[to] = patches.means[from];
      patches.origins[to] = patches.origins[from];
    }
    ++kept;
  }
  patches.values.conservativeResize(Eigen::NoChange, kept);
  patches.means.resize(static_cast<std::size_t>(kept));
  patches.origins.resize(static_cast<std::size_t>(kept));
  return patches;
}

Patches extract_patches(RasterView<const float> terrain, const PatchGrid& grid, const PatchOptions& options) {
  if (terrain.width == 0 || terrain.height == 0) return {Eigen::MatrixXf(grid.samples(), 0), {}, {}};
  const auto xs = origins_along(grid, terrain.width, options.edges);
  const std::uint8_t symmetries = options.symmetries ? 8 : 1;
  std::vector<PatchOrigin> origins;
  for (const std::int64_t y : origins_along(grid, terrain.height, options.edges))
    for (const std::int64_t x : xs)
      for (std::uint8_t symmetry = 0; symmetry < symmetries; ++symmetry) origins.push_back({x, y, symmetry});
  return cut_patches(terrain, grid, origins, options.leave_out_flat, options.threads);
}

}  // namespace arete
