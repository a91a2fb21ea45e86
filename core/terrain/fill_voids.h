#pragma once

#include <cstdint>

#include "core/terrain/raster.h"

namespace arete {

/// What fill_voids did.
struct VoidFill {
  std::int64_t cells = 0;  ///< void cells that were filled
  int iterations = 0;      ///< of the solver
};

/// Interpolates the void cells of `elevation` from the valid ones around them, in place: the membrane surface, for which every filled
/// cell is the mean of its (up to four) neighbours. It is the smoothest continuation in the sense of the slope's energy: it
/// continues a plane exactly, invents no peak and no pit, and is not meant as real ground. At the border of the raster the
/// surface runs out level (no neighbour, no pull).
///
/// Guarantees: 1. valid cells stay bit for bit. 2. No void is left. 3. Each filled cell lies between the lowest and the highest
/// valid neighbour of its hole (its 4-connected group of voids). 4. The same input gives the same bits.
///
/// Cost: linear in the cells, about 130 bytes per void cell besides the raster. Conjugate gradients on the five-point Laplacian, with
/// aggregation multigrid as the preconditioner (Notay, ETNA 37, 2010: aggregates of 2 x 2, W-cycle), until the energy
/// of the error is 1e-6 of the first.
/// Throws Error{input} where all cells are void (or there is none), Error{memory} beyond 2^31 - 1 void cells.
VoidFill fill_voids(RasterView<float> elevation);

}  // namespace arete
