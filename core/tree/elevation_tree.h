#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/codec/patch_parameters.h"
#include "core/codec/predictive_coder.h"
#include "core/codec/tree_file.h"
#include "core/codec/value_map.h"
#include "core/codec/wavelet_coder.h"
#include "core/terrain/raster_io.h"

namespace arete {

/// A tree of elevations, read by level and window. Level 0 is the raster; level l has a cell for every 2^l-th one.
///
/// Guarantees: 1. any window of a level has the values that the whole level has. 2. A window touches only the nodes that it
/// depends on. 3. The values are the same on every machine, for any number of threads. 4. Safe for untrusted files: a damaged
/// node is an Error{damaged}, never wrong values.
/// The nodes decoded last are kept, 32 MB of them: the coarse levels of all windows, and what windows side by side share.
class ElevationTree final : public LevelSource {
 public:
  /// Reads the directory. Where it names a dictionary (the paper's profile), `find` gives it. Throws as TreeFile,
  /// parse_patch_parameters and `find`.
  explicit ElevationTree(TreeFile file, int threads = 1, const DictionaryFinder& find = {});
  static ElevationTree open(const std::string& path, int threads = 1, const DictionaryFinder& find = {});

  const TreeHeader& header() const { return file_.header(); }
  const TreeFile& file() const { return file_; }
  int levels() const override { return header().grid.levels(); }
  Size level_size(int level) const override { return header().grid.level_size(level); }

  /// Metres, NaN where void.
  void read_level(int level, const Window& window, RasterView<float> out) const override;
  /// The numbers as the source stored them, in the type of the header: NaN where void.
  void read_stored(int level, const Window& window, RasterView<double> out) const;
  /// Reads every node and checks it against its checksum. Throws Error{damaged}.
  void verify_checksums() const;

 private:
  bool has_flat_water() const { return header().coder == TreeCoder::wavelet && wavelet_.flat; }
  Raster<double> decode(int level, const Window& window) const;
  Raster<float> decode_surface(int level, const Window& window) const;
  template <class T>
  void write_metres(const Raster<T>& stored, RasterView<float> out) const;
  Raster<double> decode_numbers(int level, const Window& window) const;
  void set_flat_water(int level, const Window& window, Raster<double>& cells) const;
  Raster<std::uint64_t> decode_beside(int level, const Window& window) const;
  Raster<std::uint8_t> decode_mask(int level, const Window& window) const;

  TreeFile file_;
  int threads_;
  WaveletParameters wavelet_;
  PredictParameters predictive_;
  PatchParameters patches_;
  ValueMap map_;
  std::unique_ptr<CoefficientCache> coefficients_;
  std::unique_ptr<NumberCache> numbers_;
};

/// Parts of a window, row by row, each of which decodes within the memory (but for 64 MB, which the smallest part may need): as wide
/// as the window where that fits, their corners multiples of 1024 cells from the window's.
std::vector<Window> split_window(const Window& window, std::int64_t memory_bytes);

}  // namespace arete
