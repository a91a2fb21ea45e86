#include "shaders/develop.h"

#include <algorithm>
#include <cmath>

#include "core/support/parallel.h"
#include "core/support/random.h"
#include "shaders/srgb.h"

namespace arete {
namespace {

double srgb_of(double linear) { return linear_to_srgb(std::clamp(linear, 0.0, 1.0)); }
float byte_of(double linear) { return static_cast<float>(255 * srgb_of(linear)); }

/// IEEE 754 binary16, finite values.
float from_half(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31, fraction = bits & 1023;
  const double size = exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  return static_cast<float>(bits >> 15 ? -size : size);
}

template <typename Function>
std::vector<float> tabulate(const Function& f) {
  std::vector<float> table(65536);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = f(static_cast<std::uint16_t>(i));
  return table;
}

const std::vector<float>& floats_of_halves() {
  static const std::vector<float> table = tabulate(from_half);
  return table;
}

/// Pixel (x, y) of the part, averaged, in double precision: exact for halves of alike size.
void average_pixel(const DrawnPart& drawn, std::int64_t x, std::int64_t y, const std::vector<float>& floats, double (&light)[4]) {
  const std::int64_t s = drawn.supersampling, stride = drawn.part.width * s;
  const std::uint16_t* from = &drawn.halves[static_cast<std::size_t>((((drawn.part.height - y) * s - 1) * stride + x * s) * 4)];
  double sum[4] = {};
  for (std::int64_t v = 0; v < s; ++v, from -= stride * 4)
    for (std::int64_t u = 0; u < 4 * s; ++u) sum[u % 4] += static_cast<double>(floats[from[u]]);
  for (std::size_t c = 0; c < 4; ++c) light[c] = sum[c] / static_cast<double>(s * s);
}

/// Whole + 1 where the noise is less than the rest.
void put_bytes(const float (&exact)[3], float covered, std::int64_t x, std::int64_t y, std::uint8_t* out) {
  std::uint64_t noise = hash_position(11, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y));
  for (std::size_t c = 0; c < 3; ++c, noise >>= 21)
    out[c] = static_cast<std::uint8_t>(std::min(255, static_cast<int>(exact[c] + static_cast<float>(0x1fffff - (noise & 0x1fffff)) * 0x1p-21f)));
  out[3] = static_cast<std::uint8_t>(255 * std::clamp(covered, 0.0f, 1.0f) + 0.5f);
}

}  // namespace

void average(const DrawnPart& drawn, int threads, LightRows& rows) {
  const std::vector<float>& floats = floats_of_halves();
  parallel_for(drawn.part.height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < drawn.part.width; ++x) {
      double light[4];
      average_pixel(drawn, x, y, floats, light);
      float* out = &rows.rgba[static_cast<std::size_t>(((drawn.part.y - rows.y + y) * rows.size.width + drawn.part.x + x) * 4)];
      for (std::size_t c = 0; c < 4; ++c) out[c] = static_cast<float>(light[c]);
    }
  });
}

void develop(const DrawnPart& drawn, int threads, std::int64_t picture_width, std::uint8_t* rgba) {
  static const std::vector<float> bytes = tabulate([](std::uint16_t bits) { return byte_of(static_cast<double>(from_half(bits))); });
  const std::vector<float>& floats = floats_of_halves();
  const PicturePart& part = drawn.part;
  parallel_for(part.height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < part.width; ++x) {
      float exact[3], covered = 0;
      if (drawn.supersampling == 1) {
        const std::uint16_t* from = &drawn.halves[static_cast<std::size_t>(((part.height - 1 - y) * part.width + x) * 4)];
        for (std::size_t c = 0; c < 3; ++c) exact[c] = bytes[from[c]];
        covered = floats[from[3]];
      } else {
        double light[4];
        average_pixel(drawn, x, y, floats, light);
        for (std::size_t c = 0; c < 3; ++c) exact[c] = byte_of(light[c]);
        covered = static_cast<float>(light[3]);
      }
      put_bytes(exact, covered, part.x + x, part.y + y, &rgba[static_cast<std::size_t>(((part.y + y) * picture_width + part.x + x) * 4)]);
    }
  });
}

void develop(const LightRows& rows, int threads, std::uint8_t* rgba) {
  parallel_for(rows.size.height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < rows.size.width; ++x) {
      const auto i = static_cast<std::size_t>((y * rows.size.width + x) * 4);
      float exact[3];
      for (std::size_t c = 0; c < 3; ++c) exact[c] = byte_of(static_cast<double>(rows.rgba[i + c]));
      put_bytes(exact, rows.rgba[i + 3], x, rows.y + y, &rgba[i]);
    }
  });
}

void develop(const LightRows& rows, int threads, std::uint16_t* rgba) {
  parallel_for(rows.size.height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < rows.size.width; ++x) {
      const auto i = static_cast<std::size_t>((y * rows.size.width + x) * 4);
      for (std::size_t c = 0; c < 3; ++c) rgba[i + c] = static_cast<std::uint16_t>(std::lround(65535 * srgb_of(static_cast<double>(rows.rgba[i + c]))));
      rgba[i + 3] = static_cast<std::uint16_t>(std::lround(65535 * std::clamp(static_cast<double>(rows.rgba[i + 3]), 0.0, 1.0)));
    }
  });
}

}  // namespace arete
