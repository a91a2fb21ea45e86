#include "gis/colour_ramp.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/error.h"

namespace arete {
namespace {

TEST(ColourRamp, BeginsAndEndsWithItsColours) {
  const ColourRamp ramp({"#102030", "#a0b0c0"});
  EXPECT_EQ(ramp.at(0), (Colour{0x10, 0x20, 0x30, 255}));
  EXPECT_EQ(ramp.at(1), (Colour{0xa0, 0xb0, 0xc0, 255}));
  EXPECT_EQ(ramp.at(-3), ramp.at(0));
  EXPECT_EQ(ramp.at(7), ramp.at(1));
}

// Ottosson's page gives Oklab's L = 1 for white, 0 for black; sRGB red has L = 0.628 (CSS Color 4, section 10.1: oklab(62.8% ...)).
TEST(ColourRamp, LightnessIsThatOfOklab) {
  EXPECT_NEAR(lightness({255, 255, 255, 255}), 1, 1e-6);
  EXPECT_NEAR(lightness({0, 0, 0, 255}), 0, 1e-9);
  EXPECT_NEAR(lightness({255, 0, 0, 255}), 0.628, 1e-3);
}

TEST(ColourRamp, TheGreyRampIsEvenInLightness) {
  const ColourRamp ramp = named_ramp("grey");
  const double low = lightness(ramp.at(0)), high = lightness(ramp.at(1));
  for (const double t : {0.25, 0.5, 0.75}) EXPECT_NEAR(lightness(ramp.at(t)), low + t * (high - low), 0.004);
}

TEST(ColourRamp, OfLandAndViridisNeverGetsDarkerUpwards) {
  for (const char* name : {"land", "viridis", "grey"}) {
    const ColourRamp ramp = named_ramp(name);
    for (int i = 0; i < 100; ++i)
      EXPECT_GE(lightness(ramp.at((i + 1) / 100.0)), lightness(ramp.at(i / 100.0)) - 0.004) << name << ' ' << i;
  }
}

TEST(ColourRamp, DifferencesAreLightestInTheMiddle) {
  const ColourRamp ramp = difference_ramp();
  EXPECT_GT(lightness(ramp.at(0.5)), 0.95);
  EXPECT_GT(ramp.at(0)[2], ramp.at(0)[0]);
  EXPECT_GT(ramp.at(1)[0], ramp.at(1)[2]);
}

TEST(ColourRamp, SlopesDarkenAllTheWay) {
  const ColourRamp ramp = slope_ramp();
  for (int i = 0; i < 100; ++i) EXPECT_LT(lightness(ramp.at((i + 1) / 100.0)), lightness(ramp.at(i / 100.0)) + 0.002) << i;
  EXPECT_GT(lightness(ramp.at(0)) - lightness(ramp.at(1)), 0.6);
}

TEST(ColourRamp, AspectsComeRoundAndNoneIsLighterThanTheOthers) {
  const ColourRamp ramp = aspect_ramp();
  EXPECT_EQ(ramp.at(0), ramp.at(1));
  // To the roundness of 8 bits: no hue is cut off at the border of sRGB.
  for (int i = 0; i < 100; ++i) EXPECT_NEAR(lightness(ramp.at(i / 100.0)), lightness(flat_colour()), 0.003) << i;
  EXPECT_GT(ramp.at(0)[2], ramp.at(0)[0] + 60);      // north is blue
  EXPECT_GT(ramp.at(0.25)[1], ramp.at(0.25)[0] + 40);  // east is green
  EXPECT_GT(ramp.at(0.5)[0], ramp.at(0.5)[2] + 60);  // south is orange
}

TEST(ColourRamp, EveryNameIsKnownAndOthersAreRefused) {
  for (const std::string& name : ramp_names()) EXPECT_NO_THROW(named_ramp(name));
  EXPECT_EQ(ramp_names().front(), "land");
  try {
    named_ramp("rainbow");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find("viridis"), std::string::npos);
  }
}

}  // namespace
}  // namespace arete
