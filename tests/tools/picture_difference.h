#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gis/image.h"

namespace arete {

using Lab = std::array<double, 3>;

/// CIE L*a*b* of sRGB (IEC 61966-2-1) under D65, of linear light in [0, 1].
inline Lab lab_of(const std::array<double, 3>& light) {
  const double x = 0.4124564 * light[0] + 0.3575761 * light[1] + 0.1804375 * light[2];
  const double y = 0.2126729 * light[0] + 0.7151522 * light[1] + 0.0721750 * light[2];
  const double z = 0.0193339 * light[0] + 0.1191920 * light[1] + 0.9503041 * light[2];
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double fx = f(x / 0.95047), fy = f(y), fz = f(z / 1.08883);
  return {116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)};
}

/// Linear light, averaged with binomial weights over 5 x 5 pixels (a standard deviation of one pixel), as an eye at arm's length does.
inline std::vector<std::array<double, 3>> blurred_light(const Picture& picture) {
  const std::int64_t w = picture.width(), h = picture.height();
  std::vector<std::array<double, 3>> light(static_cast<std::size_t>(w * h)), once(light.size());
  for (std::size_t i = 0; i < light.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const double v = picture.data()[i][c] / 255.0;
      light[i][c] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    }
  constexpr std::array<double, 5> weights = {1 / 16.0, 4 / 16.0, 6 / 16.0, 4 / 16.0, 1 / 16.0};
  const auto pass = [&](const auto& from, auto& to, std::int64_t dx, std::int64_t dy) {
    for (std::int64_t y = 0; y < h; ++y)
      for (std::int64_t x = 0; x < w; ++x) {
        std::array<double, 3> sum{};
        for (std::int64_t k = -2; k <= 2; ++k) {
          const std::int64_t i = std::clamp<std::int64_t>(x + k * dx, 0, w - 1), j = std::clamp<std::int64_t>(y + k * dy, 0, h - 1);
          for (std::size_t c = 0; c < 3; ++c) sum[c] += weights[static_cast<std::size_t>(k + 2)] * from[static_cast<std::size_t>(j * w + i)][c];
        }
        to[static_cast<std::size_t>(y * w + x)] = sum;
      }
  };
  pass(light, once, 1, 0);
  pass(once, light, 0, 1);
  return light;
}

/// How different two pictures look: the Delta E (CIE 1976) that one pixel in a hundred exceeds, after the blur. Infinite where their sizes differ.
inline double picture_difference(const Picture& a, const Picture& b) {
  if (a.width() != b.width() || a.height() != b.height()) return INFINITY;
  const auto one = blurred_light(a), other = blurred_light(b);
  std::vector<double> differences;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const Lab p = lab_of(one[i]), q = lab_of(other[i]);
    differences.push_back(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
  }
  const auto at = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() * 99 / 100);
  std::nth_element(differences.begin(), at, differences.end());
  return *at;
}

/// Pictures that differ by less look alike. 2.3 is the just noticeable difference of CIE 1976 (Mahy, Van Eycken, Oosterlinck, Color Research & Application 19,
/// 1994). Drivers differ in which samples of a pixel an edge covers, which the blur levels out, and in the last digits of numbers.
inline constexpr double alike = 2.3;

}  // namespace arete
