// JPEG 2000 by OpenJPEG itself: GDAL's driver decodes a single tile with one thread only.
#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include <openjpeg.h>

#include "core/support/error.h"
#include "gis/peer_codecs.h"

namespace arete {
namespace {

using Codec = std::unique_ptr<opj_codec_t, decltype(&opj_destroy_codec)>;
using Image = std::unique_ptr<opj_image_t, decltype(&opj_image_destroy)>;
using Stream = std::unique_ptr<opj_stream_t, decltype(&opj_stream_destroy)>;

/// A file in memory for OpenJPEG to write or read.
struct MemoryFile {
  std::vector<std::byte> bytes;
  std::span<const std::byte> source;
  std::size_t at = 0;

  static OPJ_SIZE_T write(void* buffer, OPJ_SIZE_T count, void* self) {
    auto& file = *static_cast<MemoryFile*>(self);
    if (file.at + count > file.bytes.size()) file.bytes.resize(file.at + count);
    std::memcpy(file.bytes.data() + file.at, buffer, count);
    file.at += count;
    return count;
  }
  static OPJ_SIZE_T read(void* buffer, OPJ_SIZE_T count, void* self) {
    auto& file = *static_cast<MemoryFile*>(self);
    const std::size_t left = file.source.size() - file.at;
    if (left == 0) return static_cast<OPJ_SIZE_T>(-1);
    const std::size_t taken = std::min<std::size_t>(count, left);
    std::memcpy(buffer, file.source.data() + file.at, taken);
    file.at += taken;
    return taken;
  }
  std::size_t end() const { return source.empty() ? bytes.size() : source.size(); }
  static OPJ_OFF_T skip(OPJ_OFF_T count, void* self) {
    auto& file = *static_cast<MemoryFile*>(self);
    if (count < 0) return -1;
    file.at = std::min(file.at + static_cast<std::size_t>(count), file.source.empty() ? file.at + static_cast<std::size_t>(count) : file.end());
    return count;
  }
  static OPJ_BOOL seek(OPJ_OFF_T to, void* self) {
    auto& file = *static_cast<MemoryFile*>(self);
    if (to < 0 || static_cast<std::size_t>(to) > file.end()) return OPJ_FALSE;
    file.at = static_cast<std::size_t>(to);
    return OPJ_TRUE;
  }
};

Stream open_stream(MemoryFile& file, bool input) {
  Stream stream(opj_stream_create(OPJ_J2K_STREAM_CHUNK_SIZE, input ? OPJ_TRUE : OPJ_FALSE), opj_stream_destroy);
  opj_stream_set_user_data(stream.get(), &file, nullptr);
  opj_stream_set_user_data_length(stream.get(), file.source.size());
  opj_stream_set_write_function(stream.get(), MemoryFile::write);
  opj_stream_set_read_function(stream.get(), MemoryFile::read);
  opj_stream_set_skip_function(stream.get(), MemoryFile::skip);
  opj_stream_set_seek_function(stream.get(), MemoryFile::seek);
  return stream;
}

/// Keeps OpenJPEG's first message, for ours.
struct Messages {
  std::string first;
  static void keep(const char* text, void* self) {
    auto& messages = *static_cast<Messages*>(self);
    if (!messages.first.empty()) return;
    messages.first = text;
    while (!messages.first.empty() && messages.first.back() == '\n') messages.first.pop_back();
  }
  void demand(bool worked, const std::string& what) const {
    if (!worked) throw Error(ErrorKind::format, "OpenJPEG cannot " + what + (first.empty() ? "" : ": " + first));
  }
};

Image make_image(const CodedTerrain& coded) {
  opj_image_cmptparm_t component{};
  component.dx = component.dy = 1;
  component.w = static_cast<OPJ_UINT32>(coded.codes.width());
  component.h = static_cast<OPJ_UINT32>(coded.codes.height());
  component.prec = 1;
  while (coded.highest >> component.prec != 0) ++component.prec;
  Image image(opj_image_create(1, &component, OPJ_CLRSPC_GRAY), opj_image_destroy);
  if (!image) throw Error(ErrorKind::memory, "OpenJPEG has no memory for " + std::to_string(coded.codes.size().cells()) + " cells");
  image->x1 = component.w;
  image->y1 = component.h;
  std::memcpy(image->comps[0].data, coded.codes.data(), static_cast<std::size_t>(coded.codes.size().cells()) * sizeof(OPJ_INT32));
  return image;
}

/// A codestream without boxes and comments. `bytes` <= 0: reversible.
std::vector<std::byte> encode_codestream(const CodedTerrain& coded, double bytes, int threads) {
  const Image image = make_image(coded);
  opj_cparameters_t parameters;
  opj_set_default_encoder_parameters(&parameters);
  const bool lossy = bytes > 0;
  parameters.irreversible = lossy ? 1 : 0;
  // 6, or as many as OpenJPEG allows: 2^(n - 1) cells on the shorter side.
  const std::int64_t shorter = std::min(coded.codes.width(), coded.codes.height());
  for (parameters.numresolution = 1; parameters.numresolution < 6 && std::int64_t{1} << parameters.numresolution <= shorter;) ++parameters.numresolution;
  parameters.tcp_numlayers = 1;
  parameters.cp_disto_alloc = 1;
  const double raw_bytes = static_cast<double>(coded.codes.size().cells()) * image->comps[0].prec / 8;
  parameters.tcp_rates[0] = lossy ? static_cast<float>(std::max(1.0, raw_bytes / bytes)) : 0;
  char no_comment[] = "";
  parameters.cp_comment = no_comment;

  MemoryFile file;
  Messages messages;
  const Codec codec(opj_create_compress(OPJ_CODEC_J2K), opj_destroy_codec);
  opj_set_error_handler(codec.get(), Messages::keep, &messages);
  messages.demand(opj_setup_encoder(codec.get(), &parameters, image.get()), "be set up");
  if (threads > 1) opj_codec_set_threads(codec.get(), threads);
  const Stream stream = open_stream(file, false);
  messages.demand(opj_start_compress(codec.get(), image.get(), stream.get()) && opj_encode(codec.get(), stream.get()) &&
                      opj_end_compress(codec.get(), stream.get()),
                  "encode");
  return std::move(file.bytes);
}

void decode_codestream(std::span<const std::byte> bytes, const LinearMap& map, RasterView<float> out, int threads) {
  MemoryFile file;
  file.source = bytes;
  Messages messages;
  const Codec codec(opj_create_decompress(OPJ_CODEC_J2K), opj_destroy_codec);
  opj_set_error_handler(codec.get(), Messages::keep, &messages);
  opj_dparameters_t parameters;
  opj_set_default_decoder_parameters(&parameters);
  messages.demand(opj_setup_decoder(codec.get(), &parameters), "be set up");
  if (threads > 1) opj_codec_set_threads(codec.get(), threads);
  const Stream stream = open_stream(file, true);
  opj_image_t* decoded = nullptr;
  const bool headed = opj_read_header(stream.get(), codec.get(), &decoded);
  const Image image(decoded, opj_image_destroy);
  messages.demand(headed && opj_decode(codec.get(), stream.get(), image.get()), "decode");
  messages.demand(image->numcomps == 1 && image->comps[0].w == out.width && image->comps[0].h == out.height, "give the size back");
  for (std::int64_t y = 0; y < out.height; ++y)
    for (std::int64_t x = 0; x < out.width; ++x) out(x, y) = map.elevation(image->comps[0].data[y * out.width + x]);
}

class OpenJpegCodec final : public CodecUnderTest {
 public:
  std::string name() const override { return "openjpeg"; }
  std::string title() const override { return "JPEG 2000 (OpenJPEG)"; }
  std::string description() const override {
    return "OpenJPEG, one tile, 6 resolutions, a codestream without boxes. At a rate: elevations scaled to the full 16 bits, irreversible 9/7, "
           "the size asked for in bytes. At a strict error and lossless: uniform steps (whole quanta where the data have them), reversible 5/3.";
  }
  bool keeps_voids() const override { return false; }
  std::int64_t bytes_per_cell() const override { return 32; }
  bool can(const TestedTerrain& terrain, CodingTarget target) const override {
    if (target.kind == CodingTarget::Kind::bytes) return true;
    if (target.kind == CodingTarget::Kind::setting) return false;
    const std::optional<UniformSteps> steps = steps_for(terrain, target);
    return steps && steps->highest < 1 << 16;
  }
  std::optional<SettingsRange> settings_range(const TestedTerrain&) const override { return std::nullopt; }

  std::vector<std::byte> encode(const TestedTerrain& terrain, CodingTarget target, int threads) const override {
    if (target.kind == CodingTarget::Kind::bytes) {
      const CodedTerrain coded = scale_to_16_bits(terrain);
      const double overhead = static_cast<double>(with_map(coded.map, {}).size());
      return with_map(coded.map, encode_codestream(coded, std::max(1.0, target.value - overhead), threads));
    }
    const CodedTerrain coded = quantise(terrain, steps_for(terrain, target).value());
    return with_map(coded.map, encode_codestream(coded, 0, threads));
  }

  void decode(std::span<const std::byte> bytes, RasterView<float> out, int threads) const override {
    const MappedFile file = read_map(bytes);
    decode_codestream(file.file, file.map.value_or(LinearMap{}), out, threads);
  }
};

}  // namespace

std::unique_ptr<CodecUnderTest> make_openjpeg_codec() { return std::make_unique<OpenJpegCodec>(); }

}  // namespace arete
