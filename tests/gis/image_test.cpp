#include "gis/image.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/support/error.h"

namespace arete {
namespace {

namespace fs = std::filesystem;

class Image : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("arete_image_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  static std::string bytes(const std::string& name) {
    std::ifstream file(name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static Picture gradient() {
    Picture picture(17, 9);
    for (std::int64_t y = 0; y < 9; ++y)
      for (std::int64_t x = 0; x < 17; ++x)
        picture(x, y) = {static_cast<std::uint8_t>(15 * x), static_cast<std::uint8_t>(28 * y), 77, 255};
    return picture;
  }
  template <typename Body>
  static ErrorKind kind_of(const Body& body) {
    try {
      body();
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.kind();
    }
    return ErrorKind{0};
  }
  fs::path folder_;
};

TEST_F(Image, ComesBackAsItWasWritten) {
  Picture picture = gradient();
  for (const bool opaque : {true, false}) {
    if (!opaque) picture(3, 3) = {10, 200, 30, 100};
    for (const char* name : {"a.png", "a.tif"}) {
      write_picture(path(name), picture, true);
      const Picture back = read_picture(path(name));
      ASSERT_EQ(back.width(), 17);
      for (std::int64_t i = 0; i < 17 * 9; ++i) EXPECT_EQ(back.data()[i], picture.data()[i]) << name;
    }
  }
  EXPECT_EQ(files(), 2u);  // no temporary file stays
}

TEST_F(Image, HasTheSameBytesEveryTime) {
  write_picture(path("a.png"), gradient());
  write_picture(path("b.png"), gradient());
  EXPECT_EQ(bytes(path("a.png")), bytes(path("b.png")));
}

TEST_F(Image, NeverReplacesAFileUnlessTold) {
  std::ofstream(path("a.png")) << "mine";
  EXPECT_EQ(kind_of([&] { write_picture(path("a.png"), gradient()); }), ErrorKind::disk);
  EXPECT_EQ(bytes(path("a.png")), "mine");
  EXPECT_EQ(files(), 1u);
  write_picture(path("a.png"), gradient(), true);
  EXPECT_EQ(read_picture(path("a.png")).width(), 17);
  EXPECT_EQ(files(), 1u);
}

TEST_F(Image, SaysWhatIsWrongAndWritesNothing) {
  EXPECT_EQ(kind_of([&] { write_picture(path("a.xyz"), gradient()); }), ErrorKind::format);
  EXPECT_EQ(kind_of([&] { write_picture(path("a"), gradient()); }), ErrorKind::format);
  EXPECT_EQ(kind_of([&] { write_picture(path("none/a.png"), gradient()); }), ErrorKind::disk);
  EXPECT_EQ(kind_of([&] { read_picture(path("none.png")); }), ErrorKind::input);
  EXPECT_EQ(files(), 0u);
}

TEST_F(Image, SixteenBitsKeepTheirValues) {
  Raster<std::uint16_t> cells(300, 2);
  for (std::int64_t x = 0; x < 300; ++x) cells(x, 0) = cells(x, 1) = static_cast<std::uint16_t>(x * 218);
  write_grey16(path("a.png"), cells.view());
  const Picture back = read_picture(path("a.png"));  // 8 bits of them
  for (std::int64_t x = 0; x < 300; ++x) EXPECT_NEAR(back(x, 1)[0], static_cast<double>(x) * 218 / 257, 1);
}

/// The same picture by rows, four and the rest.
template <typename Sample>
void write_by_rows(const std::string& path, const std::vector<Sample>& rgba, Size size, PictureDepth depth) {
  PictureFile file(path, size, depth, true);
  const std::span<const Sample> all(rgba);
  file.write(all.first(static_cast<std::size_t>(4 * 4 * size.width)));
  file.write(all.subspan(static_cast<std::size_t>(4 * 4 * size.width)));
  EXPECT_FALSE(fs::exists(path));
  file.publish();
}

TEST_F(Image, WrittenByRowsHasTheSameBytes) {
  const Picture picture = gradient();
  const std::vector<std::uint8_t> rgba(picture.data()->data(), picture.data()->data() + 4 * 17 * 9);
  for (const char* name : {"a.png", "a.tif"}) {
    write_picture(path("whole-" + std::string(name)), picture);
    write_by_rows(path(name), rgba, {17, 9}, PictureDepth::bits8);
    EXPECT_EQ(bytes(path(name)), bytes(path("whole-" + std::string(name))));
  }
}

TEST_F(Image, SixteenBitsAndHalfFloatsKeepWhatEightCannot) {
  std::vector<std::uint16_t> fine;
  std::vector<float> light;
  for (int i = 0; i < 17 * 9; ++i)
    for (int c = 0; c < 4; ++c) fine.push_back(static_cast<std::uint16_t>(c == 3 ? 65535 : 30000 + 3 * i + c)), light.push_back(c == 3 ? 1.0f : 0.25f * static_cast<float>(i + c));
  write_by_rows(path("a.tif"), fine, {17, 9}, PictureDepth::bits16);
  write_by_rows(path("a.exr"), light, {17, 9}, PictureDepth::half);
  const auto a = OIIO::ImageInput::open(path("a.tif")), b = OIIO::ImageInput::open(path("a.exr"));
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->spec().format, OIIO::TypeDesc::UINT16);
  EXPECT_EQ(b->spec().format, OIIO::TypeDesc::HALF);
  ASSERT_EQ(a->spec().nchannels, 3);
  std::vector<std::uint16_t> fine_back(3 * 17 * 9);
  std::vector<float> light_back(3 * 17 * 9);
  ASSERT_TRUE(a->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT16, fine_back.data()));
  ASSERT_TRUE(b->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, light_back.data()));
  for (std::size_t i = 0; i < 17 * 9; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_EQ(fine_back[3 * i + c], fine[4 * i + c]);
      ASSERT_EQ(light_back[3 * i + c], light[4 * i + c]);  // quarters up to 38 are half floats
    }
  // Samples of 8 bits are white where they were.
  std::vector<std::uint8_t> coarse(4 * 17 * 9, 255);
  coarse[0] = 1;
  write_by_rows(path("b.tif"), coarse, {17, 9}, PictureDepth::bits16);
  const auto c = OIIO::ImageInput::open(path("b.tif"));
  ASSERT_TRUE(c && c->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT16, fine_back.data()));
  EXPECT_EQ(fine_back[0], 257);
  EXPECT_EQ(fine_back[1], 65535);
}

