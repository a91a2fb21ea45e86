#include "tools/exemplars.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace arete::tools {
namespace {

LearningMethod method_of(const std::string& name) {
  if (name == "all") return LearningMethod::all;
  return name == "ksvd" ? LearningMethod::ksvd : LearningMethod::constrained;
}

/// The middle of a raster, at most `most` cells.
Window middle_of(Size size, std::int64_t most) {
  if (size.cells() <= most) return {0, 0, size.width, size.height};
  const double shrink = std::sqrt(static_cast<double>(most) / static_cast<double>(size.cells()));
  const auto side = [&](std::int64_t cells) { return std::max<std::int64_t>(1, static_cast<std::int64_t>(static_cast<double>(cells) * shrink)); };
  const std::int64_t w = side(size.width), h = side(size.height);
  return {(size.width - w) / 2, (size.height - h) / 2, w, h};
}

}  // namespace

int patch_of_radius(double radius_m, double coarse_cell_m) {
  return std::max(4, 2 * static_cast<int>(std::lround(radius_m / coarse_cell_m)));
}

LearnedDictionary learn_from_files(const std::vector<std::string>& paths, const LearnSettings& settings, double radius_m,
                                   const CommonOptions& common, Progress& progress) {
  // Learning holds the exemplar, its average, its upsampling and the octaves of its detail at once: about 40 bytes a cell.
  const std::int64_t most_cells = std::max<std::int64_t>(1, common.memory_bytes / 40 / static_cast<std::int64_t>(paths.size()));
  std::vector<Raster<float>> cells;
  std::vector<Exemplar> exemplars;
  for (const std::string& path : paths) {
    const DemReader dem(path, settings.reading);
    const Window window = middle_of(dem.size(), most_cells);
    if (window.size() != dem.size())
      warn(common, "'" + path + "' is larger than the memory budget: learning from the middle " + std::to_string(window.width) + " x " +
                       std::to_string(window.height) + " cells; give a larger --memory for all of it");
    cells.emplace_back(window.width, window.height);
    dem.read(window, cells.back().view());
    const CellSize cell = dem.cell_size();
    exemplars.push_back({std::filesystem::path(path).filename().string(), {}, std::sqrt(cell.x_m * cell.y_m)});
  }
  for (std::size_t i = 0; i < cells.size(); ++i) exemplars[i].cells = std::as_const(cells[i]).view();

  LearnOptions options;
  options.method = method_of(settings.method);
  options.factor = settings.factor;
  options.atoms = settings.atoms != 0 || options.method == LearningMethod::all ? settings.atoms : default_atoms;
  options.patch_cells = settings.patch_cells != 0 ? settings.patch_cells : default_patch_cells;
  if (radius_m > 0) options.patch_cells = patch_of_radius(radius_m, exemplars.front().cell_size_m * settings.factor);
  options.sparsity = settings.sparsity;
  options.symmetries = settings.symmetries;
  options.detail = settings.detail;
  options.exhaustive = settings.exhaustive;
  options.seed = common.seed;
  options.threads = common.threads;
  LearnedDictionary learned;
  learned.dictionary = learn_dictionary(exemplars, options, learned.report, progress);
  learned.dictionary.provenance = common.command_line;
  return learned;
}

}  // namespace arete::tools
