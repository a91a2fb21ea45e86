#include "core/tree/fit_predictive.h"

#include <optional>
#include <string>
#include <utility>

#include "core/codec/byte_stream.h"
#include "core/codec/predictive_encoder.h"
#include "core/codec/value_map.h"
#include "core/support/error.h"

namespace arete {
namespace {

constexpr int default_side = 256;

BoundedMap choose_map(const TreeCells& cells, const TreeHeader& header, const CompressionTarget& target) {
  ValueSurvey survey(header.type, cells.range);
  visit_cells(*cells.stored, [&](const Window&, const Raster<double>& part) { survey.add(StoredValues(part.data(), static_cast<std::size_t>(part.size().cells()))); });
  if (target.kind == TreeClaim::lossless) {
    const std::optional<ValueMap> map = survey.lossless();
    if (!map)
      throw Error(ErrorKind::input, "these 64-bit numbers have no lossless form here: they are neither 32-bit floats nor multiples of a common "
                                    "quantum; give --max-error, as small as you need");
    return {*map, 1};
  }
  const std::optional<BoundedMap> map = map_within(survey, target.value / cells.metres_per_stored);
  if (!map)
    throw Error(ErrorKind::input, "a largest error of " + std::to_string(target.value) + " m is below what " + std::string(name_of(header.type)) +
                                      " resolves at these elevations: give a larger one, or --lossless");
  return *map;
}

}  // namespace

FittedTree fit_predictive(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress) {
  NoProgress silent;
  Progress& told = progress ? *progress : silent;
  const BoundedMap bounded = choose_map(cells, header, options.target);
  TreeHeader about = header;
  about.coder = TreeCoder::predictive;
  about.grid = NodeGrid(cells.size(), options.node_side > 0 ? options.node_side : default_side);
  const MaskStreams masks = encode_masks(cells, about.grid, options.scratch, options.threads);
  PredictiveEncoding coding;
  coding.step = bounded.step;
  coding.threads = options.threads;
  coding.scratch = options.scratch;
  coding.progress = [&](std::int64_t nodes) { told.advance(nodes); };
  TreeDraft draft(masks, options.scratch);
  told.begin("encoding", about.grid.node_count());
  const PredictiveSummary summary = encode_predictive(MappedCells(cells, bounded.map), about.grid, coding, draft.nodes());
  told.end();
  ByteWriter parameters;
  put_value_map(bounded.map, parameters);
  parameters.put_bytes(encode_parameters(summary.parameters));
  about.parameters = parameters.take();
  FittedTree fitted{draft.finish(about, summary.root), {}, about.coder, {}};
  fitted.errors = measure_file(cells, fitted.file, options.scratch, options.threads);
  if (!keeps_claim(about, fitted.errors))
    throw Error(ErrorKind::input, "the tree came out with an error of " + std::to_string(fitted.errors.max_error_m) +
                                      " m where less was promised: this is a fault of the program, nothing was written");
  return fitted;
}

}  // namespace arete
