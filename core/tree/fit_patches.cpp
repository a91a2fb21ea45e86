#include "core/tree/fit_patches.h"

#include "core/codec/patch_coder.h"

namespace arete {

FittedTree fit_patches(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress) {
  NoProgress silent;
  PatchCodingOptions coding = options.patches;
  coding.threads = options.threads;
  if (options.node_side > 0) coding.node_side = options.node_side;
  const Raster<float> filled = fill_cells(cells);
  const PatchStreams streams = encode_patches(filled.view(), coding, progress ? *progress : silent);
  TreeHeader about = header;
  about.coder = TreeCoder::patches;
  about.grid = streams.parameters.grid;
  about.claim = TreeClaim::none;
  about.parameters = serialise_patch_parameters(streams.parameters);
  const MaskStreams masks = encode_masks(cells, about.grid, options.threads);
  FittedTree fitted{write_tree(about, masks, streams.root, streams.nodes), {}, about.coder, {}};
  fitted.errors = measure_file(cells, fitted.file, options.threads);
  const PatchAtoms& atoms = streams.parameters.atoms;
  fitted.value_ratio = value_ratio(atoms.count, disc_samples(atoms.side), streams.discs, streams.parameters.sparsity, cells.stored.size().cells());
  return fitted;
}

}  // namespace arete
