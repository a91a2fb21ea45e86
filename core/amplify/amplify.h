#pragma once

#include <cstdint>

#include "core/sparse/dictionary.h"
#include "core/support/progress.h"
#include "core/terrain/raster_io.h"

namespace arete {

enum class AmplifyMethod {
  consistent,  ///< least-squares upsampling plus detail from the atoms; the area average of the result is the input
  paper        ///< the published algorithm: the coarse shape too is rebuilt from the atoms
};

struct AmplifyOptions {
  AmplifyMethod method = AmplifyMethod::consistent;
  int factor = 4;        ///< a power of the dictionary's factor: so many stages are repeated
  double detail = 1;     ///< consistent only: 0 least error ... 1 natural
  int sparsity = 1;      ///< atoms per patch
  int pitch = 0;         ///< coarse cells between patches, a divisor of the patch; 0: half a patch
  bool uncertainty = false;  ///< also the uncertainty band (consistent only)
  bool sources = false;      ///< also the exemplar and atom bands
  int threads = 0;
  std::int64_t memory_bytes = std::int64_t{1} << 30;
};

/// What was found out on the way.
struct AmplifyReport {
  int stages = 0;
  /// Power of the detail that the input shows between its own cells and cells `factor` times larger, over that of the exemplars at
  /// the same scale; 0 where one of them is too small to tell.
  double likeness = 0;
  bool unlike = false;     ///< likeness beyond a factor of `most_unlike`: the detail (and its uncertainty) was scaled by its root
  double detail_scale = 1;
};

/// Three times the detail power, or a third: different alpine terrains of the benchmark tests lie within a factor of 2, lidar of a
/// smooth hill and of a desert with ledges differ by 20.
inline constexpr double most_unlike = 3;

/// How many stages of `dictionary_factor` make `factor`. Throws Error{usage} where it is no power of it, or less than 2.
int count_stages(int factor, int dictionary_factor);

/// Amplifies `terrain` by the dictionary into `out`: band 0 the elevation, then uncertainty, exemplar, atom as far as wanted (see
/// AmplifiedBands), by windows that fit the memory budget. The result does not depend on the budget or on threads.
/// Throws Error{usage} for options out of range, Error{input} where the dictionary lacks what is wanted, Error{memory} where the
/// budget is too small for the dictionary and one window.
/// Cost per fine cell (defaults): about 81 + 4 multiply-adds, plus N K / (pitch factor)^2 to find the atoms.
AmplifyReport amplify(const RasterSource& terrain, Dictionary dictionary, const AmplifyOptions& options, RasterSink& out,
                      Progress& progress);

}  // namespace arete
