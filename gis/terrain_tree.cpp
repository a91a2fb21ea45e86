#include "gis/terrain_tree.h"

#include "core/support/error.h"
#include "core/terrain/value_type.h"
#include "core/tree/elevation_tree.h"

namespace arete {
namespace {

/// The terrain as a file would store it.
class StoredTerrain final : public StoredSource {
 public:
  explicit StoredTerrain(const TestedTerrain& terrain) : terrain_(terrain) {}
  Size size() const override { return terrain_.cells.size(); }
  void read_stored(const Window& window, RasterView<double> out) const override {
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) out(x, y) = static_cast<double>(terrain_.cells(window.x + x, window.y + y));
  }

 private:
  const TestedTerrain& terrain_;
};

}  // namespace

TerrainTree encode_tree(const TestedTerrain& terrain, const CompressOptions& options) {
  TreeHeader header;
  const bool integers = terrain.quantum == 1 && holds(ValueType::int16, terrain.low) && holds(ValueType::int16, terrain.high);
  header.type = integers ? ValueType::int16 : ValueType::float32;
  TerrainTree made;
  made.report =
      compress(StoredTerrain(terrain), header, options, [&](std::span<const std::byte> bytes) { made.file.insert(made.file.end(), bytes.begin(), bytes.end()); });
  return made;
}

void decode_tree(std::span<const std::byte> file, RasterView<float> out, int threads) {
  const ElevationTree tree(TreeFile(view_bytes(file), "the tree of the benchmark"), threads);
  if (!(tree.size() == out.size())) throw Error(ErrorKind::format, "the tree of the benchmark does not give the size back");
  tree.read({0, 0, out.width, out.height}, out);
}

}  // namespace arete
