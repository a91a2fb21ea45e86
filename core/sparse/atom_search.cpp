// Pruning by the energy of the leading coordinates follows the partial-distance idea of C.-D. Bei and R. M. Gray, IEEE Trans.
// Communications 1985; the tree of boxes is J. H. Friedman, J. L. Bentley and R. A. Finkel, ACM TOMS 1977.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sparse/atom_search.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/sparse/atom_search.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

HWY_BEFORE_NAMESPACE();
namespace arete {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::int64_t kHead = AtomSearch::head;
constexpr std::int64_t kBranch = AtomSearch::branch;
using Floats = hn::CappedTag<float, 16>;
constexpr std::int64_t kLanes = static_cast<std::int64_t>(hn::MaxLanes(Floats()));

struct Candidate {
  float strength;
  std::int64_t position;  // in tree order
};

// The search for one signal, and what it has found so far.
class Search {
 public:
  explicit Search(const AtomSearch::View& tree) : tree_(tree) {}

  // `signal` has unit norm; `heads` are those of the signal and of its negative. `hint` is any position: where to look first.
  void run(const float* signal, const float (&heads)[2][kHead], std::int64_t hint) {
    signal_ = signal;
    best_ = 0;
    candidates_.clear();
    measure(hint);
    for (const auto& head : heads) visit_nearest(head);
    for (const auto& head : heads) visit_level(head, tree_.level_count - 1, 0, tree_.levels[tree_.level_count - 1].groups);
  }

  // Those that may be the strongest, once rounding is allowed for.
  const std::vector<Candidate>& finalists() {
    std::erase_if(candidates_, [&](const Candidate& c) { return c.strength < best_ - tree_.slack; });
    return candidates_;
  }

 private:
  // Squared distances of a head to the boxes of a group; bit i of the result is set where box i may matter.
  HWY_INLINE std::uint32_t distances(const float* head, const AtomSearch::Level& level, std::int64_t group, float* out) const {
    std::uint32_t near = 0;
    const Floats d;
    const float* low = level.low.data() + group * kHead * kBranch;
    const float* high = level.high.data() + group * kHead * kBranch;
    for (std::int64_t i = 0; i < kBranch; i += kLanes) {
      auto sum = hn::Zero(d);
      for (std::int64_t c = 0; c < kHead; ++c) {
        const auto x = hn::Set(d, head[c]);
        const auto below = hn::Sub(hn::LoadU(d, low + c * kBranch + i), x);
        const auto above = hn::Sub(x, hn::LoadU(d, high + c * kBranch + i));
        const auto outside = hn::Max(hn::Max(below, above), hn::Zero(d));
        sum = hn::MulAdd(outside, outside, sum);
      }
      hn::StoreU(sum, d, out + i);
      near |= bits(hn::Le(sum, hn::Set(d, farthest()))) << i;
    }
    return near;
  }

  template <typename Mask>
  HWY_INLINE static std::uint32_t bits(Mask mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(Floats(), mask, bytes);
    return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8;
  }

  float farthest() const { return 2 * (1 - best_ + tree_.slack); }  // squared, that may still matter

  // Greedy descent: a good first answer makes the rest cheap.
  void visit_nearest(const float* head) {
    HWY_ALIGN float distance[kBranch];
    std::int64_t first = 0, count = tree_.levels[tree_.level_count - 1].groups;
    for (int l = tree_.level_count - 1; l >= 0; --l) {
      float least = std::numeric_limits<float>::max();
      std::int64_t nearest = 0;
      for (std::int64_t g = first; g < first + count; ++g) {
        distances(head, tree_.levels[l], g, distance);
        const auto i = std::min_element(distance, distance + kBranch) - distance;
        if (distance[i] < least) {
          least = distance[i];
          nearest = g * kBranch + i;
        }
      }
      first = nearest;
      count = 1;
    }
    visit_leaf(head, first);
  }

  void visit_level(const float* head, int l, std::int64_t first, std::int64_t count) {
    HWY_ALIGN float distance[kBranch];
    for (std::int64_t g = first; g < first + count; ++g) {
      for (std::uint32_t near = distances(head, tree_.levels[l], g, distance); near != 0; near &= near - 1) {
        const std::int64_t i = std::countr_zero(near);
        if (distance[i] > farthest()) continue;  // which has shrunk since
        if (l == 0)
          visit_leaf(head, g * kBranch + i);
        else
          visit_level(head, l - 1, g * kBranch + i, 1);
      }
    }
  }