TEST_F(Image, APictureThatIsNotFinishedNeverAppears) {
  {
    PictureFile file(path("a.png"), {17, 9}, PictureDepth::bits8, false);
    file.write(std::vector<std::uint8_t>(4 * 17 * 4, 7));
  }
  EXPECT_EQ(files(), 0u);
  std::ofstream(path("a.png")) << "mine";
  EXPECT_EQ(kind_of([&] { PictureFile(path("a.png"), {17, 9}, PictureDepth::bits8, false); }), ErrorKind::disk);
  EXPECT_EQ(bytes(path("a.png")), "mine");
}

TEST_F(Image, TheExtensionSaysTheDepth) {
  EXPECT_EQ(depth_of("a.PNG"), PictureDepth::bits8);
  EXPECT_EQ(depth_of("a.tiff"), PictureDepth::bits16);
  EXPECT_EQ(depth_of("a.b.exr"), PictureDepth::half);
  for (const char* name : {"a.jpg", "a", "png", "a.html"}) EXPECT_EQ(kind_of([&] { depth_of(name); }), ErrorKind::format) << name;
}

TEST_F(Image, TextIsDrawnWhereItIsMeasured) {
  if (find_font().empty()) GTEST_SKIP() << "no font; install fonts-dejavu-core";
  Picture picture(200, 40);
  draw_text(picture, 100, 30, "1250 m", 16, {0, 0, 0, 255}, Align::right);
  std::int64_t left = 200, right = 0;
  for (std::int64_t y = 0; y < 40; ++y)
    for (std::int64_t x = 0; x < 200; ++x)
      if (picture(x, y)[0] < 128) left = std::min(left, x), right = std::max(right, x);
  EXPECT_LE(right, 100);
  EXPECT_GE(left, 100 - text_width("1250 m", 16) - 2);
  EXPECT_GT(right - left, 30);
}

