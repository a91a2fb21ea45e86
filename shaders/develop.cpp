#include "shaders/develop.h"

#include <algorithm>
#include <cmath>

#include "core/support/parallel.h"
#include "core/support/random.h"

namespace arete {
namespace {

double from_linear(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }  // IEC 61966-2-1

double clipped(float v) { return std::clamp(static_cast<double>(v), 0.0, 1.0); }

}  // namespace

void develop(const LightRows& rows, int threads, std::uint8_t* rgba) {
  parallel_for(rows.size.height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < rows.size.width; ++x) {
      const auto i = static_cast<std::size_t>((y * rows.size.width + x) * 4);
      const auto px = static_cast<std::uint64_t>(x), py = static_cast<std::uint64_t>(rows.y + y);
      for (std::size_t c = 0; c < 3; ++c) {
        const double exact = 255 * from_linear(clipped(rows.rgba[i + c])), whole = std::floor(exact);
        rgba[i + c] = static_cast<std::uint8_t>(std::min(255.0, whole + (uniform_at(11, px, py, c) < exact - whole ? 1 : 0)));
      }
      rgba[i + 3] = static_cast<std::uint8_t>(std::lround(255 * clipped(rows.rgba[i + 3])));
    }
  });
}

void develop(const LightRows& rows, int threads, std::uint16_t* rgba) {
  parallel_for(rows.size.height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < rows.size.width; ++x) {
      const auto i = static_cast<std::size_t>((y * rows.size.width + x) * 4);
      for (std::size_t c = 0; c < 3; ++c) rgba[i + c] = static_cast<std::uint16_t>(std::lround(65535 * from_linear(clipped(rows.rgba[i + c]))));
      rgba[i + 3] = static_cast<std::uint16_t>(std::lround(65535 * clipped(rows.rgba[i + 3])));
    }
  });
}

}  // namespace arete
