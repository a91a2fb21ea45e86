// The table of compact storage (Guérin et al. 2016, table 4) on a DEM: value ratio, bytes and PSNR for s = 1, 2, 8 with 128 atoms.
// Used as: paper_profile [--radius R] [--atoms N] [--constrained] [--loss DB] [--side CELLS] DEM [x y width height]

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "core/codec/patch_coder.h"
#include "core/terrain/fill_voids.h"
#include "gis/dem_file.h"

namespace {

using namespace arete;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double peak_of(const Raster<float>& cells) {
  double least = cells.data()[0], most = least;
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) {
    least = std::min(least, static_cast<double>(cells.data()[i]));
    most = std::max(most, static_cast<double>(cells.data()[i]));
  }
  return most - least;
}

void print_row(const Raster<float>& cells, const PatchCodingOptions& options) {
  NoProgress progress;
  const auto start = std::chrono::steady_clock::now();
  const PatchStreams streams = encode_patches(cells.view(), options, progress);
  const double encoding = seconds_since(start);
  const auto middle = std::chrono::steady_clock::now();
  const Raster<float> decoded =
      decode_patches(streams.parameters, streams.root, [&](std::int64_t i) { return streams.nodes[static_cast<std::size_t>(i)]; }, 0,
                     {0, 0, cells.width(), cells.height()}, 0);
  const double decoding = seconds_since(middle);
  double squares = 0;
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) squares += std::pow(static_cast<double>(decoded.data()[i]) - cells.data()[i], 2);
  const auto count = static_cast<double>(cells.size().cells());
  const double peak = peak_of(cells);
  const auto psnr = [&](double sum) { return 20 * std::log10(peak / std::sqrt(sum / count)); };
  const int side = 2 * options.radius;
  const ValueRatio rho = value_ratio(streams.parameters.atoms.count, std::int64_t{side} * side, streams.discs, options.sparsity, cells.size().cells());
  const auto header = static_cast<double>(serialise_patch_parameters(streams.parameters).size());
  const auto bytes = static_cast<double>(streams.bytes());
  std::printf("%d | %d | %.1f | %.1f | %.0f | %.0f | %.3f | %.2f | %.2f | %.1f | %.2f\n", options.radius, options.sparsity, 100 * rho.tabulated,
              100 * rho.printed, bytes, header, 8 * bytes / count, psnr(squares), psnr(streams.unquantised_squared_error), encoding, decoding);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  PatchCodingOptions options;
  std::vector<std::string> rest;
  for (int i = 1; i < argc; ++i) {
    const auto is = [&](const char* name) { return std::strcmp(argv[i], name) == 0; };
    if (is("--radius")) options.radius = std::atoi(argv[++i]);
    else if (is("--atoms")) options.atoms = std::atoi(argv[++i]);
    else if (is("--constrained")) options.learning = PatchLearning::constrained;
    else if (is("--loss")) options.quantiser_loss_db = std::atof(argv[++i]);
    else if (is("--side")) options.node_side = std::atoi(argv[++i]);
    else rest.push_back(argv[i]);
  }
  const DemReader dem(rest.at(0));
  Raster<float> all = read_all(dem);
  Window window{0, 0, all.width(), all.height()};
  if (rest.size() == 5) window = {std::stoll(rest[1]), std::stoll(rest[2]), std::stoll(rest[3]), std::stoll(rest[4])};
  Raster<float> cells(window.width, window.height);
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x) cells(x, y) = all(window.x + x, window.y + y);
  const VoidFill fill = fill_voids(cells.view());
  std::printf("%s: %lld x %lld cells, %lld voids filled\n", rest[0].c_str(), static_cast<long long>(window.width), static_cast<long long>(window.height),
              static_cast<long long>(fill.cells));
  std::printf("R | s | rho %% (table) | rho %% (formula) | bytes | of them dictionary and parameters | bits/sample | PSNR dB | before quantisation | encode s | decode s\n");
  for (int sparsity : {1, 2, 8}) {
    options.sparsity = sparsity;
    print_row(cells, options);
  }
}
