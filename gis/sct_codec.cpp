// Our own: the compact sparse tree.
#include <vector>

#include "core/support/error.h"
#include "core/terrain/value_type.h"
#include "core/tree/compress.h"
#include "core/tree/elevation_tree.h"
#include "gis/peer_codecs.h"

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

class SctCodec final : public CodecUnderTest {
 public:
  std::string name() const override { return "sct"; }
  std::string title() const override { return "Arete .sct"; }
  std::string description() const override {
    return "A whole .sct file with voids, directory and checksums, as arete compress writes it; whole metres as 16-bit integers where they fit, else floats. "
           "Encoding to a size searches for it.";
  }
  bool keeps_voids() const override { return true; }
  std::int64_t bytes_per_cell() const override { return 64; }
  bool can(const TestedTerrain&, CodingTarget target) const override { return target.kind == CodingTarget::Kind::bytes; }
  std::optional<SettingsRange> settings_range(const TestedTerrain&) const override { return std::nullopt; }

  std::vector<std::byte> encode(const TestedTerrain& terrain, CodingTarget target, int threads) const override {
    TreeHeader header;
    const bool integers = terrain.quantum == 1 && holds(ValueType::int16, terrain.low) && holds(ValueType::int16, terrain.high);
    header.type = integers ? ValueType::int16 : ValueType::float32;
    CompressOptions options;
    options.target = {TreeClaim::bytes, target.value};
    options.threads = threads;
    std::vector<std::byte> file;
    compress(StoredTerrain(terrain), header, options, [&](std::span<const std::byte> bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
    return file;
  }

  void decode(std::span<const std::byte> bytes, RasterView<float> out, int threads) const override {
    const ElevationTree tree(TreeFile(view_bytes(bytes), "the tree of the benchmark"), threads);
    if (!(tree.size() == out.size())) throw Error(ErrorKind::format, "the tree of the benchmark does not give the size back");
    tree.read({0, 0, out.width, out.height}, out);
  }
};

}  // namespace

std::unique_ptr<CodecUnderTest> make_sct_codec() { return std::make_unique<SctCodec>(); }

}  // namespace arete
