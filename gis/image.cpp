#include "gis/image.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include "core/support/error.h"
#include "gis/staged_files.h"

namespace arete {
namespace {

namespace fs = std::filesystem;

std::string extension_of(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) { return static_cast<char>(std::tolower(c)); });
  return extension.empty() ? extension : extension.substr(1);
}

std::unique_ptr<OIIO::ImageOutput> writer_for(const std::string& path) {
  const std::string extension = extension_of(path);
  auto writer = extension.empty() ? nullptr : OIIO::ImageOutput::create(extension);
  if (!writer) {
    (void)OIIO::geterror();  // also clears it
    throw Error(ErrorKind::format, "cannot write the picture " + path + ": no writer for the extension '" + extension +
                                       "'; use .png, .tif or .exr");
  }
  return writer;
}

/// OpenImageIO would store the time of writing otherwise; and in TIFF take an empty one for a reason to write an EXIF directory, of which libtiff, once GDAL is
/// in use, says on stderr that it cannot.
void leave_out_time(OIIO::ImageSpec& spec) {
  spec.attribute("DateTime", "");
  spec.attribute("tiff:write_exif", 0);
}

void write_pixels(const std::string& path, OIIO::ImageSpec spec, OIIO::TypeDesc type, const void* pixels, OIIO::stride_t row_stride,
                  bool overwrite) {
  check_picture_path(path, overwrite);
  auto writer = writer_for(path);
  leave_out_time(spec);
  StagedFiles files(path, overwrite);
  const bool written = writer->open(files.staged(), spec) &&
                       writer->write_image(type, pixels, OIIO::AutoStride, row_stride) && writer->close();
  if (!written) {
    const std::string reason = writer->geterror();
    throw Error(ErrorKind::disk, "cannot write the picture " + path + (reason.empty() ? "" : ": " + reason));
  }
  files.publish();
}

OIIO::TypeDesc type_of(PictureDepth depth) {
  return depth == PictureDepth::bits8 ? OIIO::TypeDesc::UINT8 : depth == PictureDepth::bits16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::HALF;
}

float linear_light(std::uint8_t value) {
  const float v = static_cast<float>(value) / 255.0f;  // IEC 61966-2-1
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

OIIO::ImageBuf wrap(Picture& picture) {
  const OIIO::ImageSpec spec(static_cast<int>(picture.width()), static_cast<int>(picture.height()), 4, OIIO::TypeDesc::UINT8);
  return OIIO::ImageBuf(spec, picture.data());
}

std::string ascii(const std::string& text) {
  std::string plain;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80 && byte < 0xc0) continue;  // the rest of a character of UTF-8
    plain += byte >= 0x20 && byte < 0x7f ? c : '?';
  }
  return plain;
}

void render_text(Picture& picture, std::int64_t x, std::int64_t y, const std::string& text, int size, Colour colour, Align align, const std::string& font) {
  OIIO::ImageBuf canvas = wrap(picture);
  float ink[4];
  for (std::size_t c = 0; c < 4; ++c) ink[c] = static_cast<float>(colour[c]) / 255.0f;
  using OIIO::ImageBufAlgo::TextAlignX;
  const TextAlignX side = align == Align::left ? TextAlignX::Left : align == Align::right ? TextAlignX::Right : TextAlignX::Center;
  OIIO::ImageBufAlgo::render_text(canvas, static_cast<int>(x), static_cast<int>(y), ascii(text), size, font, ink, side);
}

/// Calls body(x, y, i, j) for each pixel (x, y) of a picture that is pixel (i, j) of a window, which may reach beyond it.
template <typename Body>
void for_shared(const Picture& picture, const Window& window, const Body& body) {
  for (std::int64_t y = std::max<std::int64_t>(0, window.y); y < std::min(picture.height(), window.y + window.height); ++y)
    for (std::int64_t x = std::max<std::int64_t>(0, window.x); x < std::min(picture.width(), window.x + window.width); ++x) body(x, y, x - window.x, y - window.y);
}

Picture repeat_pixels(const Picture& picture, std::int64_t width, std::int64_t height) {
  Picture larger(width, height);
  // The source pixel that the centre of the new one lies in, in whole numbers.
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      larger(x, y) = picture((2 * x + 1) * picture.width() / (2 * width), (2 * y + 1) * picture.height() / (2 * height));
  return larger;
}

}  // namespace

void check_picture_path(const std::string& path, bool overwrite) {
  writer_for(path);
  StagedFiles(path, overwrite);  // makes its folder and removes it again
}

