// Register-blocked products of atoms and signals, after K. Goto and R. van de Geijn, "Anatomy of high-performance matrix
// multiplication", ACM TOMS 2008, without their split of the inner sum: the order of a sum is part of our contract.
// Vectors are kept in arrays, which targets of unknown vector size cannot do.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sparse/correlate.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/sparse/correlate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace arete {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Indices = hn::RebindToSigned<Floats>;
using Vector = hn::Vec<Floats>;

constexpr std::int64_t kPanel = PackedAtoms::panel_atoms;
static_assert(kPanel == 1 << 4);
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Floats()));
constexpr int kVectors = static_cast<int>(kPanel) / kLanes;  // of a panel
constexpr int kSignals = kVectors < 12 ? 12 / kVectors : 1;  // twelve accumulators: all that 16 registers leave

// Signals side by side; the last is repeated where a group is not full.
struct Group {
  const float* signal[kSignals];
};

Group group_at(const float* signals, std::int64_t first, std::int64_t count, std::int64_t stride) {
  Group group;
  for (int s = 0; s < kSignals; ++s) group.signal[s] = signals + std::min(first + s, count - 1) * stride;
  return group;
}

struct Products {
  Vector sum[kSignals][kVectors];
};

HWY_INLINE void multiply(const float* HWY_RESTRICT panel, const Group& group, std::int64_t samples, Products& products) {
  const Floats d;
  for (int s = 0; s < kSignals; ++s)
    for (int v = 0; v < kVectors; ++v) products.sum[s][v] = hn::Zero(d);
  for (std::int64_t k = 0; k < samples; ++k) {
    Vector atom[kVectors];
    for (int v = 0; v < kVectors; ++v) atom[v] = hn::Load(d, panel + k * kPanel + v * kLanes);
    for (int s = 0; s < kSignals; ++s) {
      const Vector value = hn::Set(d, group.signal[s][k]);
      for (int v = 0; v < kVectors; ++v) products.sum[s][v] = hn::MulAdd(value, atom[v], products.sum[s][v]);
    }
  }
}

void Correlate(const PackedAtoms& atoms, const float* signals, std::int64_t count, std::int64_t stride, float* out) {
  const Floats d;
  const std::int64_t row = atoms.padded_atoms();
  for (std::int64_t i = 0; i < count; i += kSignals) {
    const Group group = group_at(signals, i, count, stride);
    const int present = static_cast<int>(std::min<std::int64_t>(kSignals, count - i));
    for (std::int64_t p = 0; p < atoms.panels(); ++p) {
      Products products;
      multiply(atoms.panel(p), group, atoms.samples(), products);
      for (int s = 0; s < present; ++s)
        for (int v = 0; v < kVectors; ++v) hn::StoreU(products.sum[s][v], d, out + (i + s) * row + p * kPanel + v * kLanes);
    }
  }
}

float Correlation(const float* atom, const float* signal, std::int64_t samples) {
  const hn::CappedTag<float, 1> one;
  auto sum = hn::Zero(one);
  for (std::int64_t k = 0; k < samples; ++k) sum = hn::MulAdd(hn::LoadU(one, signal + k), hn::LoadU(one, atom + k), sum);
  return hn::GetLane(sum);
}

// The strongest so far in each lane: the value with its sign, and the panel that it came from.
struct Leader {
  HWY_ALIGN float value[kPanel];
  HWY_ALIGN std::int32_t panel[kPanel];
};

HWY_INLINE void challenge(Leader& leader, int v, Vector value, std::int64_t panel) {
  const Floats d;
  const Indices di;
  const Vector best = hn::Load(d, leader.value + v * kLanes);
  const auto stronger = hn::Gt(hn::Abs(value), hn::Abs(best));
  const auto index = hn::Load(di, leader.panel + v * kLanes);
  hn::Store(hn::IfThenElse(stronger, value, best), d, leader.value + v * kLanes);
  hn::Store(hn::IfThenElse(hn::RebindMask(di, stronger), hn::Set(di, static_cast<std::int32_t>(panel)), index), di,
            leader.panel + v * kLanes);
}

// The strongest of all lanes; of equals the lowest index.
HWY_INLINE Match winner(const Leader& leader) {
  const Floats d;
  const Indices di;
  Vector strength[kVectors];
  Vector most = hn::Zero(d);
  for (int v = 0; v < kVectors; ++v) {
    strength[v] = hn::Abs(hn::Load(d, leader.value + v * kLanes));
    most = hn::Max(most, strength[v]);
  }
  most = hn::MaxOfLanes(d, most);
  auto first = hn::Set(di, INT32_MAX);
  for (int v = 0; v < kVectors; ++v) {
    const auto panel = hn::Load(di, leader.panel + v * kLanes);
    const auto atom = hn::Add(hn::ShiftLeft<4>(panel), hn::Iota(di, static_cast<std::int32_t>(v * kLanes)));
    const auto leads = hn::RebindMask(di, hn::Eq(strength[v], most));
    first = hn::Min(first, hn::IfThenElse(leads, atom, hn::Set(di, INT32_MAX)));
  }
  const std::int32_t atom = hn::GetLane(hn::MinOfLanes(di, first));
  return {atom, leader.value[atom % kPanel]};
}

