#include "core/codec/dequantise.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/codec/dequantise.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace arete {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class Tag>
HWY_INLINE void dequantise_lanes(Tag tag, const Dequantiser& dequantiser, const std::int32_t* from, float* to) {
  const hn::RebindToFloat<Tag> d;
  const auto points = hn::LoadU(tag, from);
  const auto magnitudes = hn::ConvertTo(d, hn::Abs(points));
  auto shrink = hn::Set(d, dequantiser.shrink[1]);
  shrink = hn::IfThenElse(hn::Ge(magnitudes, hn::Set(d, 2.0F)), hn::Set(d, dequantiser.shrink[2]), shrink);
  shrink = hn::IfThenElse(hn::Ge(magnitudes, hn::Set(d, 3.0F)), hn::Set(d, dequantiser.shrink[3]), shrink);
  const auto sizes = hn::Mul(hn::Sub(magnitudes, shrink), hn::Set(d, dequantiser.scale));
  const auto signs = hn::And(hn::BitCast(d, points), hn::SignBit(d));
  hn::StoreU(hn::IfThenElseZero(hn::Ne(magnitudes, hn::Zero(d)), hn::Xor(sizes, signs)), d, to);
}

void dequantise(const Dequantiser& dequantiser, const std::int32_t* points, float* details, std::int64_t count) {
  const hn::ScalableTag<std::int32_t> tag;
  const auto lanes = static_cast<std::int64_t>(hn::Lanes(tag));
  std::int64_t x = 0;
  for (; x + lanes <= count; x += lanes) dequantise_lanes(tag, dequantiser, points + x, details + x);
  if (x == count) return;
  std::int32_t last_points[hn::MaxLanes(tag)] = {};
  float last_details[hn::MaxLanes(tag)];
  std::copy_n(points + x, count - x, last_points);
  dequantise_lanes(tag, dequantiser, last_points, last_details);
  std::copy_n(last_details, count - x, details + x);
}

}  // namespace HWY_NAMESPACE
}  // namespace arete
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace arete {

HWY_EXPORT(dequantise);

void dequantise_row(const Dequantiser& dequantiser, const std::int32_t* points, float* details, std::int64_t count) {
  HWY_DYNAMIC_DISPATCH(dequantise)(dequantiser, points, details, count);
}

}  // namespace arete
#endif
