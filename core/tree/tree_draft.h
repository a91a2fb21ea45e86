#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/codec/patch_parameters.h"
#include "core/codec/tree_file.h"
#include "core/support/progress.h"
#include "core/support/scratch.h"
#include "core/tree/tree_cells.h"

namespace arete {

/// A tree's file in the making: takes the streams of a coder, joins them with those of flat water, if any, and of the masks, and gives
/// back what it was given.
class TreeDraft {
 public:
  /// `masks` and `flat` must outlive it.
  TreeDraft(const MaskStreams& masks, const MaskStreams& flat, const Scratch& scratch);
  /// Refers to this object.
  NodeStore nodes();
  /// Ends the file. `header` lacks only `voids`; `root` is the coder's.
  std::shared_ptr<const ByteSource> finish(TreeHeader header, const std::vector<std::byte>& root);

 private:
  class Bytes;
  std::vector<std::byte> join(const std::vector<std::byte>& flat, const std::vector<std::byte>& mask, std::vector<std::byte> stream) const;
  const MaskStreams& masks_;
  const MaskStreams& flat_;
  std::shared_ptr<Bytes> bytes_;
  TreeWriter writer_;
};

/// A tree's file and what it was measured to reach.
struct FittedTree {
  std::shared_ptr<const ByteSource> file;  ///< null where the target cannot be reached
  TreeErrors errors;
  TreeCoder coder = TreeCoder::wavelet;
  std::optional<ValueRatio> value_ratio;
};

/// What a reader of the file will find, against the original. `find` gives the dictionary where the file names one.
TreeErrors measure_file(const TreeCells& cells, const std::shared_ptr<const ByteSource>& file, const Scratch& scratch, int threads,
                        Progress* progress = nullptr, const DictionaryFinder& find = {});

}  // namespace arete