void write_picture(const std::string& path, const Picture& picture, bool overwrite, int jpeg_quality) {
  const auto pixels = static_cast<std::size_t>(picture.width() * picture.height());
  const bool opaque = std::all_of(picture.data(), picture.data() + pixels, [](const Colour& c) { return c[3] == 255; });
  const std::size_t channels = opaque ? 3 : 4;
  const int width = static_cast<int>(picture.width()), height = static_cast<int>(picture.height());
  if (extension_of(path) == "exr") {
    std::vector<float> light(pixels * channels);
    for (std::size_t i = 0; i < pixels; ++i) {
      const float opacity = static_cast<float>(picture.data()[i][3]) / 255.0f;  // EXR is multiplied by it
      for (std::size_t c = 0; c < 3; ++c) light[i * channels + c] = linear_light(picture.data()[i][c]) * opacity;
      if (!opaque) light[i * channels + 3] = opacity;
    }
    write_pixels(path, OIIO::ImageSpec(width, height, static_cast<int>(channels), OIIO::TypeDesc::HALF), OIIO::TypeDesc::FLOAT,
                 light.data(), OIIO::AutoStride, overwrite);
    return;
  }
  std::vector<std::uint8_t> bytes(pixels * channels);
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t c = 0; c < channels; ++c) bytes[i * channels + c] = picture.data()[i][c];
  OIIO::ImageSpec spec(width, height, static_cast<int>(channels), OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  if (const std::string extension = extension_of(path); extension == "jpg" || extension == "jpeg") spec.attribute("CompressionQuality", jpeg_quality);
  write_pixels(path, spec, OIIO::TypeDesc::UINT8, bytes.data(), OIIO::AutoStride, overwrite);
}

PictureDepth depth_of(const std::string& path) {
  const std::string extension = extension_of(path);
  if (extension == "png") return PictureDepth::bits8;
  if (extension == "tif" || extension == "tiff") return PictureDepth::bits16;
  if (extension == "exr") return PictureDepth::half;
  throw Error(ErrorKind::format, "cannot write the picture " + path + ": this picture is written as .png (8 bits), .tif (16 bits) or .exr (linear half floats)" +
                                     (extension.empty() ? "" : ", not as ." + extension));
}

struct PictureFile::Impl {
  std::string path;
  Size size;
  PictureDepth depth;
  std::unique_ptr<OIIO::ImageOutput> writer;
  StagedFiles files;
  int next_row = 0;

  [[noreturn]] void fail() const {
    const std::string reason = writer->geterror();
    throw Error(ErrorKind::disk, "cannot write the picture " + path + (reason.empty() ? "" : ": " + reason));
  }
  template <typename Sample>
  void write(std::span<const Sample> rgba) {
    const auto rows = static_cast<int>(static_cast<std::int64_t>(rgba.size()) / (4 * size.width));
    if (!writer->write_scanlines(next_row, next_row + rows, 0, OIIO::BaseTypeFromC<Sample>::value, rgba.data(), 4 * sizeof(Sample),
                                 static_cast<OIIO::stride_t>(4 * sizeof(Sample)) * size.width))
      fail();
    next_row += rows;
  }
};

PictureFile::PictureFile(const std::string& path, Size size, PictureDepth depth, bool overwrite)
    : impl_(new Impl{path, size, depth, writer_for(path), StagedFiles(path, overwrite)}) {
  OIIO::ImageSpec spec(static_cast<int>(size.width), static_cast<int>(size.height), 3, type_of(depth));
  leave_out_time(spec);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  if (!impl_->writer->open(impl_->files.staged(), spec)) impl_->fail();
}
PictureFile::~PictureFile() {
  if (!impl_->writer) return;
  // libpng complains on stderr of files without data, which is written once its compressed form fills 8 kB: blank rows to the end do, or 16 MB of them.
  const std::int64_t row_bytes = 4 * impl_->size.width, left = impl_->size.height - impl_->next_row;
  const std::vector<std::uint8_t> blank(static_cast<std::size_t>(row_bytes * std::min(left, (std::int64_t{16} << 20) / row_bytes + 1)));
  try {
    if (left > 0) impl_->write(std::span<const std::uint8_t>(blank));
  } catch (const Error&) {
    // The file is removed anyway.
  }
}

void PictureFile::write(std::span<const std::uint8_t> rgba) { impl_->write(rgba); }
void PictureFile::write(std::span<const std::uint16_t> rgba) { impl_->write(rgba); }
void PictureFile::write(std::span<const float> rgba) { impl_->write(rgba); }
void PictureFile::publish() {
  if (!impl_->writer->close()) impl_->fail();
  impl_->writer.reset();
  impl_->files.publish();
}

void write_grey16(const std::string& path, RasterView<const std::uint16_t> cells, bool overwrite) {
  const OIIO::ImageSpec spec(static_cast<int>(cells.width), static_cast<int>(cells.height), 1, OIIO::TypeDesc::UINT16);
  write_pixels(path, spec, OIIO::TypeDesc::UINT16, cells.data, cells.stride * static_cast<OIIO::stride_t>(sizeof(std::uint16_t)),
               overwrite);
}

