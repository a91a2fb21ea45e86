#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gis/tested_terrain.h"

namespace arete {

/// What a codec is asked for.
struct CodingTarget {
  enum class Kind {
    lossless,   ///< every valid cell bit for bit; `value` is ignored
    max_error,  ///< every valid cell within `value` metres; 0 too, where the codec can
    bytes,      ///< a file of about `value` bytes, as good as it gets
    setting,    ///< the codec's own setting, see CodecUnderTest::settings_range
  };
  Kind kind = Kind::lossless;
  double value = 0;
  bool operator==(const CodingTarget&) const = default;
};

/// The steps in which a codec of whole numbers keeps a target of kind lossless or max_error; nullopt where there are none: lossless
/// coding needs a quantum.
inline std::optional<UniformSteps> steps_for(const TestedTerrain& terrain, CodingTarget target) {
  if (target.kind == CodingTarget::Kind::max_error) return steps_within(terrain, target.value);
  return terrain.quantum > 0 ? steps_within(terrain, 0) : std::nullopt;
}

/// A codec of terrain as the benchmark sees it: an encoder from terrain to the bytes of a whole file, and a decoder that needs nothing
/// but those bytes. Both may be called from one thread at a time.
class CodecUnderTest {
 public:
  virtual ~CodecUnderTest() = default;

  virtual std::string name() const = 0;         ///< short, of a-z, 0-9 and -: for --peers and for data
  virtual std::string title() const = 0;        ///< for legends and tables
  virtual std::string description() const = 0;  ///< one sentence for people: which settings, what is not stored
  virtual bool keeps_voids() const = 0;         ///< false: it is given the terrain with its voids filled

  /// Memory that it takes at most beside the terrain, per cell, as measured on a raster of 5 million cells.
  virtual std::int64_t bytes_per_cell() const = 0;

  /// Whether it can try this target on this terrain.
  virtual bool can(const TestedTerrain& terrain, CodingTarget target) const = 0;

  struct SettingsRange {
    double coarse, fine;  ///< both above 0; the file grows from coarse to fine, about evenly in the setting's logarithm
  };
  /// For a codec that cannot be asked for a size: its setting that makes files smaller or larger. Nullopt: it takes `bytes`, or neither.
  virtual std::optional<SettingsRange> settings_range(const TestedTerrain& terrain) const = 0;

  /// Everything that decode needs. threads >= 1. Throws Error{usage} where this terrain does not allow the target (too few bytes for
  /// any file), Error{format} where the library behind it fails.
  virtual std::vector<std::byte> encode(const TestedTerrain& terrain, CodingTarget target, int threads) const = 0;

  /// Elevations in metres into `out`, which has the terrain's size. Throws as encode.
  virtual void decode(std::span<const std::byte> file, RasterView<float> out, int threads) const = 0;
};

}  // namespace arete
