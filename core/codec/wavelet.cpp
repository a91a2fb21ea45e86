// Plain loops, compiled once for each instruction set: the compiler vectorises them over x. No sum is reordered, so that the
// values are the same with all of them.
#include "core/codec/wavelet.h"

#include <cassert>
#include <cstddef>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/codec/wavelet.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef ARETE_WAVELET_FACTORS
#define ARETE_WAVELET_FACTORS
namespace arete::lifting {

// Lifting steps: odd from even, even from odd, odd from even, even from odd. The first factor goes with the two nearest
// samples, the second with the next two. The last factor of the third step makes details of constants zero, the last of
// the fourth makes the low-pass band blind to the highest frequency.
inline constexpr float step_factors[4][2] = {
    {-1.57278217F, 0.14314374F},
    {-0.04921203F, 0.02216245F},
    {0.86679982F, -0.02212343F},
    {0.43797085F, -0.10537847F},
};

// Makes the low-pass gain of a constant 1.
inline constexpr float low_scale = 0.90860742F;
inline constexpr float low_unscale = 1 / low_scale;

inline constexpr int reach = wavelet_reach / 2;  // in coefficients

}  // namespace arete::lifting
#endif

HWY_BEFORE_NAMESPACE();
namespace arete {
namespace HWY_NAMESPACE {

using lifting::low_scale;
using lifting::low_unscale;
using lifting::reach;
using lifting::step_factors;

// to[i] += sign x (a (u[i] + v[i]) + b (p[i] + q[i]))
template <int sign>
HWY_INLINE void lift(float* HWY_RESTRICT to, const float* HWY_RESTRICT u, const float* HWY_RESTRICT v, const float* HWY_RESTRICT p,
                     const float* HWY_RESTRICT q, const float (&factors)[2], std::int64_t count) {
  const float a = factors[0], b = factors[1];
  for (std::int64_t i = 0; i < count; ++i) {
    const float change = a * (u[i] + v[i]) + b * (p[i] + q[i]);
    to[i] = sign > 0 ? to[i] + change : to[i] - change;
  }
}

// The same over a signal split in even and odd samples, each reach + n + reach long; the steps eat the margins.
void lift_forward(float* HWY_RESTRICT even, float* HWY_RESTRICT odd, std::int64_t n) {
  const std::int64_t m = n + 2 * reach;
  lift<1>(odd + 1, even + 1, even + 2, even, even + 3, step_factors[0], m - 3);
  lift<1>(even + 3, odd + 2, odd + 3, odd + 1, odd + 4, step_factors[1], m - 6);
  lift<1>(odd + 4, even + 4, even + 5, even + 3, even + 6, step_factors[2], m - 9);
  lift<1>(even + 6, odd + 5, odd + 6, odd + 4, odd + 7, step_factors[3], m - 12);
}

void lift_backward(float* HWY_RESTRICT even, float* HWY_RESTRICT odd, std::int64_t n) {
  const std::int64_t m = n + 2 * reach;
  lift<-1>(even + 2, odd + 1, odd + 2, odd, odd + 3, step_factors[3], m - 3);
  lift<-1>(odd + 3, even + 3, even + 4, even + 2, even + 5, step_factors[2], m - 6);
  lift<-1>(even + 5, odd + 4, odd + 5, odd + 3, odd + 6, step_factors[1], m - 9);
  lift<-1>(odd + 6, even + 6, even + 7, even + 5, even + 8, step_factors[0], m - 12);
}

HWY_INLINE void scale(float* HWY_RESTRICT to, const float* HWY_RESTRICT from, float factor, std::int64_t count) {
  for (std::int64_t i = 0; i < count; ++i) to[i] = from[i] * factor;
}

HWY_INLINE void copy(float* HWY_RESTRICT to, const float* HWY_RESTRICT from, std::int64_t count) {
  for (std::int64_t i = 0; i < count; ++i) to[i] = from[i];
}

HWY_INLINE void split(const float* HWY_RESTRICT from, float* HWY_RESTRICT even, float* HWY_RESTRICT odd, std::int64_t count) {
  for (std::int64_t i = 0; i < count; ++i) {
    even[i] = from[2 * i];
    odd[i] = from[2 * i + 1];
  }
}

HWY_INLINE void join(float* HWY_RESTRICT to, const float* HWY_RESTRICT even, const float* HWY_RESTRICT odd, std::int64_t count) {
  for (std::int64_t i = 0; i < count; ++i) {
    to[2 * i] = even[i];
    to[2 * i + 1] = odd[i];
  }
}

// The last rows of a block, even and odd ones apart: what the lifting steps of a column reach over, so that all of it stays in
// the first cache however high the block is.
class RowWindow {
 public:
  explicit RowWindow(std::int64_t columns) : cells_(static_cast<std::size_t>(2 * rows * columns)), width_(columns) {}
  float* even(std::int64_t i) { return cells_.data() + i % rows * 2 * width_; }
  float* odd(std::int64_t i) { return even(i) + width_; }
  template <int sign>
  void lift_odd(std::int64_t i, const float (&factors)[2]) {
    lift<sign>(odd(i), even(i), even(i + 1), even(i - 1), even(i + 2), factors, width_);
  }
  template <int sign>
  void lift_even(std::int64_t i, const float (&factors)[2]) {
    lift<sign>(even(i), odd(i - 1), odd(i), odd(i - 2), odd(i + 1), factors, width_);
  }

