#include "gis/contact_sheet.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

/// Smooth bumps, each in another place; a dictionary at one resolution or two.
Dictionary bumps(int patch_cells, int factor, Eigen::Index count) {
  Dictionary d;
  d.patch_cells = patch_cells;
  d.factor = factor;
  const int side = patch_cells * factor;
  Eigen::MatrixXf atoms(side * side, count);
  for (Eigen::Index j = 0; j < count; ++j) {
    const double cx = side * uniform_at(1, static_cast<std::uint64_t>(j)),
                 cy = side * uniform_at(2, static_cast<std::uint64_t>(j));
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        atoms(y * side + x, j) = static_cast<float>(std::exp(-(std::pow(x - cx, 2) + std::pow(y - cy, 2)) / (side * side / 8.0)));
  }
  d.low = Eigen::MatrixXf::Constant(patch_cells * patch_cells, count, 1.0f / static_cast<float>(patch_cells));
  if (factor > 1)
    d.high = atoms;
  else
    d.low = atoms;
  return d;
}

bool same_pixels(const Picture& a, const Window& in_a, const Picture& b, std::int64_t x, std::int64_t y) {
  for (std::int64_t j = 0; j < in_a.height; ++j)
    for (std::int64_t i = 0; i < in_a.width; ++i)
      if (a(in_a.x + i, in_a.y + j) != b(x + i, y + j)) return false;
  return true;
}

// Six atoms lie in three columns and two rows; 8 x 8 samples in tiles of 8 x 8 pixels each, two pixels between them.
constexpr std::int64_t tile = 64, step = tile + 2;

TEST(ContactSheet, HasATilePerAtomInStoredOrder) {
  Dictionary d = bumps(4, 2, 6);
  const Picture sheet = draw_contact_sheet(d, "");
  ASSERT_EQ(sheet.width(), 3 * step + 2);
  ASSERT_EQ(sheet.height(), 2 * step + 2);
  for (std::int64_t i = 0; i < sheet.width(); ++i) EXPECT_EQ(sheet(i, step), (Colour{255, 255, 255, 255})) << i;
  // The fifth atom alone moves: only the tile in the middle of the second row changes.
  d.high.col(4) = d.high.col(4).reverse().eval();
  const Picture changed = draw_contact_sheet(d, "");
  for (std::int64_t j = 0; j < 6; ++j) {
    const Window place{2 + j % 3 * step, 2 + j / 3 * step, tile, tile};
    EXPECT_EQ(same_pixels(sheet, place, changed, place.x, place.y), j != 4) << j;
  }
}

TEST(ContactSheet, ShowsShapesWhateverTheirHeight) {
  Dictionary d = bumps(4, 2, 6);
  d.high.col(1) = 1024 * d.high.col(0);
  d.high.col(2) = d.high.col(0) / 65536;
  const Picture sheet = draw_contact_sheet(d, "");
  for (const std::int64_t j : {1, 2}) EXPECT_TRUE(same_pixels(sheet, {2, 2, tile, tile}, sheet, 2 + j * step, 2)) << j;
  EXPECT_FALSE(same_pixels(sheet, {2, 2, tile, tile}, sheet, 2, 2 + step));
}

TEST(ContactSheet, LightComesFromTheNorthWest) {
  Dictionary d = bumps(8, 1, 1);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      d.low(y * 8 + x, 0) = -static_cast<float>(std::abs(x + y - 7));  // a ridge from south-west to north-east
  const Picture sheet = draw_contact_sheet(d, "");
  const auto brightness = [&](std::int64_t x, std::int64_t y) {
    const Colour& c = sheet(2 + x * 8 + 4, 2 + y * 8 + 4);
    return c[0] + c[1] + c[2];
  };
  // Two samples of the same height on either side.
  EXPECT_GT(brightness(2, 2), brightness(5, 5));
}

TEST(ContactSheet, DrawsTheFirstAtomsOfALargeDictionary) {
  Dictionary d = bumps(2, 1, most_sheet_atoms + 40);
  const Picture sheet = draw_contact_sheet(d, "");
  d.low.conservativeResize(Eigen::NoChange, most_sheet_atoms);
  const Picture first = draw_contact_sheet(d, "");
  ASSERT_EQ(sheet.width(), first.width());
  ASSERT_EQ(sheet.height(), first.height());
  EXPECT_TRUE(same_pixels(sheet, {0, 0, sheet.width(), sheet.height()}, first, 0, 0));
  EXPECT_LE(sheet.width(), 2048 + 2);
}

TEST(ContactSheet, DrawsFlatAndLargeAtoms) {
  Dictionary d = bumps(50, 4, 2);
  d.high.col(0).setZero();
  const Picture sheet = draw_contact_sheet(d, "");
  EXPECT_EQ(sheet(3, 3), sheet(40, 30));
  // 200 samples are averaged by four to 50, which are drawn as eight pixels each.
  EXPECT_EQ(sheet.width(), 2 * (50 * 8 + 2) + 2);
  const Picture with_caption = draw_contact_sheet(d, "two atoms");
  EXPECT_EQ(with_caption.height() > sheet.height(), !find_font().empty());
}

}  // namespace
}  // namespace arete
