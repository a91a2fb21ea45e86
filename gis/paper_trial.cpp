// É. Guérin, J. Digne, É. Galin, A. Peytavie, "Sparse representation of terrains for procedural modeling", Eurographics 2016: section
// on compact storage, which gives value ratios and PSNR for N = 128 and s = 1, 2, 8.
#include "gis/paper_trial.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "gis/terrain_tree.h"

namespace arete {
namespace {

constexpr int tries = 6;
constexpr double near_enough = 2e-4;  // of the bytes: hundredths of a dB are 2e-3

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

PaperRow measure_tree_of(const TestedTerrain& terrain, int sparsity, int threads) {
  CompressOptions options;
  options.profile = TreeProfile::paper;
  options.patches.atoms = paper_atoms;
  options.patches.sparsity = sparsity;
  options.threads = threads;
  PaperRow row{.sparsity = sparsity};
  row.tree.target = {CodingTarget::Kind::setting, static_cast<double>(sparsity)};
  const auto start = std::chrono::steady_clock::now();
  const TerrainTree made = encode_tree(terrain, options);
  row.tree.encode_s = seconds_since(start);
  row.ratio = made.report.value_ratio.value();
  Raster<float> decoded(terrain.cells.width(), terrain.cells.height());
  const auto middle = std::chrono::steady_clock::now();
  decode_tree(made.file, decoded.view(), threads);
  row.tree.decode_s = seconds_since(middle);
  row.tree.bytes = static_cast<std::int64_t>(made.file.size());
  row.tree.bits = 8 * static_cast<double>(made.file.size()) / static_cast<double>(decoded.size().cells());
  compare_cells(terrain, decoded, row.tree);
  return row;
}

// The file of the codec that comes nearest to so many bytes.
Measurement measure_in_bytes(const CodecUnderTest& codec, const TestedTerrain& terrain, std::int64_t bytes, int threads) {
  const auto wanted = static_cast<double>(bytes);
  const auto miss = [&](const Measurement& m) { return std::abs(std::log(static_cast<double>(m.bytes) / wanted)); };
  double asked = wanted;
  Measurement nearest = measure_codec(codec, terrain, {CodingTarget::Kind::bytes, asked}, 1, threads), last = nearest;
  for (int i = 1; i < tries && miss(nearest) > near_enough; ++i) {
    asked *= wanted / static_cast<double>(last.bytes);
    last = measure_codec(codec, terrain, {CodingTarget::Kind::bytes, asked}, 1, threads);
    if (miss(last) < miss(nearest)) nearest = last;
  }
  return nearest;
}

}  // namespace

std::vector<PaperRow> try_paper_profile(const TestedTerrain& terrain, const CodecUnderTest& jpeg2000, int threads, Progress& progress) {
  std::vector<PaperRow> rows;
  for (const int sparsity : paper_sparsities) {
    rows.push_back(measure_tree_of(terrain, sparsity, threads));
    rows.back().jpeg2000 = measure_in_bytes(jpeg2000, terrain, rows.back().tree.bytes, threads);
    progress.advance(1);
  }
  return rows;
}

}  // namespace arete
