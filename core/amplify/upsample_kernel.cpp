// Vectorised over coarse cells, so that each sum is one lane from the first tap to the last.
#include "core/amplify/upsample_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/amplify/upsample_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace arete {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// `Phases` fine cells of two vectors of coarse cells at once: enough accumulators to hide the latency of the multiply-add.
template <int Phases, class D>
void sum_block(D d, const float* const* z, const float* const* e, int reach, const float* weights, std::int64_t taps, std::int64_t x,
               float* out, std::int64_t stride) {
  using V = hn::Vec<D>;
  const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
  const int side = 2 * reach + 1;
  V centre[2], sum[2][Phases];
  for (int v = 0; v < 2; ++v) {
    centre[v] = hn::LoadU(d, z[reach] + x + v * lanes + reach);
    if (e) centre[v] = hn::Sub(centre[v], hn::LoadU(d, e[reach] + x + v * lanes + reach));
    for (int p = 0; p < Phases; ++p) sum[v][p] = hn::Zero(d);
  }
  const float* w = weights;
  for (int dy = 0; dy < side; ++dy)
    for (int dx = 0; dx < side; ++dx, ++w) {
      V difference[2];
      for (int v = 0; v < 2; ++v) {
        difference[v] = hn::LoadU(d, z[dy] + x + v * lanes + dx);
        if (e) difference[v] = hn::Sub(difference[v], hn::LoadU(d, e[dy] + x + v * lanes + dx));
        difference[v] = hn::Sub(difference[v], centre[v]);
      }
      for (int p = 0; p < Phases; ++p) {
        const V weight = hn::Set(d, w[p * taps]);
        sum[0][p] = hn::MulAdd(weight, difference[0], sum[0][p]);
        sum[1][p] = hn::MulAdd(weight, difference[1], sum[1][p]);
      }
    }
  for (int p = 0; p < Phases; ++p)
    for (int v = 0; v < 2; ++v) hn::StoreU(sum[v][p], d, out + p * stride + x + v * lanes);
}

void sum_taps_impl(const float* const* z, const float* const* e, int reach, const float* weights, int phases, std::int64_t count,
                   float* out, std::int64_t stride) {
  const hn::CappedTag<float, 8> d;
  const auto step = 2 * static_cast<std::int64_t>(hn::Lanes(d));
  const std::int64_t taps = std::int64_t{2 * reach + 1} * (2 * reach + 1);
  int p = 0;
  for (; p + 4 <= phases; p += 4)
    for (std::int64_t x = 0; x < count; x += step) sum_block<4>(d, z, e, reach, weights + p * taps, taps, x, out + p * stride, stride);
  for (; p < phases; ++p)
    for (std::int64_t x = 0; x < count; x += step) sum_block<1>(d, z, e, reach, weights + p * taps, taps, x, out + p * stride, stride);
}

void place_scalar(const float* z, const float* e, const float* sums, std::int64_t stride, int factor, std::int64_t begin, std::int64_t end,
                  float* out) {
  for (std::int64_t x = begin; x < end; ++x)
    for (int p = 0; p < factor; ++p) {
      float& cell = out[x * factor + p];
      const float sum = sums[p * stride + x];
      cell = z[x] + (e ? sum + (cell - e[x]) : sum);
    }
}

template <class D>
void place_four(D d, const float* z, const float* e, const float* sums, std::int64_t stride, std::int64_t x, float* out) {
  const auto centre = hn::LoadU(d, z + x);
  auto a = hn::LoadU(d, sums + x), b = hn::LoadU(d, sums + stride + x), c = hn::LoadU(d, sums + 2 * stride + x),
       f = hn::LoadU(d, sums + 3 * stride + x);
  if (e) {
    const auto mean = hn::LoadU(d, e + x);
    hn::Vec<D> p, q, r, s;
    hn::LoadInterleaved4(d, out + 4 * x, p, q, r, s);
    a = hn::Add(a, hn::Sub(p, mean));
    b = hn::Add(b, hn::Sub(q, mean));
    c = hn::Add(c, hn::Sub(r, mean));
    f = hn::Add(f, hn::Sub(s, mean));
  }
  hn::StoreInterleaved4(hn::Add(centre, a), hn::Add(centre, b), hn::Add(centre, c), hn::Add(centre, f), d, out + 4 * x);
}

template <class D>
void place_two(D d, const float* z, const float* e, const float* sums, std::int64_t stride, std::int64_t x, float* out) {
  const auto centre = hn::LoadU(d, z + x);
  auto a = hn::LoadU(d, sums + x), b = hn::LoadU(d, sums + stride + x);
  if (e) {
    const auto mean = hn::LoadU(d, e + x);
    hn::Vec<D> p, q;
    hn::LoadInterleaved2(d, out + 2 * x, p, q);
    a = hn::Add(a, hn::Sub(p, mean));
    b = hn::Add(b, hn::Sub(q, mean));
  }
  hn::StoreInterleaved2(hn::Add(centre, a), hn::Add(centre, b), d, out + 2 * x);
}

void place_phases_impl(const float* z, const float* e, const float* sums, std::int64_t stride, int factor, std::int64_t count, float* out) {
  const hn::CappedTag<float, 8> d;
  const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
  std::int64_t x = 0;
  if (factor == 4)
    for (; x + lanes <= count; x += lanes) place_four(d, z, e, sums, stride, x, out);
  if (factor == 2)
    for (; x + lanes <= count; x += lanes) place_two(d, z, e, sums, stride, x, out);
  place_scalar(z, e, sums, stride, factor, x, count, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace arete
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace arete {

HWY_EXPORT(sum_taps_impl);

void sum_taps(const float* const* z, const float* const* e, int reach, const float* weights, int phases, std::int64_t count, float* out,
              std::int64_t stride) {
  HWY_DYNAMIC_DISPATCH(sum_taps_impl)(z, e, reach, weights, phases, count, out, stride);
}

HWY_EXPORT(place_phases_impl);

void place_phases(const float* z, const float* e, const float* sums, std::int64_t stride, int factor, std::int64_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(place_phases_impl)(z, e, sums, stride, factor, count, out);
}

}  // namespace arete
#endif
