#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/codec/patch_discs.h"
#include "core/codec/patch_parameters.h"
#include "core/support/progress.h"
#include "core/terrain/raster.h"

namespace arete {

// A raster as the paper's sparse tree (Guérin, Digne, Galin & Peytavie, Eurographics 2016): overlapping discs of radius R at pitch R, each a mean
// and up to s coefficients of atoms, blended by their falloff. Discs lie beyond the border too, so that the sum of weights is at
// least 0.5 everywhere. Bytes: core/codec/patch-format.md.

enum class PatchLearning { ksvd, constrained };

struct PatchCodingOptions {
  int atoms = 128;    ///< N to learn; fewer where the raster has fewer patches with relief
  int sparsity = 1;   ///< s, 1 to most_patch_sparsity
  int radius = 7;     ///< R in cells, least_patch_radius to greatest_patch_radius; 7 comes closest to the paper's counts
  int node_side = 512;
  PatchLearning learning = PatchLearning::ksvd;
  const Eigen::MatrixXf* dictionary = nullptr;  ///< (2 R)^2 x N unit columns (Dictionary::low) to use instead of learning
  std::string dictionary_name;                  ///< its dictionary_digest, where the file is not to hold the atoms
  double quantiser_loss_db = 0.1;  ///< the most PSNR that all quantisation may cost; no finer than 100 dB needs
  std::uint64_t seed = 1;
  int threads = 0;
};

struct PatchStreams {
  PatchParameters parameters;
  std::vector<std::byte> root;                ///< the discs of a raster without nodes (up to 8 x 8 cells); else empty
  std::vector<std::vector<std::byte>> nodes;  ///< by NodeGrid::index; those of level 1 hold discs, the others are empty
  double squared_error = 0;                   ///< of what is decoded, exactly, m^2 summed over the cells
  double unquantised_squared_error = 0;       ///< the same, before quantisation
  std::int64_t discs = 0;                     ///< n
  std::int64_t bytes() const;                 ///< parameters and streams
};

/// Learns (or takes) atoms, codes every disc by orthogonal matching pursuit, and quantises means, coefficients and atoms by steps
/// of equal slope: the coarsest that keep the loss. Cells must not be void. The same bytes for any number of threads.
/// Memory: about 4 bytes a cell beside the raster, and 1 KiB a patch for at most 65,536 patches to learn from.
/// Throws Error{usage} where an option is out of range or the dictionary does not fit the radius.
PatchStreams encode_patches(RasterView<const float> cells, const PatchCodingOptions& options, Progress& progress);

/// A window of a level, 0 to grid.levels(), metres: level l is f at the cells whose column and row are multiples of 2^l. Touches only the
/// nodes whose discs reach the window. The same values for any window and any number of threads. Safe for untrusted streams.
Raster<float> decode_patches(const PatchParameters& parameters, std::span<const std::byte> root, const StreamReader& streams, int level,
                             const Window& window, int threads);

}  // namespace arete
