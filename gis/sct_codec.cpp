// Our own: the compact sparse tree.
#include "core/support/error.h"
#include "gis/peer_codecs.h"
#include "gis/terrain_tree.h"

namespace arete {
namespace {

CompressionTarget target_of(CodingTarget target) {
  if (target.kind == CodingTarget::Kind::bytes) return {TreeClaim::bytes, target.value};
  if (target.kind == CodingTarget::Kind::max_error && target.value > 0) return {TreeClaim::max_error, target.value};
  return {TreeClaim::lossless, 0};
}

class SctCodec final : public CodecUnderTest {
 public:
  std::string name() const override { return "sct"; }
  std::string title() const override { return "Arete .sct"; }
  std::string description() const override {
    return "A whole .sct file with voids, directory and checksums, as arete compress writes it; whole metres as 16-bit integers where they fit, else floats. "
           "At a rate: the wavelet, encoding searches for the size. At a strict error and lossless: prediction.";
  }
  bool keeps_voids() const override { return true; }
  std::int64_t bytes_per_cell() const override { return 64; }
  bool can(const TestedTerrain&, CodingTarget target) const override { return target.kind != CodingTarget::Kind::setting; }
  std::optional<SettingsRange> settings_range(const TestedTerrain&) const override { return std::nullopt; }

  std::vector<std::byte> encode(const TestedTerrain& terrain, CodingTarget target, int threads) const override {
    CompressOptions options;
    options.target = target_of(target);
    options.threads = threads;
    try {
      return encode_tree(terrain, options).file;
    } catch (const Error& error) {
      // A bound below what floats resolve: to a user a fault of the input, here a target that the terrain does not allow.
      if (target.kind != CodingTarget::Kind::max_error || error.kind() != ErrorKind::input) throw;
      throw Error(ErrorKind::usage, error.what());
    }
  }

  void decode(std::span<const std::byte> bytes, RasterView<float> out, int threads) const override { decode_tree(bytes, out, threads); }
};

}  // namespace

std::unique_ptr<CodecUnderTest> make_sct_codec() { return std::make_unique<SctCodec>(); }

}  // namespace arete