  void visit_leaf(const float* head, std::int64_t leaf) {
    const Floats d;
    const auto least = hn::Set(d, best_ - tree_.slack);
    std::uint32_t hopeful = 0;
    const float* heads = tree_.heads + leaf * kHead * kBranch;
    for (std::int64_t i = 0; i < kBranch; i += kLanes) {
      auto sum = hn::Zero(d);
      for (std::int64_t c = 0; c < kHead; ++c) sum = hn::MulAdd(hn::Set(d, head[c]), hn::LoadU(d, heads + c * kBranch + i), sum);
      hopeful |= bits(hn::Ge(sum, least)) << i;
    }
    for (; hopeful != 0; hopeful &= hopeful - 1) {
      const std::int64_t position = leaf * kBranch + std::countr_zero(hopeful);
      if (position < tree_.atoms) measure(position);
    }
  }

  // The strength of an atom in full, summed in any order: a finalist is measured again.
  void measure(std::int64_t position) {
    const Floats d;
    const float* atom = tree_.rows + position * tree_.samples;
    auto even = hn::Zero(d), odd = hn::Zero(d);
    std::int64_t k = 0;
    for (; k + 2 * kLanes <= tree_.samples; k += 2 * kLanes) {
      even = hn::MulAdd(hn::LoadU(d, signal_ + k), hn::LoadU(d, atom + k), even);
      odd = hn::MulAdd(hn::LoadU(d, signal_ + k + kLanes), hn::LoadU(d, atom + k + kLanes), odd);
    }
    float sum = hn::GetLane(hn::SumOfLanes(d, hn::Add(even, odd)));
    for (; k < tree_.samples; ++k) sum += signal_[k] * atom[k];
    const float strength = std::abs(sum);
    if (strength < best_ - tree_.slack) return;
    best_ = std::max(best_, strength);
    candidates_.push_back({strength, position});
  }

