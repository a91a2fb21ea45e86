#include "core/tree/fit_predictive.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/codec/byte_stream.h"
#include "core/codec/predictive_coder.h"
#include "core/codec/value_map.h"
#include "core/support/error.h"

namespace arete {
namespace {

constexpr int default_side = 256;

BoundedMap choose_map(const TreeCells& cells, const TreeHeader& header, const CompressionTarget& target) {
  const StoredValues values(cells.stored.data(), static_cast<std::size_t>(cells.stored.size().cells()));
  if (target.kind == TreeClaim::lossless) {
    const std::optional<ValueMap> map = map_lossless(header.type, values);
    if (!map)
      throw Error(ErrorKind::input, "these 64-bit numbers have no lossless form here: they are neither 32-bit floats nor multiples of a common "
                                    "quantum; give --max-error, as small as you need");
    return {*map, 1};
  }
  const std::optional<BoundedMap> map = map_within(header.type, values, target.value / cells.metres_per_stored);
  if (!map)
    throw Error(ErrorKind::input, "a largest error of " + std::to_string(target.value) + " m is below what " + std::string(name_of(header.type)) +
                                      " resolves at these elevations: give a larger one, or --lossless");
  return *map;
}

Raster<std::int32_t> map_cells(const TreeCells& cells, const ValueMap& map) {
  Raster<std::int32_t> numbers(cells.stored.width(), cells.stored.height());
  for (std::int64_t i = 0; i < numbers.size().cells(); ++i) {
    const double value = cells.stored.data()[i];
    numbers.data()[i] = std::isnan(value) ? 0 : map.number_of(value);
  }
  return numbers;
}

}  // namespace

FittedTree fit_predictive(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress) {
  const BoundedMap bounded = choose_map(cells, header, options.target);
  const Raster<std::int32_t> numbers = map_cells(cells, bounded.map);
  TreeHeader about = header;
  about.coder = TreeCoder::predictive;
  about.grid = NodeGrid(cells.stored.size(), options.node_side > 0 ? options.node_side : default_side);
  const MaskStreams masks = encode_masks(cells, about.grid, options.threads);
  const RasterView<const std::uint8_t> voids = cells.any_void ? cells.voids.cells.view() : RasterView<const std::uint8_t>{};
  PredictiveOptions coding;
  coding.step = bounded.step;
  coding.threads = options.threads;
  if (progress) progress->advance(1);
  const PredictiveStreams streams = encode_predictive(numbers.view(), voids, about.grid, coding);
  ByteWriter parameters;
  put_value_map(bounded.map, parameters);
  parameters.put_bytes(encode_parameters(streams.parameters));
  about.parameters = parameters.take();
  FittedTree fitted{write_tree(about, masks, streams.root, streams.nodes), {}, about.coder, {}};
  fitted.errors = measure_file(cells, fitted.file, options.threads);
  if (!keeps_claim(about, fitted.errors))
    throw Error(ErrorKind::input, "the tree came out with an error of " + std::to_string(fitted.errors.max_error_m) +
                                      " m where less was promised: this is a fault of the program, nothing was written");
  return fitted;
}

}  // namespace arete
