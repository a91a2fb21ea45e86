#include "core/amplify/detail.h"

#include <algorithm>
#include <cmath>

#include "core/amplify/activity.h"
#include "core/amplify/consistent_stage.h"
#include "core/amplify/octaves.h"
#include "core/sparse/omp.h"
#include "core/sparse/patches.h"
#include "core/support/parallel.h"
#include "core/terrain/resample.h"
#include "core/terrain/spectrum.h"

namespace arete {
namespace {

constexpr std::int64_t calibration_side = 512;  // coarse cells
constexpr int calibration_turns = 2;

/// An exemplar taken apart: what its area average cannot tell.
struct ExemplarDetail {
  Raster<float> fine;    // the exemplar, cropped to whole blocks
  Raster<float> coarse;
  Raster<float> smooth;  // U(coarse)
  Raster<float> detail;  // fine - smooth; NaN in voids
  std::vector<Raster<float>> octaves;
};

ExemplarDetail take_apart(RasterView<const float> exemplar, const Upsampler& upsampler, int threads) {
  const int f = upsampler.factor;
  ExemplarDetail parts;
  parts.coarse = area_average(exemplar, f);
  const Size size{parts.coarse.width() * f, parts.coarse.height() * f};
  parts.fine = Raster<float>(size.width, size.height);
  parts.detail = Raster<float>(size.width, size.height);
  parts.smooth = upsample_whole(upsampler, std::as_const(parts.coarse).view(), threads);
  for (std::int64_t y = 0; y < size.height; ++y)
    for (std::int64_t x = 0; x < size.width; ++x) {
      parts.fine(x, y) = exemplar(x, y);
      parts.detail(x, y) = exemplar(x, y) - parts.smooth(x, y);
    }
  parts.octaves = split_octaves(std::as_const(parts.detail).view(), f, threads);
  return parts;
}

std::vector<double> squared_disc(int side) {
  std::vector<double> squares;
  for (const float w : disc_weights(side)) squares.push_back(static_cast<double>(w) * static_cast<double>(w));
  return squares;
}

double weighted_mean_square(const float* cells, const std::vector<double>& weights) {
  double sum = 0, total = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i] * static_cast<double>(cells[i]) * static_cast<double>(cells[i]);
    total += weights[i];
  }
  return sum / total;
}

/// Cells whose whole neighbourhood within `reach` is valid and inside.
Raster<std::uint8_t> whole_neighbourhoods(RasterView<const float> coarse, int reach) {
  Raster<std::uint8_t> whole(coarse.width, coarse.height, 0);
  for (std::int64_t y = reach; y + reach < coarse.height; ++y)
    for (std::int64_t x = reach; x + reach < coarse.width; ++x) {
      bool valid = true;
      for (std::int64_t j = -reach; valid && j <= reach; ++j)
        for (std::int64_t i = -reach; valid && i <= reach; ++i) valid = !is_void(coarse(x + i, y + j));
      whole(x, y) = valid;
    }
  return whole;
}

DetailMeasure measure(const ExemplarDetail& parts, const Upsampler& upsampler, int m) {
  const int f = upsampler.factor;
  const Raster<std::uint8_t> whole = whole_neighbourhoods(parts.coarse.view(), upsampler.reach);
  const ActivityMeter meter(m);
  const std::vector<double> weights = squared_disc(m * f);
  std::vector<float> coarse(static_cast<std::size_t>(m * m)), fine(weights.size());
  DetailMeasure sum;
  for (std::int64_t y = 0; y + m <= whole.height(); y += m / 2)
    for (std::int64_t x = 0; x + m <= whole.width(); x += m / 2) {
      bool usable = true;
      for (int j = 0; usable && j < m; ++j)
        for (int i = 0; usable && i < m; ++i) usable = whole(x + i, y + j) != 0;
      if (!usable || !cut_cells(parts.coarse.view(), x, y, m, 0, coarse.data()) ||
          !cut_cells(parts.detail.view(), x * f, y * f, m * f, 0, fine.data()))
        continue;
      const auto activity = static_cast<double>(meter.measure(coarse.data()));
      sum.squared_activity += activity * activity;
      sum.squared_detail += weighted_mean_square(fine.data(), weights);
      ++sum.patches;
    }
  return sum;
}

