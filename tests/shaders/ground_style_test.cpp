#include "core/terrain/ground_style.h"

#include <cmath>

#include "tests/shaders/gl_fixture.h"

namespace arete {
namespace {

/// What colours and lines of the ground tell, in pictures from straight above.
class GroundStyleOnTheGround : public GlFixture {
 protected:
  static constexpr std::int64_t side = 201;
  static constexpr double cell_m = 30;

  /// Red of both ramps grows from end to end, green is the rest.
  static SceneOptions options() {
    SceneOptions options;
    options.exaggeration = 2;  // must not matter
    options.walls = false;
    options.haze = 0;
    for (int i = 0; i < 256; ++i) {
      const auto value = static_cast<std::uint8_t>(i), rest = static_cast<std::uint8_t>(255 - i);
      options.slope_ramp.push_back({value, rest, 128});
      options.aspect_ramp.push_back({value, rest, 128});
    }
    options.ramp = {{200, 200, 200}};
    return options;
  }
  /// A cone whose sides rise by `rise` metres per metre to the middle.
  static Raster<float> cone(double rise) {
    Raster<float> cells(side, side);
    for (std::int64_t y = 0; y < side; ++y)
      for (std::int64_t x = 0; x < side; ++x)
        cells(x, y) = static_cast<float>(
            5000 - rise * cell_m * std::hypot(static_cast<double>(x - side / 2), static_cast<double>(y - side / 2)));
    return cells;
  }
  static Camera above(const TerrainRenderer& renderer) { return frame_box(renderer.box(), 180, 90, 4, 1); }
  static const std::uint8_t* pixel(const Frame& frame, std::int64_t x, std::int64_t y) {
    return &frame.rgba[static_cast<std::size_t>(4 * (y * frame.size.width + x))];
  }
  /// Where the ramp is at that pixel: light scales red and green alike (in linear light).
  static double position(const Frame& frame, std::int64_t x, std::int64_t y) {
    const auto linear = [](std::uint8_t v) { return std::pow(v / 255.0, 2.2); };
    const double ratio = linear(pixel(frame, x, y)[0]) / std::max(1e-6, linear(pixel(frame, x, y)[1]));
    const double root = std::pow(ratio / warmth, 1 / 2.2);  // value / (1 - value)
    return root / (1 + root);
  }
  static constexpr double warmth = 1.1;  // of the light: red over green
};

TEST_F(GroundStyleOnTheGround, SlopesOfAConeHaveOneColour) {
  const Raster<float> cells = cone(std::tan(30 * M_PI / 180));
  const ViewSource source(cells.view());
  const auto renderer = render(source, options(), {cell_m, cell_m});
  ASSERT_EQ(renderer->facts().steepest_deg, 45);  // of 30 degrees, and a little
  renderer->restyle({.colour = GroundColour::slope});
  const Frame frame = renderer->draw(above(*renderer), {200, 200});
  for (int degrees = 0; degrees < 360; degrees += 15)
    for (const double radius : {30.0, 60.0, 85.0}) {
      const auto x = std::llround(100 + radius * std::sin(degrees * M_PI / 180)),
                 y = std::llround(100 - radius * std::cos(degrees * M_PI / 180));
      EXPECT_NEAR(position(frame, x, y), 30.0 / 45, 0.03) << degrees << ", " << radius;
    }
}

TEST_F(GroundStyleOnTheGround, TheScaleOfSlopesMayBeGiven) {
  const Raster<float> cells = cone(std::tan(30 * M_PI / 180));
  const ViewSource source(cells.view());
  SceneOptions given = options();
  given.steepest_deg = 90;
  const auto renderer = render(source, given, {cell_m, cell_m});
  renderer->restyle({.colour = GroundColour::slope});
  EXPECT_NEAR(position(renderer->draw(above(*renderer), {200, 200}), 140, 100), 30.0 / 90, 0.03);
}

TEST_F(GroundStyleOnTheGround, AspectsOfAConeGoRoundWithTheCompass) {
  const Raster<float> cells = cone(0.4);
  const ViewSource source(cells.view());
  const auto renderer = render(source, options(), {cell_m, cell_m});
  renderer->restyle({.colour = GroundColour::aspect});
  const Frame frame = renderer->draw(above(*renderer), {200, 200});
  for (int degrees = 30; degrees <= 330; degrees += 15) {
    const auto x = std::llround(100 + 60 * std::sin(degrees * M_PI / 180)),
               y = std::llround(100 - 60 * std::cos(degrees * M_PI / 180));
    EXPECT_NEAR(position(frame, x, y), degrees / 360.0, 0.03) << degrees;
  }
}

TEST_F(GroundStyleOnTheGround, FlatGroundFacesNowhere) {
  Raster<float> cells(side, side, 700.0f);
  cells(0, 0) = 900;  // a relief
  const ViewSource source(cells.view());
  const auto renderer = render(source, options(), {cell_m, cell_m});
  renderer->restyle({.colour = GroundColour::aspect, .contour_interval_m = 100});
  const Frame frame = renderer->draw(above(*renderer), {100, 100});
  const std::uint8_t* grey = pixel(frame, 60, 60);
  EXPECT_NEAR(grey[0], grey[1], 8);
  EXPECT_NEAR(grey[1], grey[2], 14);
  // Just at the height of a contour, and no line is drawn all over it.
  EXPECT_GT(grey[1], 120);
}

TEST_F(GroundStyleOnTheGround, ContoursLieAtTheMultiplesOfTheIntervalAndAreAPixelWide) {
  // 4 m down per cell to the east: a contour every 25 cells.
  Raster<float> cells(side, side);
  for (std::int64_t y = 0; y < side; ++y)
    for (std::int64_t x = 0; x < side; ++x) cells(x, y) = static_cast<float>(1010 - 4 * x);
  const ViewSource source(cells.view());
  for (const int supersampling : {1, 2}) {
    SceneOptions at = options();
    at.supersampling = supersampling;
    at.exaggeration = 1;
    const auto renderer = render(source, at, {cell_m, cell_m});
    const Camera camera = above(*renderer);
    const Frame plain = renderer->draw(camera, {400, 400});
    renderer->restyle({.contour_interval_m = 100});
    const Frame lines = renderer->draw(camera, {400, 400});
    // Metres of a pixel of the picture on the ground at that height, about.
    const double far = camera.eye[2] - 600, metres = 2 * far * std::tan(camera.field_of_view_deg / 2 * M_PI / 180) / 400;
    double covered = 0;
    int lines_seen = 0;
    for (std::int64_t x = 15; x < 385; ++x) {
      const double dark = 1 - std::pow(static_cast<double>(pixel(lines, x, 200)[1]) / pixel(plain, x, 200)[1], 2.2);
      covered += dark / 0.74;  // of an opacity of 0.75 and an ink that is not black
      if (dark < 0.2) continue;
      ++lines_seen;
      const double east = (static_cast<double>(x) + 0.5 - 200) * metres + camera.target[0], height = 1010 - 4 * east / cell_m;
      // Within 1.5 pixels, and what perspective shifts.
      EXPECT_NEAR(height, 100 * std::round(height / 100), 4 * 2.0 * metres / cell_m) << x;
    }
    EXPECT_GE(lines_seen, 7) << supersampling;
    EXPECT_LE(lines_seen, 24) << supersampling;
    // 900 to 300 m, of which one is the fifth.
    EXPECT_NEAR(covered, 6 * 1.0 + 1.9, 1) << supersampling;
    // Where they would be denser than pixels they are gone.
    renderer->restyle({.contour_interval_m = 1});
    EXPECT_EQ(renderer->draw(camera, {400, 400}).rgba, plain.rgba);
  }
}

TEST_F(GroundStyleOnTheGround, TheSuitableIntervalBecomesANumber) {
  const Raster<float> cells = cone(0.4);
  const ViewSource source(cells.view());
  const auto renderer = render(source, options(), {cell_m, cell_m});
  EXPECT_EQ(renderer->style().contour_interval_m, 0);
  renderer->restyle({.contour_interval_m = suitable_interval});
  EXPECT_EQ(renderer->style().contour_interval_m, contour_interval(renderer->facts().high_m - renderer->facts().low_m));
}

}  // namespace
}  // namespace arete
