// Fritsch & Butland, "A method for constructing local monotone piecewise cubic interpolants", SIAM J. Sci. Stat. Comput. 5 (1984);
// end slopes by the three-point rule of Fritsch & Carlson's PCHIM (SLATEC).
#include "core/codec/bjontegaard.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace arete {
namespace {

/// y over x, x rising.
struct Curve {
  std::vector<double> x, y;
  double first() const { return x.front(); }
  double last() const { return x.back(); }
};

std::vector<RatePoint> rising_points(std::span<const RatePoint> points) {
  std::vector<RatePoint> sorted;
  for (const RatePoint& point : points)
    if (std::isfinite(point.bits) && point.bits > 0 && std::isfinite(point.psnr)) sorted.push_back(point);
  std::sort(sorted.begin(), sorted.end(), [](const RatePoint& a, const RatePoint& b) { return a.bits < b.bits; });
  std::vector<RatePoint> rising;
  for (const RatePoint& point : sorted)
    if (rising.empty() || (point.bits > rising.back().bits && point.psnr > rising.back().psnr)) rising.push_back(point);
  return rising;
}

/// The slope at the end of a curve, from its first two intervals h0, h1 and their slopes d0, d1.
double end_slope(double h0, double h1, double d0, double d1) {
  const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (slope * d0 <= 0) return 0;
  if (d0 * d1 <= 0 && std::abs(slope) > 3 * std::abs(d0)) return 3 * d0;
  return slope;
}

std::vector<double> pchip_slopes(const Curve& curve) {
  const std::size_t n = curve.x.size();
  std::vector<double> h(n - 1), d(n - 1), slope(n);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h[i] = curve.x[i + 1] - curve.x[i];
    d[i] = (curve.y[i + 1] - curve.y[i]) / h[i];
  }
  if (n == 2) return {d[0], d[0]};
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double w0 = 2 * h[i] + h[i - 1], w1 = h[i] + 2 * h[i - 1];
    slope[i] = d[i - 1] * d[i] <= 0 ? 0 : (w0 + w1) / (w0 / d[i - 1] + w1 / d[i]);
  }
  slope[0] = end_slope(h[0], h[1], d[0], d[1]);
  slope[n - 1] = end_slope(h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
  return slope;
}

/// The integral of the curve over [from, to], which lies inside it.
double integrate(const Curve& curve, double from, double to) {
  const std::vector<double> slope = pchip_slopes(curve);
  double sum = 0;
  for (std::size_t i = 0; i + 1 < curve.x.size(); ++i) {
    const double a = std::max(from, curve.x[i]), b = std::min(to, curve.x[i + 1]);
    if (b <= a) continue;
    const double h = curve.x[i + 1] - curve.x[i], d = (curve.y[i + 1] - curve.y[i]) / h;
    const double c2 = (3 * d - 2 * slope[i] - slope[i + 1]) / h, c3 = (slope[i] + slope[i + 1] - 2 * d) / (h * h);
    const auto primitive = [&](double t) { return t * (curve.y[i] + t * (slope[i] / 2 + t * (c2 / 3 + t * c3 / 4))); };
    sum += primitive(b - curve.x[i]) - primitive(a - curve.x[i]);
  }
  return sum;
}

/// The mean of test - anchor over the interval that both have in common, inside [lowest, highest].
std::optional<double> mean_difference(const Curve& anchor, const Curve& test, double lowest, double highest) {
  if (anchor.x.size() < 2 || test.x.size() < 2) return std::nullopt;
  const double from = std::max({anchor.first(), test.first(), lowest}), to = std::min({anchor.last(), test.last(), highest});
  if (!(to > from)) return std::nullopt;
  return (integrate(test, from, to) - integrate(anchor, from, to)) / (to - from);
}

Curve psnr_over_rate(std::span<const RatePoint> points) {
  Curve curve;
  for (const RatePoint& point : rising_points(points)) {
    curve.x.push_back(std::log10(point.bits));
    curve.y.push_back(point.psnr);
  }
  return curve;
}

Curve rate_over_psnr(std::span<const RatePoint> points) {
  Curve curve = psnr_over_rate(points);
  std::swap(curve.x, curve.y);
  return curve;
}

}  // namespace

std::optional<double> bd_psnr(std::span<const RatePoint> anchor, std::span<const RatePoint> test, double lowest, double highest) {
  return mean_difference(psnr_over_rate(anchor), psnr_over_rate(test), std::log10(lowest), std::log10(highest));
}

std::optional<double> bd_rate(std::span<const RatePoint> anchor, std::span<const RatePoint> test) {
  const std::optional<double> decades = mean_difference(rate_over_psnr(anchor), rate_over_psnr(test), -1e300, 1e300);
  if (!decades) return std::nullopt;
  return 100 * (std::pow(10, *decades) - 1);
}

}  // namespace arete