DetailMeasure operator+(const DetailMeasure& a, const DetailMeasure& b) {
  return {a.squared_detail + b.squared_detail, a.squared_activity + b.squared_activity, a.patches + b.patches};
}

/// Where each atom's detail is cut: its own source, or for an atom that is no real patch the real patch most like it.
std::vector<AtomSource> find_detail_sources(const Dictionary& dictionary, const std::vector<ExemplarDetail>& parts, int threads) {
  std::vector<AtomSource> sources = dictionary.sources;
  if (std::all_of(sources.begin(), sources.end(), [](const AtomSource& s) { return s.exemplar >= 0; })) return sources;
  const PatchGrid grid = make_patch_grid(dictionary.patch_cells);
  std::vector<AtomSource> candidates;
  std::vector<Patches> patches;
  std::int64_t count = 0;
  for (const ExemplarDetail& part : parts) {
    patches.push_back(extract_patches(part.coarse.view(), grid, {PatchEdges::inside, false, true, threads}));
    count += patches.back().count();
    for (const PatchOrigin& origin : patches.back().origins)
      candidates.push_back({static_cast<std::int32_t>(patches.size() - 1), origin.x, origin.y, origin.symmetry});
  }
  Eigen::MatrixXf units(grid.samples(), count);
  count = 0;
  for (const Patches& p : patches) {
    units.middleCols(count, p.count()) = p.values.colwise().normalized();
    count += p.count();
  }
  const SparseCodes nearest = omp(prepare_coding(units, 1, threads), dictionary.low, 1, threads);
  for (std::size_t j = 0; j < sources.size(); ++j)
    if (sources[j].exemplar < 0) sources[j] = candidates[static_cast<std::size_t>(std::max(0, nearest.atoms(0, static_cast<Eigen::Index>(j))))];
  return sources;
}

/// The detail atoms for given gains of the octaves, finest first.
Eigen::MatrixXf cut_detail(const std::vector<ExemplarDetail>& parts, const std::vector<AtomSource>& sources, int patch_cells, int factor,
                           const std::vector<double>& gains, int threads) {
  const int side = patch_cells * factor;
  const std::vector<double> weights = squared_disc(side);
  Eigen::MatrixXf atoms(static_cast<Eigen::Index>(weights.size()), static_cast<Eigen::Index>(sources.size()));
  parallel_for(atoms.cols(), threads, [&](std::int64_t j) {
    const AtomSource& source = sources[static_cast<std::size_t>(j)];
    const ExemplarDetail& part = parts[static_cast<std::size_t>(source.exemplar)];
    std::vector<float> cells(weights.size());
    const auto cut = [&](const Raster<float>& from) {
      return cut_cells(from.view(), source.x * factor, source.y * factor, side, source.symmetry, cells.data());
    };
    auto atom = atoms.col(j);
    atom.setZero();
    if (!cut(part.detail)) return;
    const double norm = std::sqrt(weighted_mean_square(cells.data(), weights));
    if (norm <= 0) return;
    for (std::size_t b = 0; b < gains.size(); ++b) {
      cut(part.octaves[b]);
      atom += static_cast<float>(gains[b] / norm) * Eigen::Map<const Eigen::VectorXf>(cells.data(), atom.size());
    }
  });
  return atoms;
}

