#include "gis/compression_trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "core/support/error.h"

namespace arete {
namespace {

constexpr double near_enough = 0.01;      // of a rate: what a file may be off, and how far beyond its ends a curve is read
constexpr double narrow_bracket = 1.2;    // rates this near are joined by a straight line with an error of hundredths of a dB
constexpr int most_attempts = 8;          // per rate
constexpr double infinity = std::numeric_limits<double>::infinity();

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

/// Times in seconds of one run and the next.
class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Nothing where the codec says that it cannot reach the target.
std::optional<Measurement> try_measure(const CodecUnderTest& codec, const TestedTerrain& terrain, CodingTarget target, int repeats, int threads) {
  if (!codec.can(terrain, target)) return std::nullopt;
  try {
    return measure_codec(codec, terrain, target, repeats, threads);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::usage) throw;
    return std::nullopt;
  }
}

/// The measured points of a codec at one terrain, in rising rates.
class Curve {
 public:
  Curve(const CodecUnderTest& codec, const TestedTerrain& terrain, const TrialPlan& plan) : codec_(codec), terrain_(terrain), plan_(plan) {}

  const std::vector<Measurement>& points() const { return points_; }

  /// Measures points until the rate can be read off.
  void approach(double rate) {
    if (const auto range = codec_.settings_range(terrain_))
      search_setting(rate, *range);
    else
      ask_for_bytes(rate);
  }

  std::optional<RateReading> read(double rate) {
    if (points_.empty()) return std::nullopt;
    const Measurement& nearest = time_nearest(rate);
    const auto above = std::find_if(points_.begin(), points_.end(), [&](const Measurement& point) { return point.bits >= rate; });
    const auto reading = [&](double psnr, double error) { return RateReading{rate, psnr, error, nearest.encode_s, nearest.decode_s}; };
    if (above == points_.begin() || above == points_.end() || points_.size() == 1) {
      const Measurement& end = above == points_.end() ? points_.back() : points_.front();
      const bool reached = std::abs(std::log(end.bits / rate)) <= near_enough && std::isfinite(end.psnr_db);
      return reached ? std::optional(reading(end.psnr_db, end.max_error_m)) : std::nullopt;
    }
    const Measurement &low = *std::prev(above), &high = *above;
    if (!std::isfinite(low.psnr_db) || !std::isfinite(high.psnr_db)) return std::nullopt;
    const double share = std::log(rate / low.bits) / std::log(high.bits / low.bits);
    return reading(std::lerp(low.psnr_db, high.psnr_db, share), std::lerp(low.max_error_m, high.max_error_m, share));
  }

 private:
  const Measurement* measured(CodingTarget target) const {
    const auto found = std::find_if(points_.begin(), points_.end(), [&](const Measurement& point) { return point.target == target; });
    return found == points_.end() ? nullptr : &*found;
  }

  /// The bits per sample that the target gave, or nothing.
  std::optional<double> measure(CodingTarget target) {
    if (const Measurement* known = measured(target)) return known->bits;
    const std::optional<Measurement> made = try_measure(codec_, terrain_, target, 1, plan_.threads);
    if (!made) return std::nullopt;
    points_.insert(std::upper_bound(points_.begin(), points_.end(), *made, [](const auto& a, const auto& b) { return a.bits < b.bits; }), *made);
    return made->bits;
  }

  void ask_for_bytes(double rate) {
    const double bytes = rate * static_cast<double>(terrain_.cells.size().cells()) / 8;
    const std::optional<double> got = measure({CodingTarget::Kind::bytes, bytes});
    if (!got) return;
    // A second file where the first missed a little; a codec that missed by far has nothing more to say.
    const double miss = std::abs(std::log(*got / rate));
    if (miss > near_enough / 4 && miss < std::log(1.5)) measure({CodingTarget::Kind::bytes, bytes * rate / *got});
  }

  void search_setting(double rate, CodecUnderTest::SettingsRange range) {
    double low = std::log(range.coarse), high = std::log(range.fine);
    const std::optional<double> least = measure({CodingTarget::Kind::setting, range.coarse}), most = measure({CodingTarget::Kind::setting, range.fine});
    if (!least || !most) return;
    double low_bits = *least, high_bits = *most;
    for (const Measurement& point : points_) {  // what other rates have found
      if (point.bits <= rate && point.bits > low_bits) low_bits = point.bits, low = std::log(point.target.value);
      if (point.bits > rate && point.bits < high_bits) high_bits = point.bits, high = std::log(point.target.value);
    }
    if (rate < low_bits || rate > high_bits) return;
    for (int attempt = 0; attempt < most_attempts && high_bits > low_bits * narrow_bracket; ++attempt) {
      if (std::min(rate / low_bits, high_bits / rate) < 1 + near_enough) return;
      // Where the setting should be, were the curve straight; kept off the ends, so that the bracket shrinks from both sides.
      const double straight = std::log(rate / low_bits) / std::log(high_bits / low_bits);
      const double middle = std::lerp(low, high, std::clamp(straight, 0.1, 0.9));
      if (std::abs(high - low) < 1e-6) return;
      const std::optional<double> bits = measure({CodingTarget::Kind::setting, std::exp(middle)});
      if (!bits) return;
      (*bits <= rate ? low : high) = middle;
      (*bits <= rate ? low_bits : high_bits) = *bits;
    }
  }

