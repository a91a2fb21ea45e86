// JPEG XL by libjxl: its modular mode where no value may change, its lossy mode (VarDCT) by distance else.
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include <jxl/decode.h>
#include <jxl/encode.h>
#include <jxl/thread_parallel_runner.h>

#include "core/support/error.h"
#include "gis/peer_codecs.h"

namespace arete {
namespace {

constexpr int effort = 7;
constexpr std::int32_t highest_code = 65535;
constexpr JxlPixelFormat grey16 = {1, JXL_TYPE_UINT16, JXL_NATIVE_ENDIAN, 0};

using Encoder = std::unique_ptr<JxlEncoder, decltype(&JxlEncoderDestroy)>;
using Decoder = std::unique_ptr<JxlDecoder, decltype(&JxlDecoderDestroy)>;
using Runner = std::unique_ptr<void, decltype(&JxlThreadParallelRunnerDestroy)>;

Runner make_runner(int threads) {
  return Runner(JxlThreadParallelRunnerCreate(nullptr, static_cast<std::size_t>(threads)), JxlThreadParallelRunnerDestroy);
}

void demand(bool worked, const char* what) {
  if (!worked) throw Error(ErrorKind::format, std::string("libjxl cannot ") + what);
}

std::vector<std::uint16_t> narrow(const CodedTerrain& coded) {
  std::vector<std::uint16_t> samples(static_cast<std::size_t>(coded.codes.size().cells()));
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<std::uint16_t>(coded.codes.data()[i]);
  return samples;
}

std::vector<std::byte> collect_output(JxlEncoder* encoder) {
  std::vector<std::byte> bytes(std::size_t{1} << 16);
  std::size_t done = 0;
  for (;;) {
    auto* next = reinterpret_cast<std::uint8_t*>(bytes.data() + done);
    std::size_t room = bytes.size() - done;
    const JxlEncoderStatus status = JxlEncoderProcessOutput(encoder, &next, &room);
    done = bytes.size() - room;
    if (status == JXL_ENC_SUCCESS) break;
    demand(status == JXL_ENC_NEED_MORE_OUTPUT, "encode");
    bytes.resize(2 * bytes.size());
  }
  bytes.resize(done);
  return bytes;
}

/// A bare codestream. distance 0: lossless.
std::vector<std::byte> encode_samples(const std::vector<std::uint16_t>& samples, Size size, double distance, int threads) {
  const Runner runner = make_runner(threads);
  const Encoder encoder(JxlEncoderCreate(nullptr), JxlEncoderDestroy);
  demand(JxlEncoderSetParallelRunner(encoder.get(), JxlThreadParallelRunner, runner.get()) == JXL_ENC_SUCCESS, "use threads");
  JxlBasicInfo info;
  JxlEncoderInitBasicInfo(&info);
  info.xsize = static_cast<std::uint32_t>(size.width);
  info.ysize = static_cast<std::uint32_t>(size.height);
  info.bits_per_sample = 16;
  info.num_color_channels = 1;
  info.uses_original_profile = distance > 0 ? JXL_FALSE : JXL_TRUE;
  demand(JxlEncoderSetBasicInfo(encoder.get(), &info) == JXL_ENC_SUCCESS, "take the size");
  JxlColorEncoding colour;
  JxlColorEncodingSetToSRGB(&colour, JXL_TRUE);
  demand(JxlEncoderSetColorEncoding(encoder.get(), &colour) == JXL_ENC_SUCCESS, "take grey");
  JxlEncoderFrameSettings* frame = JxlEncoderFrameSettingsCreate(encoder.get(), nullptr);
  demand(JxlEncoderFrameSettingsSetOption(frame, JXL_ENC_FRAME_SETTING_EFFORT, effort) == JXL_ENC_SUCCESS, "set its effort");
  if (distance > 0)
    demand(JxlEncoderSetFrameDistance(frame, static_cast<float>(distance)) == JXL_ENC_SUCCESS, "set this distance");
  else
    demand(JxlEncoderSetFrameLossless(frame, JXL_TRUE) == JXL_ENC_SUCCESS, "be lossless");
  demand(JxlEncoderAddImageFrame(frame, &grey16, samples.data(), samples.size() * sizeof samples[0]) == JXL_ENC_SUCCESS, "take the samples");
  JxlEncoderCloseInput(encoder.get());
  return collect_output(encoder.get());
}

std::vector<std::uint16_t> decode_samples(std::span<const std::byte> bytes, Size size, int threads) {
  const Runner runner = make_runner(threads);
  const Decoder decoder(JxlDecoderCreate(nullptr), JxlDecoderDestroy);
  demand(JxlDecoderSetParallelRunner(decoder.get(), JxlThreadParallelRunner, runner.get()) == JXL_DEC_SUCCESS, "use threads");
  demand(JxlDecoderSubscribeEvents(decoder.get(), JXL_DEC_BASIC_INFO | JXL_DEC_FULL_IMAGE) == JXL_DEC_SUCCESS, "be set up");
  JxlDecoderSetInput(decoder.get(), reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  JxlDecoderCloseInput(decoder.get());
  std::vector<std::uint16_t> samples(static_cast<std::size_t>(size.cells()));
  for (;;) switch (JxlDecoderProcessInput(decoder.get())) {
      case JXL_DEC_BASIC_INFO: {
        JxlBasicInfo info;
        demand(JxlDecoderGetBasicInfo(decoder.get(), &info) == JXL_DEC_SUCCESS && info.xsize == size.width && info.ysize == size.height,
               "give the size back");
        break;
      }
      case JXL_DEC_NEED_IMAGE_OUT_BUFFER:
        demand(JxlDecoderSetImageOutBuffer(decoder.get(), &grey16, samples.data(), samples.size() * sizeof samples[0]) == JXL_DEC_SUCCESS,
               "decode to 16 bits");
        break;
      case JXL_DEC_FULL_IMAGE: return samples;
      default: demand(false, "decode");
    }
}

class JpegXlCodec final : public CodecUnderTest {
 public:
  std::string name() const override { return "jpegxl"; }
  std::string title() const override { return "JPEG XL"; }
  std::string description() const override {
    return "libjxl, effort 7, a bare codestream. At a rate: elevations scaled to the full 16 bits, lossy by distance. At a strict error and "
           "lossless: uniform steps (whole quanta where the data have them), lossless modular mode.";
  }
  bool keeps_voids() const override { return false; }
  std::int64_t bytes_per_cell() const override { return 176; }
  bool can(const TestedTerrain& terrain, CodingTarget target) const override {
    if (target.kind == CodingTarget::Kind::setting) return true;
    if (target.kind == CodingTarget::Kind::bytes) return false;
    const std::optional<UniformSteps> steps = steps_for(terrain, target);
    return steps && steps->highest <= highest_code;
  }
  // libjxl 0.7 takes distances up to 25; below 0.01 it changes no more.
  std::optional<SettingsRange> settings_range(const TestedTerrain&) const override { return SettingsRange{25, 0.01}; }

  std::vector<std::byte> encode(const TestedTerrain& terrain, CodingTarget target, int threads) const override {
    const bool lossy = target.kind == CodingTarget::Kind::setting;
    const CodedTerrain coded = lossy ? scale_to_16_bits(terrain) : quantise(terrain, steps_for(terrain, target).value());
    return with_map(coded.map, encode_samples(narrow(coded), coded.codes.size(), lossy ? target.value : 0, threads));
  }

  void decode(std::span<const std::byte> bytes, RasterView<float> out, int threads) const override {
    const MappedFile file = read_map(bytes);
    const std::vector<std::uint16_t> samples = decode_samples(file.file, out.size(), threads);
    const LinearMap map = file.map.value_or(LinearMap{});
    for (std::int64_t y = 0; y < out.height; ++y)
      for (std::int64_t x = 0; x < out.width; ++x) out(x, y) = map.elevation(samples[static_cast<std::size_t>(y * out.width + x)]);
  }
};

}  // namespace

std::unique_ptr<CodecUnderTest> make_jpegxl_codec() { return std::make_unique<JpegXlCodec>(); }

}  // namespace arete