/// The dictionary without the atoms of one half of an exemplar (columns of coarse cells [begin, end)).
Dictionary without(const Dictionary& dictionary, const std::vector<AtomSource>& sources, std::int32_t exemplar, std::int64_t begin,
                   std::int64_t end) {
  std::vector<Eigen::Index> kept;
  for (std::size_t j = 0; j < sources.size(); ++j) {
    const AtomSource& s = sources[j];
    if (s.exemplar != exemplar || s.x + dictionary.patch_cells <= begin || s.x >= end) kept.push_back(static_cast<Eigen::Index>(j));
  }
  Dictionary rest;
  rest.patch_cells = dictionary.patch_cells;
  rest.factor = dictionary.factor;
  rest.low = dictionary.low(Eigen::all, kept);
  rest.detail = dictionary.detail(Eigen::all, kept);
  rest.upsampler = dictionary.upsampler;
  rest.detail_power = dictionary.detail_power;
  for (const Eigen::Index j : kept) rest.sources.push_back(sources[static_cast<std::size_t>(j)]);
  return rest;
}

/// The part of an exemplar that calibrates, in coarse cells.
Window calibration_window(Size coarse) {
  const std::int64_t w = std::min(coarse.width, calibration_side), h = std::min(coarse.height, calibration_side);
  return {(coarse.width - w) / 2, (coarse.height - h) / 2, w, h};
}

/// The coarse cells of a window with a margin; void outside the raster.
Raster<float> with_margin(RasterView<const float> coarse, const Window& window, int margin) {
  Raster<float> cells(window.width + 2 * margin, window.height + 2 * margin, void_value);
  for (std::int64_t y = 0; y < cells.height(); ++y)
    for (std::int64_t x = 0; x < cells.width(); ++x) {
      const std::int64_t i = window.x - margin + x, j = window.y - margin + y;
      if (i >= 0 && j >= 0 && i < coarse.width && j < coarse.height) cells(x, y) = coarse(i, j);
    }
  return cells;
}

/// Amplifies a window of an exemplar's own average, each half with the atoms that do not come from it.
Raster<float> amplify_crosswise(const Dictionary& dictionary, const std::vector<AtomSource>& sources, std::int32_t exemplar,
                                const ExemplarDetail& part, const Window& window, int threads) {
  const int f = dictionary.factor;
  Raster<float> fine(window.width * f, window.height * f);
  const std::int64_t middle = window.width / 2;
  for (const Window& half : {Window{window.x, window.y, middle, window.height},
                             Window{window.x + middle, window.y, window.width - middle, window.height}}) {
    const auto stage = make_consistent_stage(without(dictionary, sources, exemplar, half.x, half.x + half.width), {});
    AmplifiedBands bands;
    bands.elevation = fine.view().sub({(half.x - window.x) * f, 0, half.width * f, half.height * f});
    const Raster<float> coarse = with_margin(part.coarse.view(), half, stage->margin());
    stage->evaluate(half, coarse.view(), bands, threads);
  }
  return fine;
}

Raster<float> crop_cells(const Raster<float>& from, const Window& window) {
  Raster<float> cells(window.width, window.height);
  ViewSource(from.view()).read(window, cells.view());
  return cells;
}

