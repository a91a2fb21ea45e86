#include "core/codec/wavelet.h"

#include <cassert>
#include <cstddef>
#include <vector>

namespace arete {
namespace {

// Lifting steps: odd from even, even from odd, odd from even, even from odd. The first factor goes with the two nearest
// samples, the second with the next two. The last factor of the third step makes details of constants zero, the last of
// the fourth makes the low-pass band blind to the highest frequency.
constexpr float step_factors[4][2] = {
    {-1.57278217F, 0.14314374F},
    {-0.04921203F, 0.02216245F},
    {0.86679982F, -0.02212343F},
    {0.43797085F, -0.10537847F},
};

// Makes the low-pass gain of a constant 1.
constexpr float low_scale = 0.90860742F;
constexpr float low_unscale = 1 / low_scale;

constexpr int reach = wavelet_reach / 2;  // in coefficients

// to[i] += sign x (a (u[i] + v[i]) + b (p[i] + q[i]))
template <int sign>
void lift(float* to, const float* u, const float* v, const float* p, const float* q, const float (&factors)[2], std::int64_t count) {
  const float a = factors[0], b = factors[1];
  for (std::int64_t i = 0; i < count; ++i) {
    const float change = a * (u[i] + v[i]) + b * (p[i] + q[i]);
    to[i] = sign > 0 ? to[i] + change : to[i] - change;
  }
}

// The same over a signal split in even and odd samples, each reach + n + reach long; the steps eat the margins.
void lift_forward(float* even, float* odd, std::int64_t n) {
  const std::int64_t m = n + 2 * reach;
  lift<1>(odd + 1, even + 1, even + 2, even, even + 3, step_factors[0], m - 3);
  lift<1>(even + 3, odd + 2, odd + 3, odd + 1, odd + 4, step_factors[1], m - 6);
  lift<1>(odd + 4, even + 4, even + 5, even + 3, even + 6, step_factors[2], m - 9);
  lift<1>(even + 6, odd + 5, odd + 6, odd + 4, odd + 7, step_factors[3], m - 12);
}

void lift_backward(float* even, float* odd, std::int64_t n) {
  const std::int64_t m = n + 2 * reach;
  lift<-1>(even + 2, odd + 1, odd + 2, odd, odd + 3, step_factors[3], m - 3);
  lift<-1>(odd + 3, even + 3, even + 4, even + 2, even + 5, step_factors[2], m - 6);
  lift<-1>(even + 5, odd + 4, odd + 5, odd + 3, odd + 6, step_factors[1], m - 9);
  lift<-1>(odd + 6, even + 6, even + 7, even + 5, even + 8, step_factors[0], m - 12);
}

// Rows of a block, even and odd ones apart, lifted as one: row i of `even` is even + i x width.
struct RowPair {
  std::vector<float> even, odd;
  std::int64_t width;
  RowPair(std::int64_t rows, std::int64_t columns)
      : even(static_cast<std::size_t>(rows * columns)), odd(static_cast<std::size_t>(rows * columns)), width(columns) {}
  float* even_row(std::int64_t i) { return even.data() + i * width; }
  float* odd_row(std::int64_t i) { return odd.data() + i * width; }
};

// odd row i from even rows i - 1 to i + 2
template <int sign>
void lift_odd_rows(RowPair& rows, const float (&factors)[2], std::int64_t first, std::int64_t count) {
  for (std::int64_t i = first; i < first + count; ++i)
    lift<sign>(rows.odd_row(i), rows.even_row(i), rows.even_row(i + 1), rows.even_row(i - 1), rows.even_row(i + 2), factors, rows.width);
}

// even row i from odd rows i - 2 to i + 1
template <int sign>
void lift_even_rows(RowPair& rows, const float (&factors)[2], std::int64_t first, std::int64_t count) {
  for (std::int64_t i = first; i < first + count; ++i)
    lift<sign>(rows.even_row(i), rows.odd_row(i - 1), rows.odd_row(i), rows.odd_row(i - 2), rows.odd_row(i + 1), factors, rows.width);
}

}  // namespace

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
  const std::int64_t w = low.width, h = low.height;
  assert(padded.width == 2 * (w + 2 * reach) && padded.height == 2 * (h + 2 * reach));
  RowPair rows(h + 2 * reach, 2 * w);
  std::vector<float> even(static_cast<std::size_t>(w + 2 * reach)), odd(even.size());
  for (std::int64_t y = 0; y < padded.height; ++y) {
    for (std::size_t x = 0; x < even.size(); ++x) {
      even[x] = padded.row(y)[2 * x];
      odd[x] = padded.row(y)[2 * x + 1];
    }
    lift_forward(even.data(), odd.data(), w);
    float* to = y % 2 == 0 ? rows.even_row(y / 2) : rows.odd_row(y / 2);
    for (std::int64_t x = 0; x < w; ++x) {
      to[x] = even[static_cast<std::size_t>(reach + x)] * low_scale;
      to[w + x] = odd[static_cast<std::size_t>(reach + x)];
    }
  }
  const std::int64_t m = h + 2 * reach;
  lift_odd_rows<1>(rows, step_factors[0], 1, m - 3);
  lift_even_rows<1>(rows, step_factors[1], 3, m - 6);
  lift_odd_rows<1>(rows, step_factors[2], 4, m - 9);
  lift_even_rows<1>(rows, step_factors[3], 6, m - 12);
  for (std::int64_t y = 0; y < h; ++y) {
    const float* e = rows.even_row(reach + y);
    const float* o = rows.odd_row(reach + y);
    for (std::int64_t x = 0; x < w; ++x) {
      low.row(y)[x] = e[x] * low_scale;
      bands[0].row(y)[x] = e[w + x] * low_scale;
      bands[1].row(y)[x] = o[x];
      bands[2].row(y)[x] = o[w + x];
    }
  }
}

void synthesise(RasterView<const float> low, const std::array<RasterView<const float>, band_count>& bands, RasterView<float> samples) {
  const std::int64_t w = low.width - 2 * reach, h = low.height - 2 * reach;
  assert(samples.width == 2 * w && samples.height == 2 * h);
  const std::int64_t m = h + 2 * reach, n = w + 2 * reach;
  RowPair rows(m, 2 * n);
  for (std::int64_t y = 0; y < m; ++y) {
    float* e = rows.even_row(y);
    float* o = rows.odd_row(y);
    for (std::int64_t x = 0; x < n; ++x) {
      e[x] = low.row(y)[x] * low_unscale;
      e[n + x] = bands[0].row(y)[x] * low_unscale;
      o[x] = bands[1].row(y)[x];
      o[n + x] = bands[2].row(y)[x];
    }
  }
  lift_even_rows<-1>(rows, step_factors[3], 2, m - 3);
  lift_odd_rows<-1>(rows, step_factors[2], 3, m - 6);
  lift_even_rows<-1>(rows, step_factors[1], 5, m - 9);
  lift_odd_rows<-1>(rows, step_factors[0], 6, m - 12);
  for (std::int64_t y = 0; y < 2 * h; ++y) {
    float* row = y % 2 == 0 ? rows.even_row(reach + y / 2) : rows.odd_row(reach + y / 2);
    float* even = row;
    float* odd = row + n;
    for (std::int64_t x = 0; x < n; ++x) even[x] *= low_unscale;
    lift_backward(even, odd, w);
    float* to = samples.row(y);
    for (std::int64_t x = 0; x < w; ++x) {
      to[2 * x] = even[reach + x];
      to[2 * x + 1] = odd[reach + x];
    }
  }
}

}  // namespace arete
