#include "core/tree/measure.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace arete {

double TreeErrors::psnr_db() const { return 20 * std::log10((highest_m - lowest_m) / rmse_m); }

TreeErrors measure_tree(const ElevationTree& tree, const StoredSource& original, std::int64_t strip_rows) {
  const Size size = tree.size();
  TreeErrors errors;
  errors.bytes = tree.file().bytes();
  errors.cells = size.cells();
  double squares = 0, greatest = 0, lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (std::int64_t y = 0; y < size.height; y += strip_rows) {
    const Window at{0, y, size.width, std::min(strip_rows, size.height - y)};
    Raster<double> decoded(at.width, at.height), truth(at.width, at.height);
    tree.read_stored(0, at, decoded.view());
    original.read_stored(at, truth.view());
    for (std::int64_t i = 0; i < at.width * at.height; ++i) {
      const double found = decoded.data()[i], wanted = truth.data()[i];
      if (std::isnan(wanted) || std::isnan(found)) {
        errors.void_differs += std::isnan(wanted) != std::isnan(found);
        errors.valid_cells += !std::isnan(wanted);
        continue;
      }
      ++errors.valid_cells;
      errors.differs += std::bit_cast<std::uint64_t>(found) != std::bit_cast<std::uint64_t>(wanted);
      const double error = std::abs(found - wanted);
      squares += error * error;
      greatest = std::max(greatest, error);
      lowest = std::min(lowest, wanted);
      highest = std::max(highest, wanted);
    }
  }
  const double metres = std::abs(tree.header().scale) * tree.header().geo.metres_per_unit;
  errors.rmse_m = std::sqrt(squares / static_cast<double>(std::max<std::int64_t>(errors.valid_cells, 1))) * metres;
  errors.max_error_m = greatest * metres;
  errors.lowest_m = lowest * metres;
  errors.highest_m = highest * metres;
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
