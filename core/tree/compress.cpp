#include "core/tree/compress.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/support/error.h"
#include "core/tree/fit_patches.h"
#include "core/tree/fit_predictive.h"
#include "core/tree/fit_wavelet.h"
#include "core/tree/tree_cells.h"

namespace arete {
namespace {

void copy_bytes(const ByteSource& from, const TreeWriter::Sink& sink) {
  std::vector<std::byte> buffer(std::size_t{1} << 20);
  for (std::uint64_t position = 0; position < from.size(); position += buffer.size()) {
    buffer.resize(std::min<std::uint64_t>(buffer.size(), from.size() - position));
    from.read(position, buffer);
    sink(buffer);
  }
}

}  // namespace

CompressionReport compress(const StoredSource& source, TreeHeader header, const CompressOptions& options, const TreeWriter::Sink& sink, Progress* progress) {
  const TreeCells cells = read_tree_cells(source, header, options.scratch, progress);
  header.claim = options.target.kind;
  header.claimed = options.target.value;
  const bool paper = options.profile == TreeProfile::paper;
  const bool strict = options.target.kind == TreeClaim::lossless || options.target.kind == TreeClaim::max_error;
  const FittedTree fitted = paper    ? fit_patches(cells, header, options, progress)
                            : strict ? fit_predictive(cells, header, options, progress) : fit_wavelet(cells, header, options, progress);
  if (!fitted.file)
    throw Error(ErrorKind::usage, options.target.kind == TreeClaim::bytes
                                      ? "no tree of this raster fits into " + std::to_string(static_cast<std::int64_t>(options.target.value)) + " bytes: give more"
                                      : "the quality asked for is beyond what the lossy coder reaches: ask for less, or for --lossless");
  copy_bytes(*fitted.file, sink);
  return {fitted.errors, fitted.coder, fitted.value_ratio};
}

}  // namespace arete
