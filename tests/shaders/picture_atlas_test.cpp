#include "shaders/picture_atlas.h"

#include "tests/shaders/gl_fixture.h"

namespace arete {
namespace {

using Pixel = std::array<std::uint8_t, 4>;

Pixel at(const PictureAtlas& atlas, const GroundPicture& picture, std::size_t level, std::int64_t x, std::int64_t y) {
  return atlas
      .rgba[static_cast<std::size_t>((atlas.rows[level] + y) * atlas.size.width + (level > 0 ? picture.size.width : 0) + x)];
}

TEST(PictureAtlas, HoldsMeansInLinearLightDownToOnePixel) {
  GroundPicture picture{{6, 5}, {}, 0, 0, 6, 5};
  for (std::int64_t i = 0; i < 30; ++i) picture.rgba.push_back(i % 2 == 0 ? Pixel{255, 255, 255, 255} : Pixel{0, 0, 0, 255});
  const PictureAtlas atlas = make_atlas(picture, 1);
  ASSERT_EQ(atlas.rows.size(), 4u);  // 6 x 5, 3 x 3, 2 x 2, 1 x 1
  EXPECT_EQ(atlas.size, (Size{9, 6}));
  EXPECT_EQ(at(atlas, picture, 0, 4, 2), (Pixel{255, 255, 255, 255}));
  // Half of the light is 188 in sRGB.
  for (std::size_t level = 1; level < 4; ++level)
    EXPECT_EQ(at(atlas, picture, level, 0, 0), (Pixel{188, 188, 188, 255})) << level;
  EXPECT_EQ(make_atlas(picture, 3).rgba, atlas.rgba);
}

TEST(PictureAtlas, WhatIsTransparentHasNoColour) {
  GroundPicture picture{{2, 1}, {{200, 100, 50, 255}, {255, 0, 255, 0}}, 0, 0, 2, 1};
  const PictureAtlas atlas = make_atlas(picture, 1);
  EXPECT_EQ(at(atlas, picture, 0, 0, 0), (Pixel{200, 100, 50, 255}));
  EXPECT_EQ(at(atlas, picture, 0, 1, 0), (Pixel{0, 0, 0, 0}));
  EXPECT_EQ(at(atlas, picture, 1, 0, 0)[3], 128);
}

using DrapedTerrain = GlFixture;

TEST_F(DrapedTerrain, EdgesLieWhereThePictureSaysAndTransparentPixelsShowTheGround) {
  constexpr std::int64_t side = 101;
  const Raster<float> cells(side, side, 100.0f);
  const ViewSource source(cells.view());
  // Columns 20 to 60 of the DEM, rows 10 to 90: red, from column 50 on blue, below row 70 nothing.
  auto picture = std::make_shared<GroundPicture>(GroundPicture{{80, 160}, {}, 20, 10, 40, 80, {30, 30}});
  for (std::int64_t y = 0; y < 160; ++y)
    for (std::int64_t x = 0; x < 80; ++x)
      picture->rgba.push_back(y >= 120 ? Pixel{255, 255, 255, 0} : x < 60 ? Pixel{230, 20, 20, 255} : Pixel{20, 20, 230, 255});
  SceneOptions options;
  options.walls = false;
  options.haze = 0;
  options.exaggeration = 1;
  const auto plain = render(source, options);
  options.drape = picture;
  const auto draped = render(source, options);
  const Camera above = frame_box(plain->box(), 180, 90, 10, 1);
  const Frame without = plain->draw(above, {300, 300}), with = draped->draw(above, {300, 300});
  // Column of the DEM (0 the outer corner of the first cell) under a pixel.
  const double metres = 2 * (above.eye[2] - 100) * std::tan(5 * M_PI / 180) / 300;
  int red = 0, blue = 0, ground = 0;
  for (std::int64_t y = 0; y < 300; ++y)
    for (std::int64_t x = 0; x < 300; ++x) {
      const double column = (above.target[0] + (static_cast<double>(x) + 0.5 - 150) * metres) / 30 + 0.5;
      const double row = -(above.target[1] - (static_cast<double>(y) + 0.5 - 150) * metres) / 30 + 0.5;
      const double near = metres / 30 + 0.25;  // a pixel, and half a pixel of the drape
      const auto i = static_cast<std::size_t>(4 * (y * 300 + x));
      if (column < 20 - near || column > 60 + near || row < 10 - near || row > 70 + near) {
        for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(with.rgba[i + c], without.rgba[i + c]) << x << ", " << y;
        ++ground;
      } else if (column > 20 + near && column < 60 - near && row > 10 + near && row < 70 - near) {
        if (column < 50 - near) {
          ASSERT_GT(with.rgba[i], with.rgba[i + 2] + 120) << x << ", " << y;
          ++red;
        }
        if (column > 50 + near) {
          ASSERT_GT(with.rgba[i + 2], with.rgba[i] + 120) << x << ", " << y;
          ++blue;
        }
      }
    }
  EXPECT_GT(red, 10000);
  EXPECT_GT(blue, 3000);
  EXPECT_GT(ground, 30000);
  draped->restyle({.drape = false});
  EXPECT_EQ(draped->draw(above, {300, 300}).rgba, without.rgba);
}

TEST_F(DrapedTerrain, AFinePatternFarAwayIsItsMeanWithoutSeams) {
  Raster<float> hills(400, 400);
  for (std::int64_t y = 0; y < 400; ++y)
    for (std::int64_t x = 0; x < 400; ++x) hills(x, y) = static_cast<float>(40 * std::sin(static_cast<double>(x) / 15) + 1000);
  const ViewSource source(hills.view());
  auto picture = std::make_shared<GroundPicture>(GroundPicture{{800, 800}, {}, 0, 0, 400, 400, {30, 30}});
  for (std::int64_t i = 0; i < 800 * 800; ++i)
    picture->rgba.push_back((i + i / 800) % 2 == 0 ? Pixel{255, 40, 40, 255} : Pixel{40, 255, 40, 255});
  SceneOptions options;
  options.walls = false;
  options.haze = 0;
  options.exaggeration = 1;
  options.drape = picture;
  const auto renderer = render(source, options);
  const Frame frame = renderer->draw(frame_box(renderer->box(), 200, 20, 30, 1.5), {240, 160});
  const Frame covered = renderer->draw(frame_box(renderer->box(), 200, 20, 30, 1.5), {240, 160}, DrawMode::coverage);
  int seen = 0;
  for (std::size_t i = 0; i < frame.rgba.size(); i += 4) {
    const auto x = i / 4 % 240;
    if (x == 0 || x == 239 || covered.rgba[i] == 0 || covered.rgba[i - 4] == 0 || covered.rgba[i + 4] == 0) continue;
    if (i < 4 * 240 || i + 4 * 240 >= frame.rgba.size() || covered.rgba[i - 4 * 240] == 0 || covered.rgba[i + 4 * 240] == 0)
      continue;
    ++seen;
    ASSERT_NEAR(frame.rgba[i], frame.rgba[i + 1], 16) << i / 4 % 240 << ", " << i / 960;
  }
  EXPECT_GT(seen, 3000);
}

}  // namespace
}  // namespace arete
