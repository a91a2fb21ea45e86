#pragma once

#include <vector>

#include "core/codec/patch_parameters.h"
#include "core/support/progress.h"
#include "gis/compression_trial.h"

namespace arete {

/// The published sparse tree (Guérin et al. 2016) at one sparsity, and JPEG 2000 in as many bytes.
struct PaperRow {
  int sparsity = 1;
  ValueRatio ratio = {};      ///< the paper's measure, beside the bytes of the whole file
  Measurement tree = {};      ///< `target`: the sparsity as a setting
  Measurement jpeg2000 = {};  ///< of the file nearest to the tree's size
};

/// The settings of the paper's table of compact storage.
inline constexpr int paper_atoms = 128;
inline constexpr int paper_sparsities[] = {1, 2, 8};

/// The paper's profile with paper_atoms learned on the terrain itself, at each of paper_sparsities, and `jpeg2000`, which takes sizes, at
/// the same bytes: six tries for a file within 0.02 %. Times are of one run. Progress counts a step for each sparsity.
/// Throws as the codecs.
std::vector<PaperRow> try_paper_profile(const TestedTerrain& terrain, const CodecUnderTest& jpeg2000, int threads, Progress& progress);

}  // namespace arete
