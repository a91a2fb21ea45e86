#pragma once

#include "core/tree/compress.h"
#include "core/tree/elevation_tree.h"

namespace arete {

/// Stored numbers in memory.
class MemoryStored final : public StoredSource {
 public:
  explicit MemoryStored(Raster<double> cells) : cells_(std::move(cells)) {}
  Size size() const override { return cells_.size(); }
  void read_stored(const Window& window, RasterView<double> out) const override {
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) out(x, y) = cells_(window.x + x, window.y + y);
  }
  const Raster<double>& cells() const { return cells_; }

 private:
  Raster<double> cells_;
};

/// A raster as a tree in memory.
struct MadeTree {
  std::vector<std::byte> file;
  TreeErrors report;
};

inline MadeTree make_tree(const StoredSource& source, const TreeHeader& header, const CompressOptions& options) {
  MadeTree made;
  made.report = compress(source, header, options, [&](std::span<const std::byte> bytes) { made.file.insert(made.file.end(), bytes.begin(), bytes.end()); }).errors;
  return made;
}

/// `made` must outlive it.
inline ElevationTree open_tree(const MadeTree& made, int threads = 1) { return ElevationTree(TreeFile(view_bytes(made.file), "made.sct"), threads); }

}  // namespace arete