  const AtomSearch::View& tree_;
  const float* signal_ = nullptr;
  float best_ = 0;
  std::vector<Candidate> candidates_;
};

// The strongest of the finalists by the kernel of correlate(), and its position.
Match decide(const AtomSearch::View& tree, const std::vector<Candidate>& finalists, const float* signal, std::int64_t& position) {
  Match best{std::numeric_limits<std::int32_t>::max(), 0};
  for (const Candidate& candidate : finalists) {
    const Match match{tree.index[candidate.position],
                      correlation(tree.rows + candidate.position * tree.samples, signal, tree.samples)};
    const float a = std::abs(match.correlation), b = std::abs(best.correlation);
    if (a < b || (a == b && match.atom >= best.atom)) continue;
    best = match;
    position = candidate.position;
  }
  return best.correlation == 0 ? Match{} : best;
}

void SearchAll(const AtomSearch::View& tree, const double* basis, const float* signals, std::int64_t count, std::int64_t stride,
               Match* best) {
  Search search(tree);
  std::vector<float> unit(static_cast<std::size_t>(tree.samples));
  std::int64_t position = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    const float* signal = signals + i * stride;
    double square = 0;
    for (std::int64_t k = 0; k < tree.samples; ++k) square += static_cast<double>(signal[k]) * signal[k];
    best[i] = {};
    if (square == 0) continue;
    const double scale = 1 / std::sqrt(square);
    for (std::int64_t k = 0; k < tree.samples; ++k) unit[static_cast<std::size_t>(k)] = static_cast<float>(signal[k] * scale);

    double coordinates[kHead - 1] = {};
    for (std::int64_t k = 0; k < tree.samples; ++k)
      for (std::int64_t c = 0; c < kHead - 1; ++c)
        coordinates[c] += basis[k * (kHead - 1) + c] * unit[static_cast<std::size_t>(k)];
    float heads[2][kHead];
    double rest = 1;
    for (std::int64_t c = 0; c < kHead - 1; ++c) {
      heads[0][c] = static_cast<float>(coordinates[c]);
      heads[1][c] = -heads[0][c];
      rest -= coordinates[c] * coordinates[c];
    }
    heads[0][kHead - 1] = heads[1][kHead - 1] = static_cast<float>(std::sqrt(std::max(0.0, rest)));
    search.run(unit.data(), heads, position);
    best[i] = decide(tree, search.finalists(), signal, position);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace arete
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "core/sparse/main_directions.h"

namespace arete {

HWY_EXPORT(SearchAll);

namespace {

// head x N: the seven coordinates and the norm of the rest.
Eigen::MatrixXf heads_of(const Eigen::Ref<const Eigen::MatrixXf>& D, const Eigen::MatrixXd& basis) {
  Eigen::MatrixXf heads(AtomSearch::head, D.cols());
  for (Eigen::Index j = 0; j < D.cols(); ++j) {
    const Eigen::VectorXd atom = D.col(j).cast<double>();
    const Eigen::VectorXd coordinates = basis * atom;
    heads.col(j).head(AtomSearch::head - 1) = coordinates.cast<float>();
    heads(AtomSearch::head - 1, j) = static_cast<float>(std::sqrt(std::max(0.0, atom.squaredNorm() - coordinates.squaredNorm())));
  }
  return heads;
}

// Orders atoms [begin, end) so that each aligned run of branch^l atoms is a part of a kd-tree: halves at powers of two.
void order_as_tree(const Eigen::MatrixXf& heads, std::vector<std::int32_t>& order, std::int64_t begin, std::int64_t end) {
  const std::int64_t count = end - begin;
  if (count <= AtomSearch::branch) return;
  std::int64_t half = AtomSearch::branch;
  while (2 * half < count) half *= 2;
  Eigen::Array<float, AtomSearch::head, 1> low = heads.col(order[static_cast<std::size_t>(begin)]).array(), high = low;
  for (std::int64_t i = begin; i < end; ++i) {
    const auto head = heads.col(order[static_cast<std::size_t>(i)]).array();
    low = low.min(head);
    high = high.max(head);
  }
  Eigen::Index widest;
  (high - low).maxCoeff(&widest);
  const auto at = [&](std::int64_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(begin + half), at(end), [&](std::int32_t a, std::int32_t b) {
    return std::pair(heads(widest, a), a) < std::pair(heads(widest, b), b);
  });
  order_as_tree(heads, order, begin, begin + half);
  order_as_tree(heads, order, begin + half, end);
}

std::int64_t groups_of(std::int64_t members) { return (members + AtomSearch::branch - 1) / AtomSearch::branch; }

// Where coordinate c of member i stands in arrays that go by groups.
std::size_t place(std::int64_t i, std::int64_t c) {
  constexpr std::int64_t branch = AtomSearch::branch;
  return static_cast<std::size_t>((i / branch * AtomSearch::head + c) * branch + i % branch);
}

constexpr float nowhere = 1e4f;  // coordinate of an absent box: too far from any head to be visited

}  // namespace

AtomSearch::AtomSearch(const Eigen::Ref<const Eigen::MatrixXf>& D)
    : samples_(D.rows()), basis_(main_directions(D, head - 1)), index_(static_cast<std::size_t>(D.cols())) {
  const Eigen::MatrixXf heads = heads_of(D, basis_);
  std::iota(index_.begin(), index_.end(), 0);
  order_as_tree(heads, index_, 0, atoms());
  lay_out(D, heads);
  build_levels();
}

void AtomSearch::lay_out(const Eigen::Ref<const Eigen::MatrixXf>& D, const Eigen::MatrixXf& heads) {
  rows_.resize(static_cast<std::size_t>(atoms() * samples_));
  heads_.assign(static_cast<std::size_t>(groups_of(atoms()) * branch * head), 0.0f);
  for (std::int64_t i = 0; i < atoms(); ++i) {
    const std::int32_t column = index_[static_cast<std::size_t>(i)];
    std::copy_n(D.col(column).data(), samples_, rows_.begin() + i * samples_);
    for (std::int64_t c = 0; c < head; ++c) heads_[place(i, c)] = heads(c, column);
  }
}

void AtomSearch::build_levels() {
  // Level 0 from the heads of the atoms, each other from the one below.
  std::int64_t members = atoms();
  const std::vector<float>* low = &heads_;
  const std::vector<float>* high = &heads_;
  std::vector<Level> levels;
  levels.reserve(16);
  do {
    const std::int64_t boxes = groups_of(members);
    Level level{groups_of(boxes), {}, {}};
    level.low.assign(static_cast<std::size_t>(level.groups * branch * head), nowhere);
    level.high.assign(level.low.size(), nowhere);
    for (std::int64_t i = 0; i < members; ++i)
      for (std::int64_t c = 0; c < head; ++c) {
        const std::size_t to = place(i / branch, c), from = place(i, c);
        const bool first = i % branch == 0;
        level.low[to] = first ? (*low)[from] : std::min(level.low[to], (*low)[from]);
        level.high[to] = first ? (*high)[from] : std::max(level.high[to], (*high)[from]);
      }
    levels.push_back(std::move(level));
    low = &levels.back().low;
    high = &levels.back().high;
    members = boxes;
  } while (members > 4 * branch);
  levels_ = std::move(levels);
}

void AtomSearch::strongest(const float* signals, std::int64_t count, std::int64_t stride, Match* best) const {
  if (atoms() == 0) {
    std::fill_n(best, count, Match{});
    return;
  }
  // A float sum of K products of unit vectors is off by at most K 2^-24; two of them are compared, each by two kernels.
  const float slack = 4e-6f + 4 * static_cast<float>(samples_) * 0x1p-24f;
  const View view{samples_, heads_.data(), rows_.data(), index_.data(), atoms(), levels_.data(), static_cast<int>(levels_.size()), slack};
  HWY_DYNAMIC_DISPATCH(SearchAll)(view, basis_.data(), signals, count, stride, best);
}

}  // namespace arete
#endif
