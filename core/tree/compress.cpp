#include "core/tree/compress.h"

#include <string>

#include "core/support/error.h"
#include "core/tree/fit_patches.h"
#include "core/tree/fit_predictive.h"
#include "core/tree/fit_wavelet.h"
#include "core/tree/tree_cells.h"

namespace arete {

CompressionReport compress(const StoredSource& source, TreeHeader header, const CompressOptions& options, const TreeWriter::Sink& sink, Progress* progress) {
  const TreeCells cells = read_tree_cells(source, header);
  header.claim = options.target.kind;
  header.claimed = options.target.value;
  const bool paper = options.profile == TreeProfile::paper;
  const bool strict = options.target.kind == TreeClaim::lossless || options.target.kind == TreeClaim::max_error;
  const FittedTree fitted = paper    ? fit_patches(cells, header, options, progress)
                            : strict ? fit_predictive(cells, header, options, progress) : fit_wavelet(cells, header, options, progress);
  if (fitted.file.empty())
    throw Error(ErrorKind::usage, options.target.kind == TreeClaim::bytes
                                      ? "no tree of this raster fits into " + std::to_string(static_cast<std::int64_t>(options.target.value)) + " bytes: give more"
                                      : "the quality asked for is beyond what the lossy coder reaches: ask for less, or for --lossless");
  sink(fitted.file);
  return {fitted.errors, fitted.coder, fitted.value_ratio};
}

}  // namespace arete
