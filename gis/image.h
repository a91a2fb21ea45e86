#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/terrain/raster.h"

namespace arete {

/// Red, green, blue, opacity (255: opaque), sRGB, not multiplied by the opacity.
using Colour = std::array<std::uint8_t, 4>;

/// A picture in memory, row 0 at the top.
class Picture {
 public:
  Picture() = default;
  Picture(std::int64_t width, std::int64_t height, Colour fill = {255, 255, 255, 255})
      : size_{width, height}, pixels_(static_cast<std::size_t>(width * height), fill) {}
  std::int64_t width() const { return size_.width; }
  std::int64_t height() const { return size_.height; }
  Colour& operator()(std::int64_t x, std::int64_t y) { return pixels_[static_cast<std::size_t>(y * size_.width + x)]; }
  const Colour& operator()(std::int64_t x, std::int64_t y) const { return pixels_[static_cast<std::size_t>(y * size_.width + x)]; }
  Colour* data() { return pixels_.data(); }
  const Colour* data() const { return pixels_.data(); }

 private:
  Size size_;
  std::vector<Colour> pixels_;
};

/// Writes a picture: PNG, TIFF, EXR, JPEG... by the extension, whatever OpenImageIO writes. An opaque picture is written without
/// opacity; EXR takes half floats of linear light. The file appears under its name only when it is whole (a temporary name beside
/// it, flushed, renamed). Same picture, same bytes.
/// Throws Error{disk} where the file exists (unless `overwrite`), its folder is missing or cannot be written, or the disk fails;
/// Error{format} where no writer knows the extension. `jpeg_quality`: 1 to 100, of JPEG.
void write_picture(const std::string& path, const Picture& picture, bool overwrite = false, int jpeg_quality = 98);

/// What the samples of a file are: sRGB of 8 or 16 bits, or half floats of linear light.
enum class PictureDepth { bits8, bits16, half };

/// The depth at which a file keeps most of a picture that was computed as light: .png 8 bits, .tif and .tiff 16, .exr half floats. Throws Error{format} for
/// other extensions, with these in its one line.
PictureDepth depth_of(const std::string& path);

/// Writes an opaque picture from top to bottom by rows, so that it need not be in memory; under the rules of write_picture, with the same bytes.
class PictureFile {
 public:
  PictureFile(const std::string& path, Size size, PictureDepth depth, bool overwrite);
  ~PictureFile();

  /// The next whole rows, red, green, blue, opacity, which is left out: linear light for half floats, sRGB else. In files of 16 bits samples of 8 bits are
  /// 257 times as large; half floats take floats only. Throws Error{disk}.
  void write(std::span<const std::uint8_t> rgba);
  void write(std::span<const std::uint16_t> rgba);
  void write(std::span<const float> rgba);
  /// After the last row: the file appears. Throws Error{disk}.
  void publish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes one channel of 16 bits, under the same rules (PNG, TIFF).
void write_grey16(const std::string& path, RasterView<const std::uint16_t> cells, bool overwrite = false);

/// The same rules as write_picture would apply, without writing: call it before long work.
void check_picture_path(const std::string& path, bool overwrite);

/// Reads a picture of 8 or 16 bits back as 8 bits. Throws Error{input}.
Picture read_picture(const std::string& path);

/// Resized to width x height. Where both sides grow by a whole factor, or to twice their length or more, pixels are repeated and
/// stay sharp; otherwise a triangle filter.
Picture resize_picture(const Picture& picture, std::int64_t width, std::int64_t height);

/// Copies `from` onto `to` with its upper left corner at (x, y), mixed by its opacity; what lies outside is left out.
void paste(Picture& to, const Picture& from, std::int64_t x, std::int64_t y);

/// One under the other, the upper in the middle where it is narrower.
Picture stack(const Picture& above, const Picture& below);

/// Fills a rectangle, cut at the borders.
void fill(Picture& picture, const Window& area, Colour colour);

/// The font that text is drawn with: the TrueType file that ARETE_FONT names, else DejaVu Sans or Liberation Sans where Linux
/// distributions put them (Debian: package fonts-dejavu-core). Empty when there is none: then draw_text draws nothing and
/// text_width is 0; who needs text asks first and tells the user.
std::string find_font();

enum class Align { left, centre, right };

/// Draws one line with its baseline at y, cut at the borders; `size` is the em height in pixels. Characters outside ASCII are drawn as '?'
/// (OpenImageIO 2.4 decodes them wrongly).
void draw_text(Picture& picture, std::int64_t x, std::int64_t y, const std::string& text, int size, Colour colour,
               Align align = Align::left);
std::int64_t text_width(const std::string& text, int size);

}  // namespace arete
