#include "core/codec/predict_training.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/codec/predict_pass.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

// Sums of weighted products, the lower triangle of a symmetric system.
template <int size>
struct NormalEquations {
  double matrix[size][size] = {};
  double right[size] = {};
  std::int64_t count = 0;

  void add(const double* row, double target, double weight, int used) {
    for (int i = 0; i < used; ++i) {
      const double scaled = row[i] * weight;
      for (int j = 0; j <= i; ++j) matrix[i][j] += scaled * row[j];
      right[i] += scaled * target;
    }
    ++count;
  }
  void add(const NormalEquations& other) {
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j <= i; ++j) matrix[i][j] += other.matrix[i][j];
      right[i] += other.right[i];
    }
    count += other.count;
  }
  // Cholesky, slightly damped so that constant terrain has a solution. False where there is none.
  bool solve(int used, double damping, double* x) const {
    double lower[size][size];
    for (int i = 0; i < used; ++i)
      for (int j = 0; j <= i; ++j) {
        double s = i == j ? matrix[i][i] * (1 + damping) + 1e-3 : matrix[i][j];
        for (int k = 0; k < j; ++k) s -= lower[i][k] * lower[j][k];
        if (i == j && !(s > 0)) return false;
        lower[i][j] = i == j ? std::sqrt(s) : s / lower[j][j];
      }
    for (int i = 0; i < used; ++i) {
      x[i] = right[i];
      for (int k = 0; k < i; ++k) x[i] -= lower[i][k] * x[k];
      x[i] /= lower[i][i];
    }
    for (int i = used - 1; i >= 0; --i) {
      for (int k = i + 1; k < used; ++k) x[i] -= lower[k][i] * x[k];
      x[i] /= lower[i][i];
    }
    return true;
  }
};

constexpr int free_taps = filter_pairs - 1;
using TapEquations = NormalEquations<free_taps>;
using RecursionEquations = NormalEquations<recursion_taps>;

// A residual and what its magnitude may be expected from: feature 0 is 1.
struct ActivitySample {
  std::array<float, activity_weights + 1> features;
  float magnitude;
};

struct BlockState {
  NodePlanes planes;
  RasterView<const std::int32_t> truth;
  TapEquations taps;
  RecursionEquations recursion;
  std::vector<ActivitySample> samples;
};

const std::int32_t* truth_row(const BlockState& block, int phase, int y) {
  return block.truth.row(2 * y + odd_y(phase)) + odd_x(phase);
}

// All taps sum to 1, so that the unknowns weigh differences from the first pair. Cells on rough ground count for less: their
// residuals are large whatever the filter.
void gather_taps(BlockState& block, int phase, std::int32_t step) {
  const auto p = static_cast<std::size_t>(phase);
  const int pairs = pair_count[p - 1];
  block.taps = {};
  for (int y = 0; y < coded_height(block.planes, phase); ++y) {
    const std::int32_t* a[filter_pairs];
    const std::int32_t* b[filter_pairs];
    for (int i = 0; i < pairs; ++i) {
      const TapPair pair = tap_pairs[p - 1][static_cast<std::size_t>(i)];
      const PlaneOffset ahead = locate(phase, pair.dx, pair.dy), behind = locate(phase, -pair.dx, -pair.dy);
      a[i] = block.planes.values[static_cast<std::size_t>(ahead.phase)].row(y + ahead.dy) + ahead.dx;
      b[i] = block.planes.values[static_cast<std::size_t>(behind.phase)].row(y + behind.dy) + behind.dx;
    }
    const std::int32_t* wanted = truth_row(block, phase, y);
    const std::uint8_t* voids = block.planes.any_void ? block.planes.voids[p].row(y) : nullptr;
    for (int x = 0; x < coded_width(block.planes, phase); ++x) {
      if (voids != nullptr && voids[x] != 0) continue;
      double sums[filter_pairs] = {}, roughness = 0;
      for (int i = 0; i < pairs; ++i) {
        const double u = a[i][x], v = b[i][x];
        sums[i] = u + v;
        if (i < 4) roughness += std::fabs(u - v) + 0.5 * std::fabs(sums[i] - sums[0]);
      }
      for (int i = 1; i < pairs; ++i) sums[i] -= sums[0];
      block.taps.add(sums + 1, wanted[2 * x] - 0.5 * sums[0], 1 / (roughness / 8 + 0.5 * step), pairs - 1);
    }
  }
}

