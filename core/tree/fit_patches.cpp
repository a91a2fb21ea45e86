#include "core/tree/fit_patches.h"

#include <string>

#include "core/codec/patch_coder.h"
#include "core/support/error.h"
#include "core/terrain/raster_io.h"

namespace arete {

FittedTree fit_patches(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress) {
  NoProgress silent;
  PatchCodingOptions coding = options.patches;
  coding.threads = options.threads;
  if (options.node_side > 0) coding.node_side = options.node_side;
  // Learning looks at all patches at once.
  constexpr std::int64_t bytes_per_cell = 24;
  if (cells.size().cells() > options.scratch.memory_bytes / bytes_per_cell)
    throw Error(ErrorKind::memory, "the paper's profile holds the whole raster, about " + std::to_string(bytes_per_cell * cells.size().cells() / 1'000'000) +
                                       " MB, of which " + std::to_string(options.scratch.memory_bytes / 1'000'000) +
                                       " MB are allowed: give more --memory, a part of the raster, or --profile best");
  const Raster<float> filled = read_all(FilledCells(cells, options.scratch, options.threads));
  const PatchStreams streams = encode_patches(filled.view(), coding, progress ? *progress : silent);
  TreeHeader about = header;
  about.coder = TreeCoder::patches;
  about.grid = streams.parameters.grid;
  about.claim = TreeClaim::none;
  about.parameters = serialise_patch_parameters(streams.parameters);
  const MaskStreams masks = encode_masks(cells, about.grid, options.scratch, options.threads);
  const MaskStreams no_flat;
  TreeDraft draft(masks, no_flat, options.scratch);
  const NodeStore nodes = draft.nodes();
  for (const std::vector<std::byte>& stream : streams.nodes) nodes.add(stream);
  FittedTree fitted{draft.finish(about, streams.root), {}, about.coder, {}};
  const auto given = [&](const std::string&) { return *coding.dictionary; };
  fitted.errors = measure_file(cells, fitted.file, options.scratch, options.threads, progress, given);
  const PatchAtoms& atoms = streams.parameters.atoms;
  fitted.value_ratio = value_ratio(atoms.count, disc_samples(atoms.side), streams.discs, streams.parameters.sparsity, cells.size().cells());
  return fitted;
}

}  // namespace arete
