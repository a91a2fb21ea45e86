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

// Four lanes: the costs of the two quantisers, even and odd index each; or of four states.
using Lanes [[gnu::vector_size(16)]] = float;
using Mask [[gnu::vector_size(16)]] = std::int32_t;

Lanes fill_lanes(float value) { return Lanes{value, value, value, value}; }
Lanes lesser(Lanes a, Lanes b) { return b < a ? b : a; }
Lanes swap_pairs(Lanes v) { return __builtin_shufflevector(v, v, 1, 0, 3, 2); }
Lanes swap_halves(Lanes v) { return __builtin_shufflevector(v, v, 2, 3, 0, 1); }
Lanes twice_even(Lanes v) { return __builtin_shufflevector(v, v, 0, 2, 0, 2); }
Lanes twice_odd(Lanes v) { return __builtin_shufflevector(v, v, 1, 3, 1, 3); }

Lanes least_lane(Lanes v) {
  v = lesser(v, swap_halves(v));
  return lesser(v, swap_pairs(v));
}

std::int32_t any_bits(Mask v) {
  v |= __builtin_shufflevector(v, v, 2, 3, 0, 1);
  return v[0] | v[1];
}

// The index of each parity nearest to a magnitude, from the greatest index whose point is not beyond it.
constexpr std::int32_t index_near(std::int32_t near, int parity) { return parity == 0 ? (near + 1) & ~1 : near | 1; }

// What choosing an index costs beside its distortion, times lambda.
class Prices {
 public:
  static constexpr std::int32_t tabled = tabled_indices - 2;  // of `near`

  Prices(float lambda, int band) : lambda_(lambda), band_(band) {
    for (int bin = 0; bin < energy_bins; ++bin)
      for (int q = 0; q < 2; ++q) {
        const float* bits = rate_table().bits[q][band][bin];
        zero_[bin][2 * q] = lambda * bits[0];
        zero_[bin][2 * q + 1] = std::numeric_limits<float>::max();  // an odd index is not zero
        for (std::int32_t near = 0; near < tabled; ++near)
          for (int parity = 0; parity < 2; ++parity) pairs_[bin][q][near][parity] = lambda * bits[index_near(near, parity)];
      }
  }
  Lanes zero(std::size_t bin) const { return zero_[bin]; }
  /// Of the indices beside near[0] and near[1], of the two quantisers.
  Lanes pairs(std::size_t bin, const std::int32_t (&near)[2]) const {
    if (near[1] < tabled) [[likely]] {
      const float *even = pairs_[bin][0][near[0]], *odd = pairs_[bin][1][near[1]];
      return Lanes{even[0], even[1], odd[0], odd[1]};
    }
    Lanes prices;
    for (int i = 0; i < 4; ++i) prices[i] = lambda_ * bits_of(bin, i / 2, index_near(near[i / 2], i % 2));
    return prices;
  }

 private:
  float bits_of(std::size_t bin, int q, std::int32_t k) const {
    const float* bits = rate_table().bits[q][band_][bin];
    return k < tabled_indices ? bits[k] : bits[tabled_indices - 1] + 2 * std::log2(static_cast<float>(k) / (tabled_indices - 1));
  }
  float lambda_;
  int band_;
  Lanes zero_[energy_bins];
  float pairs_[energy_bins][2][tabled][2];
};

// What the search keeps of a coefficient: the index near its magnitude, and a bit for each lane.
struct Step {
  std::int32_t near;   // of the even multiples
  std::int32_t lanes;  // of both vectors of states: whether the second predecessor led there; of costs: whether the index is not 0
};
constexpr int nonzero_lanes = 8, odd_beyond = 12;  // and the bit by which the index near the odd multiples is greater

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

// Where the two vectors of costs have a state: those that the even multiples lead to, then those of the odd ones, in the order
// in which their predecessors are found by the fewest moves of lanes.
constexpr std::array<std::uint8_t, trellis_states> lane_states{0, 1, 2, 3, 6, 5, 4, 7};
static_assert([] {
  for (std::size_t lane = 0; lane < trellis_states; ++lane)
    if (lane_states[lane_states[lane]] != lane) return false;  // its own inverse
  return true;
}());

class BandSearch {
 public:
  BandSearch(RasterView<const float> values, float lambda, int band) : values_(values), prices_(lambda, band), band_(band) {}

  /// Quantises the squares that are on in `block`; `contexts` has the magnitudes that the contexts are made of.
  void run(const NodeCoefficients& contexts, const ParentView& parent, CoefficientBlock& block) {
    steps_.clear();
    costs_[0] = costs_[1] = fill_lanes(std::numeric_limits<float>::max() / 4);
    costs_[0][0] = 0;
    RowContext row(block.width());
    for (int y = 0; y < block.height(); ++y)
      visit_runs(block, y / square, [&](Columns columns) {
        prepare_places(contexts, parent, band_, y, columns, row);
        extend(row, contexts.bands[static_cast<std::size_t>(band_)].magnitudes(y), columns, values_.row(y));
      });
    trace_back(block);
  }

