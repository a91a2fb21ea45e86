// Plain loops, compiled once for each instruction set: the compiler vectorises them over x.
#include "core/codec/predict_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/codec/predict_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace arete {
namespace HWY_NAMESPACE {

/// Rows of all planes around row y of a phase: row[plane][dy + 3].
struct RowsAround {
  const std::int32_t* value[4][7];
  const std::int32_t* magnitude[4][7];
};

HWY_INLINE RowsAround rows_around(const NodePlanes& planes, int y) {
  RowsAround rows{};
  for (int p = 0; p < 4; ++p)
    for (int d = -3; d <= 3; ++d) {
      rows.value[p][d + 3] = planes.values[p].row(y + d);
      if (p > 0) rows.magnitude[p][d + 3] = planes.magnitudes[p].row(y + d);
    }
  return rows;
}

template <int phase, int dx, int dy>
HWY_INLINE std::int32_t value_at(const RowsAround& rows, int x) {
  constexpr PlaneOffset at = locate(phase, dx, dy);
  return rows.value[at.phase][at.dy + 3][x + at.dx];
}

template <int phase, int dx, int dy>
HWY_INLINE std::int32_t magnitude_at(const RowsAround& rows, int x) {
  constexpr PlaneOffset at = locate(phase, dx, dy);
  return rows.magnitude[at.phase][at.dy + 3][x + at.dx];
}

template <int phase, int i, typename Sum>
HWY_INLINE Sum sum_pairs(const RowsAround& rows, const std::int32_t* taps, int x) {
  constexpr TapPair pair = tap_pairs[phase - 1][i];
  const Sum both = Sum{value_at<phase, pair.dx, pair.dy>(rows, x)} + Sum{value_at<phase, -pair.dx, -pair.dy>(rows, x)};
  const Sum share = taps[i] * both;
  if constexpr (i + 1 < pair_count[phase - 1])
    return share + sum_pairs<phase, i + 1, Sum>(rows, taps, x);
  else
    return share;
}

template <int phase, typename Sum>
void filter_cells(NodePlanes& planes, int y, const PredictParameters& file, const PhaseParameters& parameters, Sum* HWY_RESTRICT filtered) {
  const RowsAround rows = rows_around(planes, y);
  std::int32_t taps[filter_pairs];
  for (int i = 0; i < filter_pairs; ++i) taps[i] = parameters.taps[static_cast<std::size_t>(i)];
  const Sum low = Sum{file.lowest} * 16, high = Sum{file.highest} * 16;
  const int begin = -phase_margin[phase], end = planes.width + phase_margin[phase];
  std::int32_t* HWY_RESTRICT out = planes.values[phase].row(y);
  for (int x = begin; x < end; ++x) {
    Sum f = (sum_pairs<phase, 0, Sum>(rows, taps, x) + 128) >> 8;
    f = f < low ? low : f;
    f = f > high ? high : f;
    filtered[x] = f;
    out[x] = static_cast<std::int32_t>((f + 8) >> filter_bits);
  }
}

template <typename Sum>
HWY_INLINE Sum magnitude_of(Sum v) {
  return v < 0 ? -v : v;
}

template <typename Sum>
HWY_INLINE std::int32_t held(Sum v) {
  return static_cast<std::int32_t>(v > magnitude_limit ? Sum{magnitude_limit} : v);
}

/// Four times the cell's distance from the mean of four others.
template <int phase, int dx, int dy, int ax, int ay, int bx, int by, typename Sum>
HWY_INLINE Sum relief(const RowsAround& rows, int x) {
  return magnitude_of<Sum>(4 * Sum{value_at<phase, dx, dy>(rows, x)} - Sum{value_at<phase, dx + ax, dy + ay>(rows, x)} -
                           Sum{value_at<phase, dx - ax, dy - ay>(rows, x)} - Sum{value_at<phase, dx + bx, dy + by>(rows, x)} -
                           Sum{value_at<phase, dx - bx, dy - by>(rows, x)});
}

/// Twice the cell's distance from the mean of two others.
template <int phase, int dx, int dy, int ax, int ay, typename Sum>
HWY_INLINE Sum bend(const RowsAround& rows, int x) {
  return magnitude_of<Sum>(2 * Sum{value_at<phase, dx, dy>(rows, x)} - Sum{value_at<phase, dx + ax, dy + ay>(rows, x)} -
                           Sum{value_at<phase, dx - ax, dy - ay>(rows, x)});
}

struct Features {
  std::int32_t f[activity_weights];
};

template <int phase, typename Sum>
HWY_INLINE Features features_at(const RowsAround& rows, int x, Sum filtered) {
  Features out;
  constexpr bool centre = phase == 1;
  // the four nearest: at the corners, or beside and above
  const Sum a = value_at<phase, -1, centre ? -1 : 0>(rows, x);
  const Sum b = value_at<phase, 1, centre ? -1 : 0>(rows, x);
  const Sum c = value_at<phase, centre ? -1 : 0, centre ? 1 : -1>(rows, x);
  const Sum d = value_at<phase, centre ? 1 : 0, 1>(rows, x);
  const Sum sum = a + b + c + d;
  out.f[0] = magnitude_at<phase, -2, 0>(rows, x);
  out.f[1] = magnitude_at<phase, 0, -2>(rows, x);
  out.f[2] = held<std::int32_t>(magnitude_at<phase, -2, -2>(rows, x) + magnitude_at<phase, 2, -2>(rows, x));
  out.f[3] = held<Sum>((magnitude_of<Sum>(4 * a - sum) + magnitude_of<Sum>(4 * b - sum) + magnitude_of<Sum>(4 * c - sum) +
                        magnitude_of<Sum>(4 * d - sum)) >> 2);
  out.f[4] = held<Sum>(magnitude_of<Sum>(sum - (filtered >> 2)));
  if constexpr (phase == 1) {
    out.f[5] = held<std::int32_t>(magnitude_at<1, 0, -4>(rows, x) + magnitude_at<1, 4, -2>(rows, x));
    out.f[6] = held<Sum>(magnitude_of<Sum>(a + d - b - c));
    out.f[7] = held<Sum>((relief<1, -1, -1, 2, 0, 0, 2, Sum>(rows, x) + relief<1, 1, -1, 2, 0, 0, 2, Sum>(rows, x) +
                          relief<1, -1, 1, 2, 0, 0, 2, Sum>(rows, x) + relief<1, 1, 1, 2, 0, 0, 2, Sum>(rows, x)) >> 2);
    out.f[8] = held<Sum>((relief<1, -1, -1, 2, 2, 2, -2, Sum>(rows, x) + relief<1, 1, -1, 2, 2, 2, -2, Sum>(rows, x) +
                          relief<1, -1, 1, 2, 2, 2, -2, Sum>(rows, x) + relief<1, 1, 1, 2, 2, 2, -2, Sum>(rows, x)) >> 2);
  } else if constexpr (phase == 2) {
    out.f[5] = held<std::int32_t>(magnitude_at<2, 0, -1>(rows, x) + magnitude_at<2, 0, 1>(rows, x));
    out.f[6] = held<std::int32_t>(magnitude_at<2, -2, -1>(rows, x) + magnitude_at<2, 2, -1>(rows, x) + magnitude_at<2, -2, 1>(rows, x) +
                                  magnitude_at<2, 2, 1>(rows, x));
    out.f[7] = held<std::int32_t>(magnitude_at<2, 0, -3>(rows, x) + magnitude_at<2, 0, 3>(rows, x));
    out.f[8] = held<Sum>(bend<2, -1, 0, 2, 0, Sum>(rows, x) + bend<2, 1, 0, 2, 0, Sum>(rows, x) + bend<2, 0, -1, 0, 2, Sum>(rows, x) +
                         bend<2, 0, 1, 0, 2, Sum>(rows, x));
  } else {
    out.f[5] = held<std::int32_t>(magnitude_at<3, -1, 0>(rows, x) + magnitude_at<3, 1, 0>(rows, x));
    out.f[6] = held<std::int32_t>(magnitude_at<3, -1, -1>(rows, x) + magnitude_at<3, 1, -1>(rows, x) + magnitude_at<3, -1, 1>(rows, x) +
                                  magnitude_at<3, 1, 1>(rows, x));
    out.f[7] = held<std::int32_t>(magnitude_at<3, -1, -2>(rows, x) + magnitude_at<3, 1, -2>(rows, x) + magnitude_at<3, -1, 2>(rows, x) +
                                  magnitude_at<3, 1, 2>(rows, x) + magnitude_at<3, -3, 0>(rows, x) + magnitude_at<3, 3, 0>(rows, x));
    out.f[8] = held<std::int32_t>(magnitude_at<3, -1, -3>(rows, x) + magnitude_at<3, 1, -3>(rows, x) + magnitude_at<3, -1, 3>(rows, x) +
                                  magnitude_at<3, 1, 3>(rows, x) + magnitude_at<3, -3, -1>(rows, x) + magnitude_at<3, 3, -1>(rows, x) +
                                  magnitude_at<3, -3, 1>(rows, x) + magnitude_at<3, 3, 1>(rows, x));
  }
  return out;
}

/// Of the centre phase, whose magnitudes are known above (phase 1), or on all sides.
template <int phase>
HWY_INLINE std::int32_t magnitudes_around(const RowsAround& rows, int x) {
  constexpr int top = -2, bottom = phase == 1 ? -1 : phase == 2 ? 1 : 2;
  constexpr int left = -2, right = phase == 3 ? 1 : 2;
  std::int32_t sum = 0;
  for (int v = top; v <= bottom; ++v)
    for (int u = left; u <= right; ++u) sum += rows.magnitude[1][v + 3][x + u];
  return phase == 1 ? 2 * sum : sum;
}

template <int phase, typename Sum>
void measure_cells(const NodePlanes& planes, int y, int count, const PhaseParameters& parameters, const Sum* HWY_RESTRICT filtered,
                   std::uint32_t* HWY_RESTRICT expected, std::int32_t* HWY_RESTRICT spread, std::int32_t* HWY_RESTRICT curvature,
                   std::int32_t* HWY_RESTRICT around) {
  const RowsAround rows = rows_around(planes, y);
  std::uint32_t weights[activity_weights];
  for (int i = 0; i < activity_weights; ++i) weights[i] = parameters.activity[static_cast<std::size_t>(i)];
  const std::uint32_t noise = noise_floor(parameters.noise);
  for (int x = 0; x < count; ++x) {
    const Features features = features_at<phase, Sum>(rows, x, filtered[x]);
    std::uint32_t sum = noise;
    for (int i = 1; i < activity_weights; ++i) sum += weights[i] * static_cast<std::uint32_t>(features.f[i]);
    expected[x] = sum;
    spread[x] = features.f[3];
    curvature[x] = features.f[4];
    around[x] = magnitudes_around<phase>(rows, x);
  }
}

void filter_narrow(NodePlanes& planes, int phase, int y, const PredictParameters& file, const PhaseParameters& parameters, std::int32_t* out) {
  if (phase == 1) filter_cells<1, std::int32_t>(planes, y, file, parameters, out);
  else if (phase == 2) filter_cells<2, std::int32_t>(planes, y, file, parameters, out);
  else filter_cells<3, std::int32_t>(planes, y, file, parameters, out);
}
void filter_wide(NodePlanes& planes, int phase, int y, const PredictParameters& file, const PhaseParameters& parameters, std::int64_t* out) {
  if (phase == 1) filter_cells<1, std::int64_t>(planes, y, file, parameters, out);
  else if (phase == 2) filter_cells<2, std::int64_t>(planes, y, file, parameters, out);
  else filter_cells<3, std::int64_t>(planes, y, file, parameters, out);
}
void measure_narrow(const NodePlanes& planes, int phase, int y, int count, const PhaseParameters& parameters, const std::int32_t* filtered,
                    const ActivityRow& out) {
  if (phase == 1) measure_cells<1, std::int32_t>(planes, y, count, parameters, filtered, out.expected, out.spread, out.curvature, out.around);
  else if (phase == 2) measure_cells<2, std::int32_t>(planes, y, count, parameters, filtered, out.expected, out.spread, out.curvature, out.around);
  else measure_cells<3, std::int32_t>(planes, y, count, parameters, filtered, out.expected, out.spread, out.curvature, out.around);
}
void measure_wide(const NodePlanes& planes, int phase, int y, int count, const PhaseParameters& parameters, const std::int64_t* filtered,
                  const ActivityRow& out) {
  if (phase == 1) measure_cells<1, std::int64_t>(planes, y, count, parameters, filtered, out.expected, out.spread, out.curvature, out.around);
  else if (phase == 2) measure_cells<2, std::int64_t>(planes, y, count, parameters, filtered, out.expected, out.spread, out.curvature, out.around);
  else measure_cells<3, std::int64_t>(planes, y, count, parameters, filtered, out.expected, out.spread, out.curvature, out.around);
}

template <typename Sum>
std::array<std::int32_t, activity_weights> features_of(const NodePlanes& planes, int phase, int x, int y, Sum filtered) {
  const RowsAround rows = rows_around(planes, y);
  const Features features = phase == 1   ? features_at<1, Sum>(rows, x, filtered)
                            : phase == 2 ? features_at<2, Sum>(rows, x, filtered)
                                         : features_at<3, Sum>(rows, x, filtered);
  std::array<std::int32_t, activity_weights> out;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = features.f[i];
  return out;
}
std::array<std::int32_t, activity_weights> features_narrow(const NodePlanes& planes, int phase, int x, int y, std::int32_t filtered) {
  return features_of<std::int32_t>(planes, phase, x, y, filtered);
}
std::array<std::int32_t, activity_weights> features_wide(const NodePlanes& planes, int phase, int x, int y, std::int64_t filtered) {
  return features_of<std::int64_t>(planes, phase, x, y, filtered);
}

}  // namespace HWY_NAMESPACE
}  // namespace arete
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace arete {

HWY_EXPORT(filter_narrow);
HWY_EXPORT(filter_wide);
HWY_EXPORT(measure_narrow);
HWY_EXPORT(measure_wide);
HWY_EXPORT(features_narrow);
HWY_EXPORT(features_wide);

template <>
void filter_row(NodePlanes& planes, int phase, int y, const PredictParameters& file, const PhaseParameters& parameters, std::int32_t* filtered) {
  HWY_DYNAMIC_DISPATCH(filter_narrow)(planes, phase, y, file, parameters, filtered);
}
template <>
void filter_row(NodePlanes& planes, int phase, int y, const PredictParameters& file, const PhaseParameters& parameters, std::int64_t* filtered) {
  HWY_DYNAMIC_DISPATCH(filter_wide)(planes, phase, y, file, parameters, filtered);
}
template <>
void measure_activity(const NodePlanes& planes, int phase, int y, int count, const PhaseParameters& parameters, const std::int32_t* filtered,
                      const ActivityRow& out) {
  HWY_DYNAMIC_DISPATCH(measure_narrow)(planes, phase, y, count, parameters, filtered, out);
}
template <>
void measure_activity(const NodePlanes& planes, int phase, int y, int count, const PhaseParameters& parameters, const std::int64_t* filtered,
                      const ActivityRow& out) {
  HWY_DYNAMIC_DISPATCH(measure_wide)(planes, phase, y, count, parameters, filtered, out);
}

template <>
std::array<std::int32_t, activity_weights> activity_features(const NodePlanes& planes, int phase, int x, int y, std::int32_t filtered) {
  return HWY_DYNAMIC_DISPATCH(features_narrow)(planes, phase, x, y, filtered);
}
template <>
std::array<std::int32_t, activity_weights> activity_features(const NodePlanes& planes, int phase, int x, int y, std::int64_t filtered) {
  return HWY_DYNAMIC_DISPATCH(features_wide)(planes, phase, x, y, filtered);
}

}  // namespace arete
#endif
