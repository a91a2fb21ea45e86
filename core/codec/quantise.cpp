#include "core/codec/quantise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/codec/subband_context.h"
#include "core/codec/trellis.h"

namespace arete {
namespace {

constexpr int square = CoefficientBlock::square;
constexpr int tabled_indices = 18;

// Magnitudes in steps below which a whole square is zero without a search: half a step more than the largest that a
// quantiser with the points 0 and 2 rounds to zero costs more than it saves.
constexpr float dead_magnitude = 1.1F;

// Bits of index k, sign included, in a context of expected magnitude.
struct RateTable {
  float bits[2][band_count][energy_bins][tabled_indices];
};

float information(double p) { return static_cast<float>(-std::log2(p)); }

RateTable make_rate_table() {
  RateTable table;
  const SubbandModels& models = initial_subband_models();
  for (int q = 0; q < 2; ++q)
    for (int band = 0; band < band_count; ++band)
      for (int bin = 0; bin < energy_bins; ++bin) {
        float larger = 0;  // bits of "larger than" so far
        for (int k = 0; k < tabled_indices; ++k) {
          if (k >= unary_steps) {  // two more bits with each doubling
            table.bits[q][band][bin][k] = larger + 2 + 2 * std::log2(static_cast<float>(k - unary_steps + 1));
            continue;
          }
          const double p = std::clamp<double>(models.quantisers[q].energy[band][bin][k].p(), 20, 65516) / 65536;
          table.bits[q][band][bin][k] = larger + information(1 - p) + (k > 0 ? 1 : 0);
          larger += information(p);
        }
      }
  return table;
}

const RateTable& rate_table() {
  static const RateTable table = make_rate_table();
  return table;
}

// What the search keeps of a coefficient: for each quantiser and parity the best index, and for each state which of its
// two predecessors led to it.
struct Step {
  std::int32_t index[2][2];
  std::uint8_t from = 0;
};

struct Predecessor {
  std::uint8_t state;
  std::uint8_t parity;
};

constexpr auto predecessors = [] {
  std::array<std::array<Predecessor, 2>, trellis_states> table{};
  std::array<int, trellis_states> found{};
  for (std::uint8_t s = 0; s < trellis_states; ++s)
    for (std::uint8_t parity = 0; parity < 2; ++parity) {
      const std::uint8_t next = trellis_next[s][parity];
      table[next][static_cast<std::size_t>(found[next]++)] = {s, parity};
    }
  return table;
}();

// The cheapest index of each parity near a magnitude.
void choose_indices(float magnitude, int quantiser, const float* bits, float lambda, std::int32_t (&index)[2], float (&cost)[2]) {
  cost[0] = magnitude * magnitude + lambda * bits[0];
  index[0] = 0;
  cost[1] = std::numeric_limits<float>::max();
  const auto near = static_cast<std::int32_t>((magnitude + static_cast<float>(quantiser)) * 0.5F);
  for (std::int32_t k = std::max(near, 1); k <= near + 1; ++k) {
    const float error = magnitude - static_cast<float>(lattice_point(k, quantiser));
    const float rate = k < tabled_indices ? bits[k] : bits[tabled_indices - 1] + 2 * std::log2(static_cast<float>(k) / (tabled_indices - 1));
    const float j = error * error + lambda * rate;
    if (j < cost[k & 1]) {
      cost[k & 1] = j;
      index[k & 1] = k;
    }
  }
}

class BandSearch {
 public:
  BandSearch(RasterView<const float> values, float lambda, int band) : values_(values), lambda_(lambda), band_(band) {}

  /// Quantises the squares that are on in `block`; `contexts` has the magnitudes that the contexts are made of.
  void run(const NodeCoefficients& contexts, const ParentView& parent, CoefficientBlock& block) {
    steps_.clear();
    costs_.fill(std::numeric_limits<float>::max() / 4);
    costs_[0] = 0;
    RowContext row(block.width());
    for (int y = 0; y < block.height(); ++y)
      visit_runs(block, y / square, [&](Columns columns) {
        prepare_places(contexts, parent, band_, y, columns, row);
        const std::uint8_t* magnitudes = contexts.bands[static_cast<std::size_t>(band_)].magnitudes(y);
        for (int x = columns.first; x < columns.end; ++x) extend(row, magnitudes, x, y);
      });
    trace_back(block);
  }

 private:
  template <class Visit>
  static void visit_row(const CoefficientBlock& block, int y, Visit visit) {
    for (int b = 0; b < block.squares_wide(); ++b)
      if (block.flags(y / square)[b])
        for (int x = b * square; x < std::min((b + 1) * square, block.width()); ++x) visit(x);
  }

