#include "core/terrain/overview.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/support/parallel.h"

namespace arete {
namespace {

struct Seen {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  std::int64_t valid = 0;
};

float average_block(RasterView<const float> block, Seen& seen) {
  double sum = 0;
  std::int64_t valid = 0;
  for (std::int64_t y = 0; y < block.height; ++y)
    for (std::int64_t x = 0; x < block.width; ++x) {
      const float z = block(x, y);
      if (is_void(z)) continue;
      sum += static_cast<double>(z);
      ++valid;
      seen.low = std::min(seen.low, static_cast<double>(z));
      seen.high = std::max(seen.high, static_cast<double>(z));
    }
  seen.valid += valid;
  return 2 * valid >= block.size().cells() ? static_cast<float>(sum / static_cast<double>(valid)) : void_value;
}

Seen average_part(const RasterSource& source, const Window& part, RasterView<float> out, std::int64_t across, std::int64_t down) {
  Raster<float> cells(part.width, part.height);
  source.read(part, cells.view());
  Seen seen;
  for (std::int64_t y = 0; y < out.height; ++y)
    for (std::int64_t x = 0; x < out.width; ++x) {
      const Window block{x * across, y * down, std::min(across, part.width - x * across), std::min(down, part.height - y * down)};
      out(x, y) = average_block(cells.view().sub(block), seen);
    }
  return seen;
}

}  // namespace

Overview make_overview(const RasterSource& source, std::int64_t across, std::int64_t down, int threads, Progress& progress) {
  const Size size = source.size();
  Overview overview;
  overview.across = across;
  overview.down = down;
  overview.cells = Raster<float>((size.width + across - 1) / across, (size.height + down - 1) / down);
  // Parts of about 512 x 512 cells of the source, of whole blocks.
  const std::int64_t wide = std::max<std::int64_t>(1, 512 / across), high = std::max<std::int64_t>(1, 512 / down);
  const std::int64_t columns = (overview.cells.width() + wide - 1) / wide, rows = (overview.cells.height() + high - 1) / high;
  Seen total;
  progress.begin("reading", rows);
  for (std::int64_t row = 0; row < rows; ++row) {
    std::vector<Seen> seen(static_cast<std::size_t>(columns));
    parallel_for(columns, threads, [&](std::int64_t column) {
      const std::int64_t x = column * wide, y = row * high;
      const Window out{x, y, std::min(wide, overview.cells.width() - x), std::min(high, overview.cells.height() - y)};
      const Window part{x * across, y * down, std::min(out.width * across, size.width - x * across),
                        std::min(out.height * down, size.height - y * down)};
      seen[static_cast<std::size_t>(column)] = average_part(source, part, overview.cells.view().sub(out), across, down);
    });
    for (const Seen& s : seen) {
      total.low = std::min(total.low, s.low);
      total.high = std::max(total.high, s.high);
      total.valid += s.valid;
    }
    progress.advance(1);
  }
  progress.end();
  overview.low_m = total.valid > 0 ? total.low : std::nan("");
  overview.high_m = total.valid > 0 ? total.high : std::nan("");
  overview.valid = total.valid;
  return overview;
}

}  // namespace arete
