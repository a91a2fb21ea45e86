#include "core/amplify/blend_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/amplify/blend_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace arete {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
std::int64_t blend_span(D d, const float* const* blocks, const float* factors, std::int64_t terms, std::int64_t offset, float base, float start,
                        float* out, std::int64_t x, std::int64_t width) {
  const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
  for (; x + lanes <= width; x += lanes) {
    auto sum = hn::Set(d, start);
    for (std::int64_t t = 0; t < terms; ++t)
      sum = hn::MulAdd(hn::Set(d, factors[t]), hn::LoadU(d, blocks[t] + offset + x), sum);
    hn::StoreU(hn::Add(hn::Set(d, base), sum), d, out + x);
  }
  return x;
}

void blend_block_impl(const float* const* blocks, const float* factors, std::int64_t terms, std::int64_t block_stride, float base, float start,
                      float* out, std::int64_t out_stride, std::int64_t width, std::int64_t height) {
  const hn::CappedTag<float, 8> eight;
  const hn::CappedTag<float, 4> four;
  const hn::CappedTag<float, 1> one;
  for (std::int64_t y = 0; y < height; ++y) {
    std::int64_t x = blend_span(eight, blocks, factors, terms, y * block_stride, base, start, out + y * out_stride, 0, width);
    x = blend_span(four, blocks, factors, terms, y * block_stride, base, start, out + y * out_stride, x, width);
    blend_span(one, blocks, factors, terms, y * block_stride, base, start, out + y * out_stride, x, width);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace arete
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace arete {

HWY_EXPORT(blend_block_impl);

void blend_block(const float* const* blocks, const float* factors, std::int64_t terms, std::int64_t block_stride, float base, float start, float* out,
                 std::int64_t out_stride, std::int64_t width, std::int64_t height) {
  HWY_DYNAMIC_DISPATCH(blend_block_impl)(blocks, factors, terms, block_stride, base, start, out, out_stride, width, height);
}

}  // namespace arete
#endif