  /// The point whose rate is nearest, with times of as many runs as the plan wants.
  const Measurement& time_nearest(double rate) {
    const auto distance = [&](const Measurement& point) { return std::abs(std::log(point.bits / rate)); };
    Measurement& nearest = *std::min_element(points_.begin(), points_.end(), [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    if (plan_.repeats > 1 && std::find(timed_.begin(), timed_.end(), nearest.target) == timed_.end()) {
      timed_.push_back(nearest.target);
      const Measurement again = measure_codec(codec_, terrain_, nearest.target, plan_.repeats, plan_.threads);
      nearest.encode_s = again.encode_s;
      nearest.decode_s = again.decode_s;
    }
    return nearest;
  }

  const CodecUnderTest& codec_;
  const TestedTerrain& terrain_;
  const TrialPlan& plan_;
  std::vector<Measurement> points_;
  std::vector<CodingTarget> timed_;
};

}  // namespace

std::vector<RatePoint> CodecTrial::points() const {
  std::vector<RatePoint> points;
  for (const Measurement& measurement : curve)
    if (std::isfinite(measurement.psnr_db)) points.push_back({measurement.bits, measurement.psnr_db});
  return points;
}

void compare_cells(const TestedTerrain& terrain, const Raster<float>& decoded, Measurement& measurement) {
  double squares = 0;
  for (std::int64_t y = 0; y < decoded.height(); ++y) {
    double row = 0;
    for (std::int64_t x = 0; x < decoded.width(); ++x) {
      const float truth = terrain.cells(x, y);
      if (is_void(truth)) continue;
      const double error = static_cast<double>(decoded(x, y)) - static_cast<double>(truth);
      row += error * error;
      measurement.max_error_m = std::isfinite(error) ? std::max(measurement.max_error_m, std::abs(error)) : infinity;
    }
    squares += row;
  }
  measurement.rmse_m = std::isfinite(measurement.max_error_m) ? std::sqrt(squares / static_cast<double>(terrain.valid)) : infinity;
  const double peak = static_cast<double>(terrain.high) - static_cast<double>(terrain.low);
  measurement.psnr_db = measurement.rmse_m == 0 ? infinity : 20 * std::log10(peak / measurement.rmse_m);
}

Measurement measure_codec(const CodecUnderTest& codec, const TestedTerrain& terrain, CodingTarget target, int repeats, int threads) {
  Measurement measurement;
  measurement.target = target;
  std::vector<double> encoding, decoding;
  for (int run = 0; run < repeats; ++run) {
    Raster<float> decoded(terrain.cells.width(), terrain.cells.height(), 0.0f);
    Stopwatch watch;
    const std::vector<std::byte> file = codec.encode(terrain, target, threads);
    encoding.push_back(watch.lap());
    codec.decode(file, decoded.view(), threads);
    decoding.push_back(watch.lap());
    if (run > 0) continue;
    measurement.bytes = static_cast<std::int64_t>(file.size());
    measurement.bits = 8 * static_cast<double>(file.size()) / static_cast<double>(decoded.size().cells());
    compare_cells(terrain, decoded, measurement);
  }
  measurement.encode_s = median(encoding);
  measurement.decode_s = median(decoding);
  return measurement;
}

bool kept(const Measurement& measurement) {
  if (measurement.target.kind == CodingTarget::Kind::lossless) return measurement.max_error_m == 0;
  return measurement.target.kind != CodingTarget::Kind::max_error || measurement.max_error_m <= measurement.target.value;
}

std::vector<double> default_bounds(const TestedTerrain& terrain) {
  const double least = std::max((static_cast<double>(terrain.high) - static_cast<double>(terrain.low)) / 5000, terrain.quantum);
  std::vector<double> bounds;
  for (int power = static_cast<int>(std::floor(std::log10(least))) - 1; bounds.size() < 5; ++power)
    for (const int digit : {1, 2, 5}) {
      const double bound = power < 0 ? digit / std::pow(10, -power) : digit * std::pow(10, power);
      // "About": down to 7 tenths, the geometric middle of two such numbers.
      if (bound >= (least > terrain.quantum ? 0.7 : 1 - 1e-9) * least && bound >= terrain.quantum * (1 - 1e-9) && bounds.size() < 5) bounds.push_back(bound);
    }
  return bounds;
}

std::int64_t trial_steps(const TrialPlan& plan) { return static_cast<std::int64_t>(plan.rates.size() + plan.bounds_m.size()) + (plan.lossless ? 1 : 0); }

CodecTrial try_codec(const CodecUnderTest& codec, const TestedTerrain& terrain, const TrialPlan& plan, Progress& progress) {
  CodecTrial trial;
  trial.name = codec.name();
  trial.title = codec.title();
  trial.description = codec.description();
  trial.keeps_voids = codec.keeps_voids();
  Curve curve(codec, terrain, plan);
  for (const double rate : plan.rates) {
    curve.approach(rate);
    progress.advance(1);
  }
  for (const double rate : plan.rates) trial.rates.push_back(curve.read(rate));
  trial.curve = curve.points();
  const auto measure_if_able = [&](CodingTarget target) {
    std::optional<Measurement> made = try_measure(codec, terrain, target, plan.repeats, plan.threads);
    progress.advance(1);
    return made;
  };
  for (const double bound : plan.bounds_m) trial.bounds.push_back(measure_if_able({CodingTarget::Kind::max_error, bound}));
  if (plan.lossless) trial.lossless = measure_if_able({CodingTarget::Kind::lossless, 0});
  return trial;
}

std::optional<double> mean_gain(const CodecTrial& anchor, const CodecTrial& test, double lowest, double highest) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < std::min(anchor.rates.size(), test.rates.size()); ++i) {
    const auto &a = anchor.rates[i], &b = test.rates[i];
    if (!a || !b || a->rate < lowest * (1 - 1e-9) || a->rate > highest * (1 + 1e-9)) continue;
    sum += b->psnr_db - a->psnr_db;
    ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

}  // namespace arete
