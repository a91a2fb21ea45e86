#include "core/amplify/source_map.h"

#include <algorithm>

#include "core/amplify/void_mask.h"

namespace arete {
namespace {

/// The patch whose centre is nearest to the fine cell in the middle of coarse cell `c`, along one direction.
std::int64_t nearest_patch(const PatchGrid& grid, std::int64_t c) {
  // Twice the centre of patch k is 2 k p - 2 (m - p) + m; of the cell 2 c + 1.

  const auto distance = [&](std::int64_t k) { return std::abs(2 * patch_origin(grid, k) + grid.patch_cells - (2 * c + 1)); };
  const PatchRange near = patches_touching(grid, c, c + 1);
  std::int64_t best = near.begin;
  for (std::int64_t k = near.begin + 1; k < near.end; ++k)
    if (distance(k) < distance(best)) best = k;
  return best;
}

void fill_block(RasterView<float> band, std::int64_t x, std::int64_t y, int factor, float value) {
  if (!band.data) return;
  for (int j = 0; j < factor; ++j)
    for (int i = 0; i < factor; ++i) band(x * factor + i, y * factor + j) = value;
}

}  // namespace

void map_sources(const CodedPatches& coded, const PatchGrid& grid, const std::vector<AtomSource>& sources, int factor,
                 const Window& window, RasterView<const float> coarse, const AmplifiedBands& out) {
  if (!out.exemplar.data && !out.atom.data) return;
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x) {
      const std::int64_t patch = coded.index(nearest_patch(grid, window.x + x), nearest_patch(grid, window.y + y));
      const std::int32_t atom = coded.codes.atoms(0, patch);
      const std::int32_t exemplar = atom < 0 ? -1 : sources[static_cast<std::size_t>(atom)].exemplar;
      fill_block(out.atom, x, y, factor, static_cast<float>(atom));
      fill_block(out.exemplar, x, y, factor, static_cast<float>(exemplar + 1));
    }
  if (out.exemplar.data) restore_voids(coarse, factor, out.exemplar);
  if (out.atom.data) restore_voids(coarse, factor, out.atom);
}

}  // namespace arete
