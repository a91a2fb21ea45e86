#include "shaders/picture_atlas.h"

#include <algorithm>
#include <cmath>

#include "core/support/parallel.h"
#include "shaders/srgb.h"

namespace arete {
namespace {

constexpr int fine = 65535;

struct Tables {
  std::array<double, 256> linear;
  std::vector<std::uint8_t> srgb;
  Tables() : srgb(fine + 1) {
    for (std::size_t i = 0; i < 256; ++i) linear[i] = srgb_to_linear(static_cast<double>(i) / 255);
    for (std::size_t i = 0; i <= fine; ++i)
      srgb[i] = static_cast<std::uint8_t>(std::lround(255 * linear_to_srgb(static_cast<double>(i) / fine)));
  }
  std::uint8_t encode(double v) const { return srgb[static_cast<std::size_t>(v * fine + 0.5)]; }
};

}  // namespace

PictureAtlas make_atlas(const GroundPicture& picture, int threads) {
  static const Tables tables;
  std::vector<Size> sizes = {picture.size};
  PictureAtlas atlas{{picture.size.width, picture.size.height}, {}, {0}};
  std::int64_t below = 0;
  while (sizes.back().cells() > 1) {
    sizes.push_back({(sizes.back().width + 1) / 2, (sizes.back().height + 1) / 2});
    atlas.rows.push_back(static_cast<std::int32_t>(below));
    below += sizes.back().height;
  }
  if (sizes.size() > 1) atlas.size = {sizes[0].width + sizes[1].width, std::max(sizes[0].height, below)};
  atlas.rgba.resize(static_cast<std::size_t>(atlas.size.cells()));
  const auto at = [&](std::size_t level, std::int64_t x, std::int64_t y) -> std::array<std::uint8_t, 4>& {
    return atlas
        .rgba[static_cast<std::size_t>((atlas.rows[level] + y) * atlas.size.width + (level > 0 ? sizes[0].width : 0) + x)];
  };
  parallel_for(sizes[0].height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < sizes[0].width; ++x) {
      std::array<std::uint8_t, 4> pixel = picture.rgba[static_cast<std::size_t>(y * sizes[0].width + x)];
      if (pixel[3] < 255)
        for (std::size_t c = 0; c < 3; ++c) pixel[c] = tables.encode(tables.linear[pixel[c]] * pixel[3] / 255);
      at(0, x, y) = pixel;
    }
  });
  for (std::size_t level = 1; level < sizes.size(); ++level) {
    const Size from = sizes[level - 1];
    parallel_for(sizes[level].height, threads, [&](std::int64_t y) {
      for (std::int64_t x = 0; x < sizes[level].width; ++x) {
        double sum[4] = {};
        for (int k = 0; k < 4; ++k) {
          const auto& pixel = at(level - 1, std::min(2 * x + k % 2, from.width - 1), std::min(2 * y + k / 2, from.height - 1));
          for (std::size_t c = 0; c < 3; ++c) sum[c] += tables.linear[pixel[c]];
          sum[3] += pixel[3];
        }
        auto& out = at(level, x, y);
        for (std::size_t c = 0; c < 3; ++c) out[c] = tables.encode(sum[c] / 4);
        out[3] = static_cast<std::uint8_t>(sum[3] / 4 + 0.5);
      }
    });
  }
  return atlas;
}

}  // namespace arete
