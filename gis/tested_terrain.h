#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/terrain/raster.h"

namespace arete {

/// Terrain that codecs are tried on.
struct TestedTerrain {
  std::string name;
  Raster<float> cells;      ///< metres, NaN where void: what a decoded file is compared with
  Raster<float> filled;     ///< the same with voids filled (fill_voids), for codecs that cannot store them
  std::int64_t valid = 0;   ///< cells that are not void
  float low = 0, high = 0;  ///< of the valid cells; low < high
  double quantum = 0;       ///< metres; every valid cell is the float next to a whole multiple of it. 0: none was found
};

/// Takes `cells` over and looks at them. The quantum is the largest of `unit`, `unit`/10, /100 and /1000 (`unit`: the source's vertical
/// unit in metres) that all valid cells are whole multiples of. Throws Error{input} where no cell is valid or all are equal:
/// then there is no PSNR.
TestedTerrain examine_terrain(std::string name, Raster<float> cells, double unit = 1);

/// Elevation = (base + code x stride) x unit, computed in double and rounded to float.
struct LinearMap {
  double base = 0, stride = 1, unit = 1;
  float elevation(std::int64_t code) const { return static_cast<float>((base + static_cast<double>(code) * stride) * unit); }
};

/// Whole numbers from 0 that stand for elevations.
struct CodedTerrain {
  LinearMap map;
  Raster<std::int32_t> codes;
  std::int32_t highest = 0;  ///< code
};

/// The filled terrain mapped linearly to 0..65535: low to 0, high to 65535 (to float rounding). The map's base and stride are floats.
CodedTerrain scale_to_16_bits(const TestedTerrain& terrain);

/// Uniform steps so wide that every valid cell, a float, is within bound_m of the float that the map gives back: 2 n + 1 quanta for a bound
/// of n quanta that floats hold exactly, so that whole metres stay whole; twice the bound, less the rounding of floats, where there is
/// no quantum; the wider of both where floats round the quanta. (Two floats that stand for elevations 5 cm apart may differ by a little
/// more than 0.05.) Nullopt where floats are too coarse for the bound, or the codes need more than 31 bits.
struct UniformSteps {
  LinearMap map;
  std::int32_t highest = 0;  ///< code
  bool of_quanta = false;
};
std::optional<UniformSteps> steps_within(const TestedTerrain& terrain, double bound_m);

/// The filled terrain in those steps.
CodedTerrain quantise(const TestedTerrain& terrain, const UniformSteps& steps);

// A file of the benchmark is a byte that says which map follows (none, two floats for a map of unit 1, or three doubles), the map, and the
// file of the codec's library: the codec is charged with all that its decoder needs.

std::vector<std::byte> with_map(const std::optional<LinearMap>& map, std::span<const std::byte> file);

struct MappedFile {
  std::optional<LinearMap> map;
  std::span<const std::byte> file;
};
/// Throws Error{damaged} where the bytes end early or the first is unknown.
MappedFile read_map(std::span<const std::byte> bytes);

}  // namespace arete
