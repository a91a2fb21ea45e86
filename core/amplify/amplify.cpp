#include "core/amplify/amplify.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "core/amplify/amplified_terrain.h"
#include "core/amplify/consistent_stage.h"
#include "core/amplify/detail.h"
#include "core/amplify/paper_stage.h"
#include "core/support/error.h"

namespace arete {
namespace {

constexpr std::int64_t sample_side = 512;  // of the windows that judge the input
constexpr std::int64_t sample_rows = 3;

/// The detail that the input itself shows one factor above its cells, on up to 9 windows spread over it.
DetailMeasure sample_detail(const RasterSource& terrain, const Upsampler& upsampler, int patch_cells) {
  const Size size = terrain.size();
  const std::int64_t w = std::min(size.width, sample_side), h = std::min(size.height, sample_side);
  const std::int64_t across = size.width > w ? sample_rows : 1, down = size.height > h ? sample_rows : 1;
  DetailMeasure sum;
  for (std::int64_t j = 0; j < down; ++j)
    for (std::int64_t i = 0; i < across; ++i) {
      const Window window{across == 1 ? 0 : i * (size.width - w) / (across - 1), down == 1 ? 0 : j * (size.height - h) / (down - 1), w, h};
      Raster<float> cells(w, h);
      terrain.read(window, cells.view());
      const DetailMeasure here = measure_detail(std::as_const(cells).view(), upsampler, patch_cells);
      sum.squared_detail += here.squared_detail;
      sum.squared_activity += here.squared_activity;
      sum.patches += here.patches;
    }
  return sum;
}

void judge_exemplars(const RasterSource& terrain, const Dictionary& dictionary, AmplifyReport& report) {
  if (!dictionary.upsampler || dictionary.coarse_detail_power <= 0) return;
  const DetailMeasure input = sample_detail(terrain, *dictionary.upsampler, dictionary.patch_cells);
  if (input.patches < least_patches_to_judge || input.squared_activity <= 0) return;
  report.likeness = input.power() / dictionary.coarse_detail_power;
  report.unlike = report.likeness > most_unlike || report.likeness < 1 / most_unlike;
  if (report.unlike) report.detail_scale = std::sqrt(report.likeness);
}

void check(const AmplifyOptions& options, const Dictionary& dictionary) {
  if (!(options.detail >= 0 && options.detail <= 1))
    throw Error(ErrorKind::usage, "amplify: detail of " + std::to_string(options.detail) + ": expected 0 (least error) to 1 (natural)");
  if (options.sparsity < 1) throw Error(ErrorKind::usage, "amplify: sparsity of " + std::to_string(options.sparsity) + ": expected at least 1");
  if (options.uncertainty && options.method == AmplifyMethod::paper)
    throw Error(ErrorKind::usage, "amplify: the published method has no error model: use --method consistent for an uncertainty band");
  if ((options.uncertainty || options.sources) && options.method == AmplifyMethod::consistent && dictionary.detail.cols() == 0)
    throw Error(ErrorKind::input, "amplify: the dictionary has no detail atoms, which the uncertainty and source bands tell of: learn it with --factor");
}

std::unique_ptr<Stage> make_stage(Dictionary dictionary, const AmplifyOptions& options) {
  if (options.method == AmplifyMethod::paper)
    return make_paper_stage(std::move(dictionary), {options.sparsity, options.pitch, options.threads});
  return make_consistent_stage(std::move(dictionary), {options.detail, options.sparsity, options.pitch, options.threads});
}

/// Side of the windows, in fine cells: a whole number of coarse cells of the last stage. One window costs about 24 bytes per fine cell
/// and wanted band: result, detail, coarse patches and their codes, and what the sink keeps of it.
std::int64_t window_side(const AmplifyOptions& options, const Stage& stage, std::int64_t dictionary_bytes, int bands) {
  constexpr std::int64_t bytes_per_cell = 24, smallest = 256, largest = 4096;
  const std::int64_t left = options.memory_bytes - dictionary_bytes;
  const std::int64_t fits = left <= 0 ? 0 : static_cast<std::int64_t>(std::sqrt(static_cast<double>(left) / 2.0 / static_cast<double>(bytes_per_cell * bands)));
  if (fits < smallest)
    throw Error(ErrorKind::memory, "amplify: the memory budget of " + std::to_string(options.memory_bytes >> 20) +
                                       " MB is too small for the dictionary of " + std::to_string(dictionary_bytes >> 20) +
                                       " MB and one window: give --memory " +
                                       std::to_string((dictionary_bytes + 2 * bytes_per_cell * bands * smallest * smallest) / (1 << 20) + 1) + "M");
  const std::int64_t unit = std::int64_t{stage.factor()} * 32;
  return std::max(unit, std::min(fits, largest) / unit * unit);
}

std::int64_t bytes_of(const Dictionary& dictionary) {
  return static_cast<std::int64_t>(sizeof(float)) * (dictionary.low.size() * 2 + dictionary.high.size() + dictionary.detail.size());
}

/// The wanted bands of one window, in the order of the sink.
struct WindowBands {
  WindowBands(const Window& window, const AmplifyOptions& options) {
    add(window, bands.elevation);
    if (options.uncertainty) add(window, bands.uncertainty);
    if (options.sources) {
      add(window, bands.exemplar);
      add(window, bands.atom);
    }
  }
  void add(const Window& window, RasterView<float>& view) {
    cells.emplace_back(window.width, window.height);
    view = cells.back().view();
  }
  std::vector<Raster<float>> cells;
  AmplifiedBands bands;
};

}  // namespace

int count_stages(int factor, int dictionary_factor) {
  if (factor < 2) throw Error(ErrorKind::usage, "amplify: factor " + std::to_string(factor) + ": expected at least 2");
  int stages = 0;
  std::int64_t reached = 1;
  while (dictionary_factor >= 2 && reached < factor) {
    reached *= dictionary_factor;
    ++stages;
  }
  if (stages == 0 || reached != factor)
    throw Error(ErrorKind::usage, "amplify: factor " + std::to_string(factor) + " is no power of the dictionary's factor " +
                                      std::to_string(dictionary_factor) + ": choose one, or learn with --factor " + std::to_string(factor));
  return stages;
}

AmplifyReport amplify(const RasterSource& terrain, Dictionary dictionary, const AmplifyOptions& options, RasterSink& out,
                      Progress& progress) {
  check(options, dictionary);
  AmplifyReport report;
  report.stages = count_stages(options.factor, dictionary.factor);
  const bool judged = options.method == AmplifyMethod::consistent && (options.detail > 0 || options.uncertainty);
  if (judged) judge_exemplars(terrain, dictionary, report);
  // The power, not only what is added of it: the error of the linear answer is the input's, too.
  dictionary.detail_power *= report.detail_scale * report.detail_scale;
  const std::int64_t dictionary_bytes = bytes_of(dictionary);
  const std::unique_ptr<Stage> stage = make_stage(std::move(dictionary), options);

  std::vector<std::unique_ptr<AmplifiedTerrain>> chain;
  for (int i = 0; i < report.stages; ++i)
    chain.push_back(std::make_unique<AmplifiedTerrain>(i == 0 ? terrain : *chain.back(), *stage, options.threads));
  const Size size = chain.back()->size();
  const int bands = 1 + (options.uncertainty ? 1 : 0) + (options.sources ? 2 : 0);
  const std::int64_t side = window_side(options, *stage, dictionary_bytes, bands);
  progress.begin("amplifying", size.cells());
  for (std::int64_t y = 0; y < size.height; y += side)
    for (std::int64_t x = 0; x < size.width; x += side) {
      const Window window{x, y, std::min(side, size.width - x), std::min(side, size.height - y)};
      const WindowBands result(window, options);
      chain.back()->read_bands(window, result.bands);
      for (std::size_t b = 0; b < result.cells.size(); ++b) out.write(static_cast<int>(b), window, result.cells[b].view());
      progress.advance(window.width * window.height);
    }
  progress.end();
  return report;
}

}  // namespace arete