// Signals of one round over the dictionary: they stay in the first-level cache (24 KiB at K = 64) while a panel passes.
constexpr std::int64_t kRound = 96;

void StrongestAtoms(const PackedAtoms& atoms, const float* signals, std::int64_t count, std::int64_t stride, Match* best) {
  for (std::int64_t first = 0; first < count; first += kRound) {
    const std::int64_t last = std::min(count, first + kRound);
    Leader leaders[kRound] = {};
    for (std::int64_t p = 0; p < atoms.panels(); ++p)
      for (std::int64_t i = first; i < last; i += kSignals) {
        Products products;
        multiply(atoms.panel(p), group_at(signals, i, last, stride), atoms.samples(), products);
        const int present = static_cast<int>(std::min<std::int64_t>(kSignals, last - i));
        for (int s = 0; s < present; ++s)
          for (int v = 0; v < kVectors; ++v) challenge(leaders[i - first + s], v, products.sum[s][v], p);
      }
    for (std::int64_t i = first; i < last; ++i) best[i] = winner(leaders[i - first]);
  }
}

// Keeps the strongest of a sequence of panels in registers.
class Contest {
 public:
  Contest() {
    for (int v = 0; v < kVectors; ++v) {
      best_[v] = hn::Zero(Floats());
      panel_[v] = hn::Zero(Indices());
    }
  }
  HWY_INLINE void add(int v, Vector value, std::int64_t panel) {
    const Indices di;
    const auto stronger = hn::Gt(hn::Abs(value), hn::Abs(best_[v]));
    best_[v] = hn::IfThenElse(stronger, value, best_[v]);
    panel_[v] = hn::IfThenElse(hn::RebindMask(di, stronger), hn::Set(di, static_cast<std::int32_t>(panel)), panel_[v]);
  }
  Match result() const {
    Leader leader;
    for (int v = 0; v < kVectors; ++v) {
      hn::Store(best_[v], Floats(), leader.value + v * kLanes);
      hn::Store(panel_[v], Indices(), leader.panel + v * kLanes);
    }
    return winner(leader);
  }

 private:
  Vector best_[kVectors];
  hn::Vec<Indices> panel_[kVectors];
};

Match SubtractAndFindStrongest(const float* initial, const float* const* columns, const float* factors, std::int64_t terms,
                               std::int64_t count) {
  const Floats d;
  Contest contest;
  for (std::int64_t j = 0; j < count; j += kPanel) {
    Vector value[kVectors];
    for (int v = 0; v < kVectors; ++v) value[v] = hn::LoadU(d, initial + j + v * kLanes);
    for (std::int64_t i = 0; i < terms; ++i) {
      const Vector factor = hn::Set(d, factors[i]);
      for (int v = 0; v < kVectors; ++v)
        value[v] = hn::NegMulAdd(factor, hn::LoadU(d, columns[i] + j + v * kLanes), value[v]);
    }
    for (int v = 0; v < kVectors; ++v) contest.add(v, value[v], j / kPanel);
  }
  return contest.result();
}

}  // namespace HWY_NAMESPACE
}  // namespace arete
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <new>

namespace arete {

HWY_EXPORT(Correlate);
HWY_EXPORT(Correlation);
HWY_EXPORT(StrongestAtoms);
HWY_EXPORT(SubtractAndFindStrongest);

void PackedAtoms::Free::operator()(float* values) const { ::operator delete[](values, std::align_val_t{64}); }

PackedAtoms::PackedAtoms(const Eigen::Ref<const Eigen::MatrixXf>& D) : samples_(D.rows()), atoms_(D.cols()) {
  const std::int64_t count = samples_ * padded_atoms();
  values_.reset(new (std::align_val_t{64}) float[static_cast<std::size_t>(count)]());
  for (std::int64_t j = 0; j < atoms_; ++j) {
    float* to = values_.get() + (j / panel_atoms) * samples_ * panel_atoms + j % panel_atoms;
    for (std::int64_t k = 0; k < samples_; ++k) to[k * panel_atoms] = D(k, j);
  }
}

void correlate(const PackedAtoms& atoms, const float* signals, std::int64_t count, std::int64_t stride, float* out) {
  HWY_DYNAMIC_DISPATCH(Correlate)(atoms, signals, count, stride, out);
}

float correlation(const float* atom, const float* signal, std::int64_t samples) {
  return HWY_DYNAMIC_DISPATCH(Correlation)(atom, signal, samples);
}

void strongest_atoms(const PackedAtoms& atoms, const float* signals, std::int64_t count, std::int64_t stride, Match* best) {
  HWY_DYNAMIC_DISPATCH(StrongestAtoms)(atoms, signals, count, stride, best);
}

Match strongest(const float* correlations, std::int64_t count) {
  return subtract_and_find_strongest(correlations, nullptr, nullptr, 0, count);
}

Match subtract_and_find_strongest(const float* initial, const float* const* columns, const float* factors, std::int64_t terms,
                                  std::int64_t count) {
  return HWY_DYNAMIC_DISPATCH(SubtractAndFindStrongest)(initial, columns, factors, terms, count);
}

}  // namespace arete
#endif