TEST_F(Image, TextIsCutAtTheBorders) {
  if (find_font().empty()) GTEST_SKIP() << "no font; install fonts-dejavu-core";
  Picture whole(200, 100, {200, 210, 220, 255});
  draw_text(whole, 100, 50, "Nmgy 1250 m", 24, {40, 30, 20, 255}, Align::centre);
  // The same text over parts of the same ground is the same part of the text.
  for (const std::int64_t x : {-300, -100, -60, 0, 40, 90, 200})
    for (const std::int64_t y : {-60, -40, -10, 0, 20, 40, 45, 90}) {
      Picture part(60, 12, {200, 210, 220, 255});
      draw_text(part, 100 - x, 50 - y, "Nmgy 1250 m", 24, {40, 30, 20, 255}, Align::centre);
      for (std::int64_t j = 0; j < 12; ++j)
        for (std::int64_t i = 0; i < 60; ++i) {
          const bool inside = x + i >= 0 && y + j >= 0 && x + i < 200 && y + j < 100;
          ASSERT_EQ(part(i, j), inside ? whole(x + i, y + j) : (Colour{200, 210, 220, 255})) << x << ' ' << y;
        }
    }
}

TEST_F(Image, WithoutAFontTextIsSimplyAbsent) {
  const char* before = std::getenv("ARETE_FONT");
  const std::string kept = before ? before : "";
  setenv("ARETE_FONT", "/nonexistent.ttf", 1);
  Picture picture(50, 30);
  draw_text(picture, 5, 20, "abc", 12, {0, 0, 0, 255});
  EXPECT_EQ(find_font(), "");
  EXPECT_EQ(text_width("abc", 12), 0);
  EXPECT_EQ(picture(8, 16), (Colour{255, 255, 255, 255}));
  before ? setenv("ARETE_FONT", kept.c_str(), 1) : unsetenv("ARETE_FONT");
}

TEST_F(Image, AWholeFactorRepeatsPixels) {
  const Picture larger = resize_picture(gradient(), 17 * 3, 9 * 2);
  for (std::int64_t y = 0; y < 18; ++y)
    for (std::int64_t x = 0; x < 51; ++x) EXPECT_EQ(larger(x, y), gradient()(x / 3, y / 2));
}

TEST_F(Image, MuchLargerPixelsStaySharp) {
  const Picture picture = gradient(), larger = resize_picture(picture, 45, 31);
  for (std::int64_t y = 0; y < 31; ++y)
    for (std::int64_t x = 0; x < 45; ++x)
      EXPECT_EQ(larger(x, y), picture(static_cast<std::int64_t>((static_cast<double>(x) + 0.5) * 17 / 45),
                                      static_cast<std::int64_t>((static_cast<double>(y) + 0.5) * 9 / 31)));
}

TEST_F(Image, ShrinkingDoesNotMixInHiddenColours) {
  Picture picture(40, 40, {200, 100, 50, 255});
  for (std::int64_t y = 0; y < 40; ++y)
    for (std::int64_t x = 20; x < 40; ++x) picture(x, y) = {0, 0, 255, 0};
  const Picture smaller = resize_picture(picture, 13, 13);
  for (std::int64_t x = 0; x < 13; ++x)
    if (smaller(x, 6)[3] > 20) {
      EXPECT_NEAR(smaller(x, 6)[0], 200, 8) << x;
      EXPECT_NEAR(smaller(x, 6)[2], 50, 8) << x;
    }
  EXPECT_EQ(smaller(1, 6), (Colour{200, 100, 50, 255}));
  EXPECT_EQ(smaller(12, 6)[3], 0);
}

TEST_F(Image, PastingMixesByOpacityAndIsCutAtTheBorder) {
  Picture below(4, 4, {0, 0, 0, 255}), above(3, 3, {255, 255, 255, 128});
  paste(below, above, 2, -1);
  EXPECT_EQ(below(2, 0)[0], 128);
  EXPECT_EQ(below(2, 1)[0], 128);
  EXPECT_EQ(below(2, 2)[0], 0);
  EXPECT_EQ(below(1, 0)[0], 0);
}

}  // namespace
}  // namespace arete