 private:
  static constexpr std::int64_t rows = 9;
  std::vector<float> cells_;
  std::int64_t width_;
};

void analyse_block(RasterView<const float> padded, RasterView<float> low, const std::array<RasterView<float>, band_count>& bands) {
  const std::int64_t w = low.width, n = w + 2 * reach;
  RowWindow rows(2 * w);
  std::vector<float> even(static_cast<std::size_t>(n)), odd(static_cast<std::size_t>(n));
  for (std::int64_t i = 0; i < low.height + 2 * reach; ++i) {
    for (int parity = 0; parity < 2; ++parity) {
      split(padded.row(2 * i + parity), even.data(), odd.data(), n);
      lift_forward(even.data(), odd.data(), w);
      float* to = parity == 0 ? rows.even(i) : rows.odd(i);
      scale(to, even.data() + reach, low_scale, w);
      copy(to + w, odd.data() + reach, w);
    }
    if (i >= 3) rows.lift_odd<1>(i - 2, step_factors[0]);
    if (i >= 6) rows.lift_even<1>(i - 3, step_factors[1]);
    if (i >= 9) rows.lift_odd<1>(i - 5, step_factors[2]);
    if (i < 2 * reach) continue;
    rows.lift_even<1>(i - reach, step_factors[3]);
    const std::int64_t y = i - 2 * reach;
    const float* e = rows.even(i - reach);
    const float* o = rows.odd(i - reach);
    scale(low.row(y), e, low_scale, w);
    scale(bands[0].row(y), e + w, low_scale, w);
    copy(bands[1].row(y), o, w);
    copy(bands[2].row(y), o + w, w);
  }
}

void synthesise_block(RasterView<const float> low, const std::array<RasterView<const float>, band_count>& bands, RasterView<float> samples) {
  const std::int64_t n = low.width, w = n - 2 * reach;
  RowWindow rows(2 * n);
  std::vector<float> even(static_cast<std::size_t>(n)), odd(static_cast<std::size_t>(n));
  const auto finish = [&](const float* row, float* to) {
    scale(even.data(), row, low_unscale, n);
    copy(odd.data(), row + n, n);
    lift_backward(even.data(), odd.data(), w);
    join(to, even.data() + reach, odd.data() + reach, w);
  };
  for (std::int64_t i = 0; i < low.height; ++i) {
    float* e = rows.even(i);
    float* o = rows.odd(i);
    scale(e, low.row(i), low_unscale, n);
    scale(e + n, bands[0].row(i), low_unscale, n);
    copy(o, bands[1].row(i), n);
    copy(o + n, bands[2].row(i), n);
    if (i >= 3) rows.lift_even<-1>(i - 1, step_factors[3]);
    if (i >= 6) rows.lift_odd<-1>(i - 3, step_factors[2]);
    if (i >= 9) rows.lift_even<-1>(i - 4, step_factors[1]);
    if (i < 2 * reach) continue;
    rows.lift_odd<-1>(i - reach, step_factors[0]);
    const std::int64_t y = 2 * (i - 2 * reach);
    finish(rows.even(i - reach), samples.row(y));
    finish(rows.odd(i - reach), samples.row(y + 1));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace arete
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace arete {

HWY_EXPORT(analyse_block);
HWY_EXPORT(synthesise_block);

float band_norm(int level, int band) {
  // Norms of one-dimensional synthesis functions, by iterating the synthesis in double precision; from level 8 on each is
  // sqrt(2) times the one before, to seven digits.
  constexpr int tabled = 8;
  constexpr float low[tabled] = {1.31949571F, 1.82213203F, 2.55308988F, 3.60131921F, 5.08967079F, 7.1966855F, 10.1772269F, 14.3926227F};
  constexpr float high[tabled] = {0.844662386F, 1.07131195F, 1.45700408F, 2.02683743F, 2.85303083F, 4.02994697F, 5.69748045F, 8.05684325F};
  constexpr float root_of_two = 1.41421356F;
  const auto norm = [&](const float (&table)[tabled]) {
    float value = table[(level < tabled ? level : tabled) - 1];
    for (int l = tabled; l < level; ++l) value *= root_of_two;
    return value;
  };
  if (band == band_count) return norm(low) * norm(low);
  return band == static_cast<int>(Band::diagonal) ? norm(high) * norm(high) : norm(high) * norm(low);
}

Size band_size(const Size& samples, int band) {
  const Size low{(samples.width + 1) / 2, (samples.height + 1) / 2};
  const Size high{samples.width / 2, samples.height / 2};
  if (band == band_count) return low;
  return {band == static_cast<int>(Band::vertical) ? low.width : high.width, band == static_cast<int>(Band::horizontal) ? low.height : high.height};
}

void analyse(RasterView<const float> padded, RasterView<float> low, const std::array<RasterView<float>, band_count>& bands) {
  assert(padded.width == 2 * low.width + 2 * wavelet_reach && padded.height == 2 * low.height + 2 * wavelet_reach);
  HWY_DYNAMIC_DISPATCH(analyse_block)(padded, low, bands);
}

void synthesise(RasterView<const float> low, const std::array<RasterView<const float>, band_count>& bands, RasterView<float> samples) {
  assert(samples.width == 2 * low.width - 2 * wavelet_reach && samples.height == 2 * low.height - 2 * wavelet_reach);
  HWY_DYNAMIC_DISPATCH(synthesise_block)(low, bands, samples);
}

}  // namespace arete
#endif