  void extend(const RowContext& context, const std::uint8_t* estimate, int x, int y) {
    const int bin = energy_bin_table[expected_magnitude(unpack_place(context.places[static_cast<std::size_t>(x)]), band_, estimate[x - 1], estimate[x - 2])];
    const float value = std::abs(values_(x, y));
    Step step;
    float cost[2][2];
    for (int q = 0; q < 2; ++q) choose_indices(value, q, rate_table().bits[q][band_][bin], lambda_, step.index[q], cost[q]);
    std::array<float, trellis_states> next;
    for (std::size_t t = 0; t < trellis_states; ++t) {
      const Predecessor a = predecessors[t][0], b = predecessors[t][1];
      const float cost_a = costs_[a.state] + cost[quantiser_of(a.state)][a.parity];
      const float cost_b = costs_[b.state] + cost[quantiser_of(b.state)][b.parity];
      next[t] = std::min(cost_a, cost_b);
      if (cost_b < cost_a) step.from = static_cast<std::uint8_t>(step.from | (1U << t));
    }
    // Costs are kept small, so that they keep their precision.
    const float least = *std::min_element(next.begin(), next.end());
    for (std::size_t t = 0; t < trellis_states; ++t) costs_[t] = next[t] - least;
    steps_.push_back(step);
  }

  void trace_back(CoefficientBlock& block) {
    auto state = static_cast<std::size_t>(std::min_element(costs_.begin(), costs_.end()) - costs_.begin());
    indices_.resize(steps_.size());
    for (std::size_t i = steps_.size(); i-- > 0;) {
      const Predecessor before = predecessors[state][(steps_[i].from >> state) & 1U];
      const int quantiser = quantiser_of(before.state);
      indices_[i] = lattice_point(steps_[i].index[quantiser][before.parity], quantiser);
      state = before.state;
    }
    std::size_t i = 0;
    for (int y = 0; y < block.height(); ++y)
      visit_row(block, y, [&](int x) { block.set(x, y, values_(x, y) < 0 ? -indices_[i] : indices_[i]), ++i; });
  }

  RasterView<const float> values_;
  float lambda_;
  int band_;
  std::vector<Step> steps_;
  std::vector<std::int32_t> indices_;
  std::array<float, trellis_states> costs_{};
};

template <class Test>
void switch_squares(CoefficientBlock& block, Test on) {
  for (int y = 0; y < block.squares_high(); ++y)
    for (int x = 0; x < block.squares_wide(); ++x) block.flags(y)[x] = on(x * square, y * square);
}

template <class Test>
bool any_of_square(const CoefficientBlock& block, int x0, int y0, Test test) {
  for (int y = y0; y < std::min(y0 + square, block.height()); ++y)
    for (int x = x0; x < std::min(x0 + square, block.width()); ++x)
      if (test(x, y)) return true;
  return false;
}

// The magnitudes of a plain quantiser, as contexts of the first pass.
CoefficientBlock estimate(RasterView<const float> values) {
  CoefficientBlock block(static_cast<int>(values.width), static_cast<int>(values.height));
  for (int y = 0; y < block.height(); ++y)
    for (int x = 0; x < block.width(); ++x) block.set(x, y, static_cast<std::int32_t>(std::abs(values(x, y)) + 0.3F));
  return block;
}

void clear(CoefficientBlock& block) {
  for (int y = 0; y < block.height(); ++y)
    for (int x = 0; x < block.width(); ++x) block.set(x, y, 0);
}

}  // namespace

NodeCoefficients quantise_node(const std::array<RasterView<const float>, band_count>& bands, const ParentView& parent, float lambda, int passes) {
  NodeCoefficients result, contexts;
  for (std::size_t i = 0; i < band_count; ++i) {
    contexts.bands[i] = estimate(bands[i]);
    CoefficientBlock& block = result.bands[i] = CoefficientBlock(static_cast<int>(bands[i].width), static_cast<int>(bands[i].height));
    switch_squares(block, [&](int x0, int y0) {
      return any_of_square(block, x0, y0, [&](int x, int y) { return std::abs(bands[i](x, y)) > dead_magnitude; });
    });
  }
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t i = 0; i < band_count; ++i) {
      CoefficientBlock& block = result.bands[i];
      if (block.width() == 0 || block.height() == 0) continue;
      BandSearch search(bands[i], lambda, static_cast<int>(i));
      search.run(contexts, parent, block);
      // A square that came out zero costs less when it is off; but the states after it change, hence another search.
      bool switched = false;
      switch_squares(block, [&](int x0, int y0) {
        if (!block.flags(y0 / square)[x0 / square]) return false;
        const bool on = any_of_square(block, x0, y0, [&](int x, int y) { return block.row(y)[x] != 0; });
        switched |= !on;
        return on;
      });
      if (switched) {
        clear(block);
        search.run(contexts, parent, block);
      }
      contexts.bands[i] = block;
    }
  }
  return result;
}

}  // namespace arete