/// By how much each octave (finest first) must grow for its power to be the natural share; empty where nothing can be measured.
std::vector<double> missing_gains(const Dictionary& dictionary, const std::vector<AtomSource>& sources, std::int32_t exemplar,
                                  const ExemplarDetail& part, int threads) {
  const int f = dictionary.factor;
  const Window window = calibration_window(part.coarse.size());
  if (window.width < 16 || window.height < 16) return {};
  const Window fine_window{window.x * f, window.y * f, window.width * f, window.height * f};
  Raster<float> truth = crop_cells(part.fine, fine_window);
  const Raster<std::uint8_t> whole = whole_neighbourhoods(part.coarse.view(), dictionary.upsampler->reach);
  for (std::int64_t y = 0; y < truth.height(); ++y)
    for (std::int64_t x = 0; x < truth.width(); ++x)
      if (!whole(window.x + x / f, window.y + y / f)) truth(x, y) = void_value;
  const Raster<float> smooth = crop_cells(part.smooth, fine_window);
  const Raster<float> result = amplify_crosswise(dictionary, sources, exemplar, part, window, threads);
  const SpectrumOptions options{f, 64, 0, threads};
  const SpectrumComparison without_detail = compare_spectra(truth.view(), smooth.view(), options);
  const SpectrumComparison with_detail = compare_spectra(truth.view(), result.view(), options);
  if (with_detail.tile == 0) return {};
  std::vector<double> gains;
  for (std::size_t b = with_detail.bands.size(); b-- > 0;) {
    const double share = gains.empty() && with_detail.bands.size() > 1 ? natural_share_finest : natural_share;
    const double wanted = share - without_detail.bands[b].ratio(), present = with_detail.bands[b].ratio() - without_detail.bands[b].ratio();
    gains.push_back(wanted > 0 && present > 0 ? std::clamp(std::sqrt(wanted / present), 0.25, 4.0) : 1);
  }
  return gains;
}

/// The geometric mean of the exemplars' missing gains, weighted by their cells.
std::vector<double> mean_missing_gains(const Dictionary& dictionary, const std::vector<AtomSource>& sources,
                                       const std::vector<ExemplarDetail>& parts, int threads) {
  std::vector<double> logs(parts.front().octaves.size());
  double total = 0;
  for (std::size_t e = 0; e < parts.size(); ++e) {
    const std::vector<double> gains = missing_gains(dictionary, sources, static_cast<std::int32_t>(e), parts[e], threads);
    if (gains.size() != logs.size()) continue;
    const auto weight = static_cast<double>(parts[e].coarse.size().cells());
    for (std::size_t b = 0; b < logs.size(); ++b) logs[b] += weight * std::log(gains[b]);
    total += weight;
  }
  for (double& g : logs) g = total > 0 ? std::exp(g / total) : 1;
  return logs;
}

}  // namespace

DetailMeasure measure_detail(RasterView<const float> fine, const Upsampler& upsampler, int patch_cells) {
  if (fine.width < upsampler.factor || fine.height < upsampler.factor) return {};
  return measure(take_apart(fine, upsampler, 1), upsampler, patch_cells);
}

void add_detail(Dictionary& dictionary, const std::vector<RasterView<const float>>& exemplars, int threads, Progress& progress) {
  progress.begin("learning the detail", 2 + calibration_turns);
  if (!dictionary.upsampler) dictionary.upsampler = train_upsampler(exemplars, dictionary.factor);
  progress.advance(1);
  std::vector<ExemplarDetail> parts;
  DetailMeasure here, coarser;
  for (const RasterView<const float>& exemplar : exemplars) {
    parts.push_back(take_apart(exemplar, *dictionary.upsampler, threads));
    here = here + measure(parts.back(), *dictionary.upsampler, dictionary.patch_cells);
    coarser = coarser + measure_detail(std::as_const(parts.back().coarse).view(), *dictionary.upsampler, dictionary.patch_cells);
  }
  dictionary.detail_power = here.power();
  dictionary.coarse_detail_power = coarser.patches >= least_patches_to_judge ? coarser.power() : 0;
  progress.advance(1);

  const std::vector<AtomSource> sources = find_detail_sources(dictionary, parts, threads);
  std::vector<double> gains(parts.front().octaves.size(), 1.0);
  const auto cut = [&] { return cut_detail(parts, sources, dictionary.patch_cells, dictionary.factor, gains, threads); };
  for (int turn = 0; turn < calibration_turns; ++turn) {
    dictionary.detail = cut();
    const std::vector<double> missing = mean_missing_gains(dictionary, sources, parts, threads);
    for (std::size_t b = 0; b < gains.size(); ++b) gains[b] *= missing[b];
    progress.advance(1);
  }
  dictionary.detail = cut();
  progress.end();
}

}  // namespace arete