 private:
  void extend(const RowContext& context, const std::uint8_t* estimate, Columns columns, const float* values) {
    const std::size_t first = steps_.size();
    steps_.resize(first + static_cast<std::size_t>(columns.end - columns.first));
    Step* step = steps_.data() + first;
    Lanes low = costs_[0], high = costs_[1];
    for (int x = columns.first; x < columns.end; ++x, ++step) {
      const PlaceContext place = unpack_place(context.places[static_cast<std::size_t>(x)]);
      const std::size_t bin = energy_bin_table[expected_magnitude(place, band_, estimate[x - 1], estimate[x - 2])];
      const float magnitude = std::abs(values[x]);
      const std::int32_t near[2]{static_cast<std::int32_t>(magnitude * 0.5F), static_cast<std::int32_t>((magnitude + 1) * 0.5F)};
      const Lanes value = fill_lanes(magnitude), error = value - points_near(near);
      const Lanes cost = error * error + prices_.pairs(bin, near), zero = value * value + prices_.zero(bin);
      const Mask nonzero = cost < zero;
      const Lanes costs = nonzero ? cost : zero;
      const Lanes even = __builtin_shufflevector(costs, costs, 0, 0, 1, 1), odd = __builtin_shufflevector(costs, costs, 2, 2, 3, 3);
      // Predecessors as in the table above: {0 4} {2 6} {0 4} {2 6}, then {3 5} {1 7} {3 5} {1 7}.
      const Lanes low_a = twice_even(low) + even, low_b = swap_pairs(twice_even(high)) + swap_halves(even);
      const Lanes high_a = swap_pairs(twice_odd(low)) + odd, high_b = twice_odd(high) + swap_halves(odd);
      const Mask low_from = low_b < low_a, high_from = high_b < high_a;
      low = low_from ? low_b : low_a;
      high = high_from ? high_b : high_a;
      const Mask bits = (low_from & Mask{1, 2, 4, 8}) | (high_from & Mask{16, 32, 64, 128}) | (nonzero & Mask{256, 512, 1024, 2048});
      *step = {near[0], any_bits(bits) | (near[1] - near[0]) << odd_beyond};
      // Costs are kept small, so that they keep their precision.
      if ((x & 7) == 7) {
        const Lanes least = least_lane(lesser(low, high));
        low -= least;
        high -= least;
      }
    }
    costs_[0] = low;
    costs_[1] = high;
  }

  static Lanes points_near(const std::int32_t (&near)[2]) {
    const std::int32_t even = 2 * near[0], odd = 2 * near[1] - 1;
    // One of the two parities has the index itself, the other the next one.
    return __builtin_convertvector(Mask{even + 2 * (near[0] & 1), even + 2 * (~near[0] & 1), odd + 2 * (near[1] & 1), odd + 2 * (~near[1] & 1)}, Lanes);
  }

  void trace_back(CoefficientBlock& block) {
    std::size_t lane = 0;
    for (std::size_t i = 1; i < trellis_states; ++i)
      if (costs_[i / 4][i % 4] < costs_[lane / 4][lane % 4]) lane = i;
    indices_.resize(steps_.size());
    for (std::size_t i = steps_.size(); i-- > 0;) {
      const Step step = steps_[i];
      const Predecessor before = predecessors[lane_states[lane]][(step.lanes >> lane) & 1];
      const int quantiser = quantiser_of(before.state);
      const std::int32_t near = step.near + (quantiser & (step.lanes >> odd_beyond));
      const bool nonzero = (step.lanes >> (nonzero_lanes + 2 * quantiser + before.parity)) & 1;
      indices_[i] = nonzero ? lattice_point(index_near(near, before.parity), quantiser) : 0;
      lane = lane_states[before.state];
    }
    const std::int32_t* next = indices_.data();
    for (int y = 0; y < block.height(); ++y)
      visit_runs(block, y / square, [&](Columns columns) {
        std::int32_t* row = block.row(y);
        for (int x = columns.first; x < columns.end; ++x, ++next) row[x] = values_(x, y) < 0 ? -*next : *next;
        block.hold_magnitudes(y, columns.first, columns.end);
      });
  }

  RasterView<const float> values_;
  Prices prices_;
  int band_;
  std::vector<Step> steps_;
  std::vector<std::int32_t> indices_;
  Lanes costs_[2];
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
      // A square that came out zero costs less when it is off; but the states after it change, hence another search, unless
      // the next pass searches anyway and this one was for its contexts.
      bool switched = false;
      switch_squares(block, [&](int x0, int y0) {
        if (!block.flags(y0 / square)[x0 / square]) return false;
        const bool on = any_of_square(block, x0, y0, [&](int x, int y) { return block.row(y)[x] != 0; });
        switched |= !on;
        return on;
      });
      if (switched && pass + 1 == passes) {
        clear(block);
        search.run(contexts, parent, block);
      }
      contexts.bands[i] = block;
    }
  }
  return result;
}

}  // namespace arete
