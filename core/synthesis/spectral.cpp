#include "core/synthesis/spectral.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <unsupported/Eigen/FFT>

#include "core/support/parallel.h"
#include "core/support/random.h"

namespace arete {
namespace {

using Complex = std::complex<double>;

/// Columns that are transformed together, so that a cache line is read once.
constexpr std::int64_t column_block = 8;

void transform_line(Eigen::FFT<double>& fft, std::vector<Complex>& line, std::vector<Complex>& scratch, bool inverse) {
  if (line.size() == 1) return;  // its own transform, which Eigen's FFT does not know
  if (inverse)
    fft.inv(scratch, line);
  else
    fft.fwd(scratch, line);
  line.swap(scratch);
}

void transform_rows(RasterView<Complex> cells, bool inverse, int threads) {
  parallel_for(cells.height, threads, [&](std::int64_t y) {
    Eigen::FFT<double> fft;
    std::vector<Complex> line(cells.row(y), cells.row(y) + cells.width), scratch;
    transform_line(fft, line, scratch, inverse);
    std::copy(line.begin(), line.end(), cells.row(y));
  });
}

void transform_columns(RasterView<Complex> cells, bool inverse, int threads) {
  const std::int64_t blocks = (cells.width + column_block - 1) / column_block;
  parallel_for(blocks, threads, [&](std::int64_t block) {
    Eigen::FFT<double> fft;
    const std::int64_t x0 = block * column_block, count = std::min(column_block, cells.width - x0);
    std::vector<std::vector<Complex>> lines(static_cast<std::size_t>(count));
    for (auto& line : lines) line.resize(static_cast<std::size_t>(cells.height));
    for (std::int64_t y = 0; y < cells.height; ++y)
      for (std::int64_t i = 0; i < count; ++i) lines[static_cast<std::size_t>(i)][static_cast<std::size_t>(y)] = cells(x0 + i, y);
    std::vector<Complex> scratch;
    for (auto& line : lines) transform_line(fft, line, scratch, inverse);
    for (std::int64_t y = 0; y < cells.height; ++y)
      for (std::int64_t i = 0; i < count; ++i) cells(x0 + i, y) = lines[static_cast<std::size_t>(i)][static_cast<std::size_t>(y)];
  });
}

/// Two independent Gaussians from the hash of a position (Box & Muller 1958), of which one is kept.
double gaussian_at(std::uint64_t seed, std::int64_t x, std::int64_t y) {
  const auto column = static_cast<std::uint64_t>(x), row = static_cast<std::uint64_t>(y);
  const double radius = std::sqrt(-2 * std::log(1 - uniform_at(seed, column, row, 0)));
  return radius * std::cos(2 * std::numbers::pi * uniform_at(seed, column, row, 1));
}

/// The frequency of bin i of n, in cycles per cell: bins beyond the middle are negative ones.
double wrapped_frequency(std::int64_t i, std::int64_t n) {
  return static_cast<double>(i <= n / 2 ? i : i - n) / static_cast<double>(n);
}

}  // namespace

Raster<float> synthesize_spectral(Size size, const SpectralOptions& options) {
  Raster<Complex> spectrum(size.width, size.height);
  parallel_for(size.height, options.threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < size.width; ++x) spectrum(x, y) = gaussian_at(options.seed, x, y);
  });
  transform_rows(spectrum.view(), false, options.threads);
  transform_columns(spectrum.view(), false, options.threads);

  parallel_for(size.height, options.threads, [&](std::int64_t y) {
    const double fy = wrapped_frequency(y, size.height);
    for (std::int64_t x = 0; x < size.width; ++x) {
      const double fx = wrapped_frequency(x, size.width);
      const double square = fx * fx + fy * fy;
      spectrum(x, y) *= square > 0 ? std::pow(square, -options.beta / 2) : 0;
    }
  });
  transform_columns(spectrum.view(), true, options.threads);
  transform_rows(spectrum.view(), true, options.threads);

  double lowest = spectrum(0, 0).real(), highest = lowest;
  for (std::int64_t i = 0; i < size.cells(); ++i) {
    lowest = std::min(lowest, spectrum.data()[i].real());
    highest = std::max(highest, spectrum.data()[i].real());
  }
  const double scale = highest > lowest ? options.relief_m / (highest - lowest) : 0;
  Raster<float> terrain(size.width, size.height);
  parallel_for(size.height, options.threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < size.width; ++x)
      terrain(x, y) = static_cast<float>((spectrum(x, y).real() - lowest) * scale);
  });
  return terrain;
}

}  // namespace arete
