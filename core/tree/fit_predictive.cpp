#include "core/tree/fit_predictive.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/codec/beside_numbers.h"
#include "core/codec/byte_stream.h"
#include "core/codec/predictive_encoder.h"
#include "core/codec/stream_parts.h"
#include "core/codec/value_map.h"
#include "core/support/error.h"

namespace arete {
namespace {

constexpr int default_side = 256;

// The maps to try: the one whose tree is the smallest counts.
std::vector<BoundedMap> choose_maps(const TreeCells& cells, const TreeHeader& header, const CompressionTarget& target) {
  ValueSurvey survey(header.type, cells.range);
  visit_cells(*cells.stored, [&](const Window&, const Raster<double>& part) { survey.add(StoredValues(part.data(), static_cast<std::size_t>(part.size().cells()))); });
  if (target.kind == TreeClaim::lossless) {
    const std::optional<ValueMap> map = survey.lossless();
    if (!map)
      throw Error(ErrorKind::input, "these whole numbers span more than 31 bits: give --max-error, as small as you need");
    std::vector<BoundedMap> maps{{*map, 1}};
    if (const std::optional<ValueMap> near = survey.nearly_quantised()) maps.push_back({*near, 1});
    return maps;
  }
  const std::optional<BoundedMap> map = map_within(survey, target.value / cells.metres_per_stored);
  if (!map)
    throw Error(ErrorKind::input, "a largest error of " + std::to_string(target.value) + " m is below what " + std::string(name_of(header.type)) +
                                      " resolves at these elevations: give a larger one, or --lossless");
  return {*map};
}

std::vector<std::byte> pack_root(const TreeCells& cells, const ValueMap& map, const NodeGrid& grid) {
  const Size size = grid.level_size(grid.levels());
  return pack_beside(map, read_level(*cells.stored, grid.levels(), {0, 0, size.width, size.height}).view(), StreamCells::all);
}

// Nodes of a map that keeps something beside its numbers carry it behind these.
NodeStore with_beside(const TreeCells& cells, const ValueMap& map, const NodeGrid& grid, NodeStore nodes) {
  if (!map.has_beside()) return nodes;
  const auto add = [&cells, map, grid, nodes, index = std::int64_t{0}](std::vector<std::byte> stream) mutable {
    const NodeAddress node = grid.address(index++);
    const Raster<double> block = read_level(*cells.stored, node.level - 1, grid.cells(node));
    nodes.add(join_parts({std::move(stream), pack_beside(map, block.view(), StreamCells::off_lattice)}));
  };
  return {add, {}};
}

std::shared_ptr<const ByteSource> encode(const TreeCells& cells, const TreeHeader& header, const BoundedMap& bounded, const CompressOptions& options, Progress& told) {
  TreeHeader about = header;
  about.coder = TreeCoder::predictive;
  about.grid = NodeGrid(cells.size(), options.node_side > 0 ? options.node_side : default_side);
  const MaskStreams masks = encode_masks(cells, about.grid, options.scratch, options.threads);
  PredictiveEncoding coding;
  coding.step = bounded.step;
  coding.threads = options.threads;
  coding.scratch = options.scratch;
  coding.progress = [&](std::int64_t nodes) { told.advance(nodes); };
  const MaskStreams no_flat;
  TreeDraft draft(masks, no_flat, options.scratch);
  told.begin("encoding", about.grid.node_count());
  PredictiveSummary summary =
      encode_predictive(MappedCells(cells, bounded.map), about.grid, coding, with_beside(cells, bounded.map, about.grid, draft.nodes()));
  if (bounded.map.has_beside()) summary.root = join_parts({std::move(summary.root), pack_root(cells, bounded.map, about.grid)});
  told.end();
  ByteWriter parameters;
  put_value_map(bounded.map, parameters);
  parameters.put_bytes(encode_parameters(summary.parameters));
  about.parameters = parameters.take();
  return draft.finish(about, summary.root);
}

FittedTree encode_smallest(const TreeCells& cells, const TreeHeader& header, const std::vector<BoundedMap>& maps, const CompressOptions& options, Progress& told) {
  FittedTree fitted;
  fitted.coder = TreeCoder::predictive;
  for (const BoundedMap& bounded : maps) {
    std::shared_ptr<const ByteSource> file = encode(cells, header, bounded, options, told);
    if (!fitted.file || file->size() < fitted.file->size()) fitted.file = std::move(file);
  }
  fitted.errors = measure_file(cells, fitted.file, options.scratch, options.threads, &told);
  return fitted;
}

}  // namespace

FittedTree fit_predictive(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress) {
  NoProgress silent;
  Progress& told = progress ? *progress : silent;
  FittedTree fitted = encode_smallest(cells, header, choose_maps(cells, header, options.target), options, told);
  // A cell that is decoded to the nodata value is written as the next: where that breaks the bound, all keep within one that leaves room for it.
  if (const double step = nodata_step(header); options.target.kind == TreeClaim::max_error && step > 0 && !keeps_claim(header, fitted.errors)) {
    CompressionTarget closer = options.target;
    closer.value = std::max(0.0, closer.value - step * cells.metres_per_stored);
    if (!is_integer(header.type)) closer.value *= 1 - 1e-9;  // a step of floats is less than what map_within takes for rounding
    fitted = encode_smallest(cells, header, choose_maps(cells, header, closer), options, told);
  }
  if (!keeps_claim(header, fitted.errors))
    throw Error(ErrorKind::input, "the tree came out with an error of " + std::to_string(fitted.errors.max_error_m) +
                                      " m where less was promised: this is a fault of the program, nothing was written");
  return fitted;
}

}  // namespace arete