// Decodes a phase as the decoder will, gathering what the recursion (first) or the activity (then) is fitted to.
template <typename Sum>
void run_phase(BlockState& block, int phase, const PredictParameters& file, const PhaseParameters& parameters, std::int32_t step,
               bool gather_activity, int sample_every) {
  const auto p = static_cast<std::size_t>(phase);
  NodePlanes& planes = block.planes;
  PhaseRows<Sum> rows(planes.width);
  block.recursion = {};
  block.samples.clear();
  int countdown = sample_every / 2;
  for (int y = -phase_margin[p]; y < planes.height + phase_margin[p]; ++y) {
    filter_row(planes, phase, y, file, parameters, rows.filtered_row());
    if (y < 0 || y >= coded_height(planes, phase)) continue;
    rows.next_row();
    std::int32_t* values = planes.values[p].row(y);
    std::int32_t* magnitudes = planes.magnitudes[p].row(y);
    const std::int32_t* wanted = truth_row(block, phase, y);
    const std::uint8_t* voids = planes.any_void ? planes.voids[p].row(y) : nullptr;
    for (int x = 0; x < coded_width(planes, phase); ++x) {
      magnitudes[x] = 0;
      if (voids != nullptr && voids[x] != 0) continue;
      const std::int32_t prediction = predict_cell(rows, x, file, parameters).value;
      const std::int64_t index = residual_steps(wanted[2 * x], prediction, step);
      if (!gather_activity) {
        const Sum* here = rows.residual_row();
        const Sum* above = rows.residual_row_above();
        const double around[recursion_taps] = {static_cast<double>(here[x - 1]), static_cast<double>(above[x]),
                                               static_cast<double>(above[x - 1]), static_cast<double>(above[x + 1])};
        const double size = std::fabs(around[0]) + std::fabs(around[1]) + std::fabs(around[2]) + std::fabs(around[3]);
        block.recursion.add(around, wanted[2 * x] * 16.0 - static_cast<double>(rows.filtered_row()[x]), 1 / (size + 16.0 * step),
                            recursion_taps);
      } else if (--countdown < 0) {
        countdown = sample_every - 1;
        const auto features = activity_features(planes, phase, x, y, rows.filtered_row()[x]);
        ActivitySample sample{};
        sample.features[0] = 1;
        for (std::size_t i = 0; i < features.size(); ++i) sample.features[i + 1] = static_cast<float>(features[i]);
        sample.magnitude = static_cast<float>(std::min<double>(std::fabs(static_cast<double>(index)) * step, magnitude_limit));
        block.samples.push_back(sample);
      }
      keep_cell(rows, x, add_steps(prediction, index, step, file), index, step, values, magnitudes);
    }
  }
}

void fit_taps(const TapEquations& equations, int phase, const LevelParameters& before, PhaseParameters& out) {
  const int pairs = pair_count[static_cast<std::size_t>(phase - 1)];
  const auto& start = before.phases[static_cast<std::size_t>(phase - 1)].taps;
  out.taps = start;
  double solved[free_taps];
  if (equations.count < 40 * pairs || !equations.solve(pairs - 1, 1e-5, solved)) return;
  std::int32_t sum = 0, magnitudes = 0;
  PhaseParameters fitted;
  for (int i = 1; i < pairs; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double grains = (solved[i - 1] * 4096 - start[k]) / tap_grain;
    if (!(std::fabs(grains) < 4096)) return;
    fitted.taps[k] = start[k] + static_cast<std::int32_t>(std::lround(grains)) * tap_grain;
    sum += fitted.taps[k];
  }
  fitted.taps[0] = 2048 - sum;
  for (std::int32_t tap : fitted.taps) magnitudes += std::abs(tap);
  if (magnitudes <= 8191) out.taps = fitted.taps;
}

// Where residuals are mostly zero a recursion that nearly sums to 1 lets the prediction drift: it is held to half.
void fit_recursion(const RecursionEquations& equations, PhaseParameters& out) {
  double solved[recursion_taps];
  out.recursion = {};
  if (equations.count < 400 || !equations.solve(recursion_taps, 1e-4, solved)) return;
  double magnitudes = 0;
  for (double weight : solved) magnitudes += std::fabs(weight);
  const double scale = magnitudes > 0.5 ? 0.5 / magnitudes : 1;
  for (std::size_t i = 0; i < recursion_taps; ++i)
    out.recursion[i] = static_cast<std::int32_t>(std::lround(solved[i] * scale * 256 / recursion_grain)) * recursion_grain;
}

