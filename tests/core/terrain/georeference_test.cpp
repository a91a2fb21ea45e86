#include "core/terrain/georeference.h"

#include <gtest/gtest.h>

namespace {

using arete::GeoReference;

GeoReference rotated() {
  GeoReference geo;
  geo.transform = {600000, 30, 4, 5200000, 3, -25};
  geo.crs_wkt = "any";
  return geo;
}

/// The corner (column, row) on the ground.
std::array<double, 2> corner(const GeoReference& geo, double column, double row) {
  const auto& t = *geo.transform;
  return {t[0] + column * t[1] + row * t[2], t[3] + column * t[4] + row * t[5]};
}

TEST(GeoReference, RefiningKeepsTheExtent) {
  // A power of two divides exactly.
  const GeoReference finer = arete::refine(rotated(), 4);
  EXPECT_EQ(corner(finer, 0, 0), corner(rotated(), 0, 0));
  EXPECT_EQ(corner(finer, 4 * 120, 4 * 77), corner(rotated(), 120, 77));
  EXPECT_EQ(finer.crs_wkt, "any");
}

TEST(GeoReference, CoarseningUndoesRefining) {
  EXPECT_EQ(arete::coarsen(arete::refine(rotated(), 8), 8).transform, rotated().transform);
}

TEST(GeoReference, ACropBeginsAtItsWindow) {
  const GeoReference part = arete::crop(rotated(), {7, 11, 5, 5});
  EXPECT_EQ(corner(part, 0, 0), corner(rotated(), 7, 11));
  EXPECT_EQ(corner(part, 2, 3), corner(rotated(), 9, 14));
}

TEST(GeoReference, WithoutATransformNothingIsInvented) {
  EXPECT_FALSE(arete::refine({}, 2).transform);
  EXPECT_FALSE(arete::coarsen({}, 2).transform);
  EXPECT_FALSE(arete::crop({}, {1, 1, 1, 1}).transform);
}

}  // namespace