Picture read_picture(const std::string& path) {
  OIIO::ImageSpec as_stored;
  as_stored.attribute("oiio:UnassociatedAlpha", 1);
  auto reader = OIIO::ImageInput::open(path, &as_stored);
  if (!reader) throw Error(ErrorKind::input, "cannot read the picture " + path + ": " + OIIO::geterror());
  const OIIO::ImageSpec spec = reader->spec();
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) * channels);
  if (!reader->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, bytes.data()))
    throw Error(ErrorKind::input, "cannot read the picture " + path + ": " + reader->geterror());
  Picture picture(spec.width, spec.height);
  for (std::size_t i = 0; i < bytes.size() / channels; ++i)
    for (std::size_t c = 0; c < 4; ++c) {
      if (c == 3)
        picture.data()[i][c] = channels == 4 ? bytes[i * channels + 3] : 255;
      else
        picture.data()[i][c] = bytes[i * channels + (channels >= 3 ? c : 0)];
    }
  return picture;
}

Picture resize_picture(const Picture& picture, std::int64_t width, std::int64_t height) {
  const bool whole = width % picture.width() == 0 && height % picture.height() == 0;
  if (whole || (width >= 2 * picture.width() && height >= 2 * picture.height())) return repeat_pixels(picture, width, height);
  Picture source = picture, resized(width, height);
  // The filter must not mix the hidden colour of a transparent pixel into its neighbours.
  OIIO::ImageBuf from = wrap(source), to = wrap(resized), light;
  from.specmod().alpha_channel = 3;
  OIIO::ImageBufAlgo::premult(light, from);
  OIIO::ImageBuf scaled = OIIO::ImageBufAlgo::resize(light, "triangle", 0.0f, to.roi());
  scaled.specmod().alpha_channel = 3;
  OIIO::ImageBufAlgo::unpremult(to, scaled);
  return resized;
}

void paste(Picture& to, const Picture& from, std::int64_t x, std::int64_t y) {
  for (std::int64_t j = std::max<std::int64_t>(0, -y); j < std::min(from.height(), to.height() - y); ++j)
    for (std::int64_t i = std::max<std::int64_t>(0, -x); i < std::min(from.width(), to.width() - x); ++i) {
      const Colour& above = from(i, j);
      Colour& below = to(x + i, y + j);
      const int opacity = above[3];
      for (std::size_t c = 0; c < 3; ++c)
        below[c] = static_cast<std::uint8_t>((above[c] * opacity + below[c] * (255 - opacity) + 127) / 255);
      below[3] = static_cast<std::uint8_t>(std::max<int>(below[3], opacity));
    }
}

Picture stack(const Picture& above, const Picture& below) {
  Picture sheet(std::max(above.width(), below.width()), above.height() + below.height());
  paste(sheet, above, (sheet.width() - above.width()) / 2, 0);
  paste(sheet, below, 0, above.height());
  return sheet;
}

void fill(Picture& picture, const Window& area, Colour colour) {
  for (std::int64_t y = std::max<std::int64_t>(0, area.y); y < std::min(picture.height(), area.y + area.height); ++y)
    for (std::int64_t x = std::max<std::int64_t>(0, area.x); x < std::min(picture.width(), area.x + area.width); ++x)
      picture(x, y) = colour;
}

std::string find_font() {
  if (const char* chosen = std::getenv("ARETE_FONT")) return fs::exists(chosen) ? chosen : "";
  for (const char* path : {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                           "/usr/share/fonts/TTF/DejaVuSans.ttf", "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
                           "/usr/share/fonts/liberation-sans/LiberationSans-Regular.ttf"})
    if (fs::exists(path)) return path;
  return "";
}

void draw_text(Picture& picture, std::int64_t x, std::int64_t y, const std::string& text, int size, Colour colour, Align align) {
  const std::string font = find_font();
  if (font.empty() || text.empty()) return;
  // OpenImageIO cannot draw over the border: there, on a copy of what lies under the text.
  const std::int64_t reach = text_width(text, size) + size;
  const Window box{x - reach, y - 2 * size, 2 * reach, 3 * size};
  if (box.x < 0 || box.y < 0 || box.x + box.width > picture.width() || box.y + box.height > picture.height()) {
    Picture under(box.width, box.height);
    for_shared(picture, box, [&](std::int64_t i, std::int64_t j, std::int64_t u, std::int64_t v) { under(u, v) = picture(i, j); });
    render_text(under, x - box.x, y - box.y, text, size, colour, align, font);
    for_shared(picture, box, [&](std::int64_t i, std::int64_t j, std::int64_t u, std::int64_t v) { picture(i, j) = under(u, v); });
    return;
  }
  render_text(picture, x, y, text, size, colour, align, font);
}

std::int64_t text_width(const std::string& text, int size) {
  const std::string font = find_font();
  if (font.empty() || text.empty()) return 0;
  const OIIO::ROI extent = OIIO::ImageBufAlgo::text_size(ascii(text), size, font);
  return extent.defined() ? extent.width() : 0;
}

}  // namespace arete