// The scale that fits best, by quasi-likelihood: weighted least squares with weights 1 / expected^2, iterated; no weight below 0.
void fit_activity(const std::vector<const std::vector<ActivitySample>*>& parts, std::int32_t step, const PhaseParameters& fallback,
                  PhaseParameters& out) {
  constexpr int size = activity_weights + 1;
  std::int64_t count = 0;
  double mean = 0;
  for (const auto* part : parts)
    for (const ActivitySample& s : *part) mean += s.magnitude, ++count;
  mean = count > 0 ? mean / static_cast<double>(count) : step;
  double weights[size] = {};
  const bool enough = count >= 200;
  if (!enough)
    for (int i = 1; i < size; ++i) weights[i] = fallback.activity[static_cast<std::size_t>(i - 1)] / 256.0;
  const double least = 0.02 * step;
  for (int round = 0; round < 5; ++round) {
    NormalEquations<size> equations;
    for (const auto* part : parts)
      for (const ActivitySample& s : *part) {
        double row[size], expected = least;
        for (int i = 0; i < size; ++i) row[i] = s.features[static_cast<std::size_t>(i)];
        if (round == 0)
          expected += mean + 0.5 * row[6] + row[1];
        else
          for (int i = 0; i < size; ++i) expected += weights[i] * row[i];
        equations.add(row, s.magnitude, 1 / (expected * expected), size);
      }
    // coordinate descent on the non-negative quadrant; only the noise where samples are few
    for (int sweep = 0; sweep < 200; ++sweep)
      for (int i = 0; i < (enough ? size : 1); ++i) {
        double s = equations.right[i];
        for (int j = 0; j < size; ++j)
          if (j != i) s -= (i > j ? equations.matrix[i][j] : equations.matrix[j][i]) * weights[j];
        weights[i] = std::max(0.0, s / (equations.matrix[i][i] + 1e-12));
      }
  }
  for (int i = 1; i < size; ++i)
    out.activity[static_cast<std::size_t>(i - 1)] = static_cast<std::uint8_t>(std::lround(std::min(255.0, weights[i] * 256)));
  const double floor = (weights[0] + least) * 256;
  out.noise = 0;
  while (out.noise < 119 && noise_floor(out.noise + 1) <= floor) ++out.noise;
}

}  // namespace

LevelParameters estimate_level(std::span<const TrainingBlock> blocks, const PredictParameters& file, std::int32_t step,
                               const LevelParameters& fallback, int threads) {
  LevelParameters level;
  level.step = step;
  std::vector<BlockState> states(blocks.size());
  const auto for_each = [&](const auto& body) {
    parallel_for(static_cast<std::int64_t>(states.size()), threads, [&](std::int64_t i) { body(states[static_cast<std::size_t>(i)]); });
  };
  std::int64_t cells = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    states[i].planes = make_planes(blocks[i].coarse, blocks[i].cells, blocks[i].truth.voids, file);
    states[i].truth = blocks[i].truth.values;
    cells += blocks[i].cells.size().cells() / 4;
  }
  const int sample_every = static_cast<int>(std::max<std::int64_t>(1, cells / 40000));
  for (int phase = 1; phase < 4; ++phase) {
    const auto p = static_cast<std::size_t>(phase - 1);
    PhaseParameters& parameters = level.phases[p];
    const auto run = [&](bool gather_activity) {
      for_each([&](BlockState& block) {
        if (file.narrow())
          run_phase<std::int32_t>(block, phase, file, parameters, step, gather_activity, sample_every);
        else
          run_phase<std::int64_t>(block, phase, file, parameters, step, gather_activity, sample_every);
      });
    };
    for_each([&](BlockState& block) { gather_taps(block, phase, step); });
    TapEquations taps;
    for (const BlockState& block : states) taps.add(block.taps);
    fit_taps(taps, phase, fallback, parameters);
    run(false);
    RecursionEquations recursion;
    for (const BlockState& block : states) recursion.add(block.recursion);
    fit_recursion(recursion, parameters);
    run(true);
    std::vector<const std::vector<ActivitySample>*> samples;
    for (const BlockState& block : states) samples.push_back(&block.samples);
    fit_activity(samples, step, fallback.phases[p], parameters);
  }
  return level;
}

}  // namespace arete
