#include "core/tree/measure.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

namespace arete {
namespace {

constexpr std::int64_t block = NodeGrid::greatest_side;  // cells along a side of the squares that are summed up on their own

// The number that stands for a void in a file of the header's type, where it has one of its own.
std::optional<double> void_number(const TreeHeader& header) {
  const std::optional<double>& nodata = header.geo.nodata;
  if (!nodata || std::isnan(*nodata)) return std::nullopt;
  if (is_integer(header.type)) return holds(header.type, *nodata) ? nodata : std::nullopt;
  const ValueRange range = range_of(header.type);
  return *nodata >= range.lowest && *nodata <= range.highest ? std::optional(hold_to(header.type, *nodata)) : std::nullopt;
}

}  // namespace

double nodata_step(const TreeHeader& header) {
  const std::optional<double> number = void_number(header);
  return number ? std::abs(next_value(header.type, *number) - *number) : 0;
}

double TreeErrors::psnr_db() const { return 20 * std::log10((highest_m - lowest_m) / rmse_m); }

TreeErrors measure_tree(const ElevationTree& tree, const StoredSource& original, std::int64_t memory_bytes, Progress* progress) {
  const Size size = tree.size();
  const std::int64_t across = (size.width + block - 1) / block;
  TreeErrors errors;
  errors.bytes = tree.file().bytes();
  errors.cells = size.cells();
  StoredRange range;
  double greatest = 0;
  const std::optional<double> nodata = void_number(tree.header());
  std::vector<double> squares(static_cast<std::size_t>(across * ((size.height + block - 1) / block)));
  if (progress) progress->begin("comparing", size.cells());
  for (const Window& at : split_window({0, 0, size.width, size.height}, memory_bytes)) {
    Raster<double> decoded(at.width, at.height), truth(at.width, at.height);
    tree.read_stored(0, at, decoded.view());
    original.read_stored(at, truth.view());
    range.add(StoredValues(truth.data(), static_cast<std::size_t>(truth.size().cells())));
    for (std::int64_t y = 0; y < at.height; ++y)
      for (std::int64_t x = 0; x < at.width; ++x) {
        const double found = decoded(x, y) == nodata ? next_value(tree.header().type, *nodata) : decoded(x, y), wanted = truth(x, y);
        errors.valid_cells += !std::isnan(wanted);
        errors.void_differs += std::isnan(wanted) != std::isnan(found);
        if (std::isnan(wanted) || std::isnan(found)) continue;
        errors.differs += std::bit_cast<std::uint64_t>(found) != std::bit_cast<std::uint64_t>(wanted);
        const double error = std::abs(found - wanted);
        squares[static_cast<std::size_t>((at.y + y) / block * across + (at.x + x) / block)] += error * error;
        greatest = std::max(greatest, error);
      }
    if (progress) progress->advance(at.size().cells());
  }
  if (progress) progress->end();
  const double metres = std::abs(tree.header().scale) * tree.header().geo.metres_per_unit;
  const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
  errors.rmse_m = std::sqrt(sum / static_cast<double>(std::max<std::int64_t>(errors.valid_cells, 1))) * metres;
  errors.max_error_m = greatest * metres;
  errors.lowest_m = range.lowest * metres;
  errors.highest_m = range.highest * metres;
  return errors;
}

bool keeps_claim(const TreeHeader& header, const TreeErrors& errors) {
  constexpr double rounding = 1e-9;
  if (errors.void_differs > 0) return false;
  switch (header.claim) {
    case TreeClaim::lossless: return errors.differs == 0;
    case TreeClaim::max_error: return errors.max_error_m <= header.claimed;
    case TreeClaim::psnr: return errors.rmse_m == 0 || errors.psnr_db() >= header.claimed * (1 - rounding);
    case TreeClaim::rmse: return errors.rmse_m <= header.claimed * (1 + rounding);
    case TreeClaim::bytes: return static_cast<double>(errors.bytes) <= header.claimed;
    case TreeClaim::none: break;
  }
  return true;
}

}  // namespace arete
