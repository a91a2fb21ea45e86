#include "core/codec/patch_discs.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "core/codec/bit_coding.h"
#include "core/codec/patch_weights.h"

namespace arete {
namespace {

constexpr int ranks = 96;         // contexts for the place of an atom in the order of expectation
constexpr int ratio_bins = 16;    // of an expectation against the largest of the disc
constexpr int size_bins = 56;     // half octaves of 28 bits
constexpr int counts = 8;         // terms still to come: 1 to 7, 8 or more
constexpr int moment_bits = 14;

int rank_bin(std::int64_t rank) { return static_cast<int>(rank < 64 ? rank : std::min<std::int64_t>(ranks - 1, 64 + (rank - 64) / 32)); }

int size_bin(std::uint64_t size) { return std::min(half_octave(size), size_bins - 1); }

// All adaptive models of a stream.
struct DiscModels {
  NumberModels<2> mean{{size_bins, size_bins}};
  BitModel fewer[8][9];
  BitModel rank[ranks][counts];
  BitModel ratio[ratio_bins][counts];
  BitModel near[5][ratio_bins / 2];
  std::vector<std::array<BitModel, 4>> atom;
  BitMixer<5> chosen[counts];
  BitModel sign_ratio[ratio_bins];
  BitModel sign_near[3][2];
  BitMixer<2> sign;
  NumberModels<3> magnitude;
  explicit DiscModels(std::int64_t atoms)
      : atom(static_cast<std::size_t>(atoms)), magnitude({size_bins, size_bins, static_cast<int>(atoms)}) {}
};

// What the means around a disc lead to expect of an atom.
struct Expectation {
  std::uint64_t key;  // magnitude above the complement of the atom's index: sorts as wanted
  static constexpr int index_bits = 16;
  std::uint64_t magnitude() const { return key >> index_bits; }
  std::int32_t atom() const { return static_cast<std::int32_t>(0xffffU - (key & 0xffffU)); }
};

template <class Bits>
class BlockCoder {
 public:
  BlockCoder(Bits bits, const PatchParameters& parameters, const AtomMoments& moments, DiscBlock& done)
      : bits_(bits),
        moments_(moments),
        sparsity_(parameters.sparsity),
        atoms_(parameters.atoms.count),
        done_(done),
        models_(atoms_),
        expected_(static_cast<std::size_t>(atoms_)),
        signed_(static_cast<std::size_t>(atoms_)),
        users_(static_cast<std::size_t>(atoms_)),
        leaning_(static_cast<std::size_t>(atoms_)),
        residuals_(done.means.size()) {}

  /// `target` is read where bits are encoded only.
  void code(const DiscBlock& target) {
    wide_ = done_.columns.count();
    high_ = done_.rows.count();
    for (std::int64_t y = 0; y < high_; ++y)
      for (std::int64_t x = 0; x < wide_; ++x) code_mean(target.means[static_cast<std::size_t>(y * wide_ + x)], x, y);
    std::vector<DiscTerm> wanted;
    for (std::int64_t i = 0; i < wide_ * high_; ++i) {
      const bool coded = static_cast<std::size_t>(i + 1) < target.first.size();
      wanted.clear();
      if (coded) wanted.assign(target.terms_of(i).begin(), target.terms_of(i).end());
      code_terms(wanted, i % wide_, i / wide_);
      done_.first.push_back(static_cast<std::uint32_t>(done_.terms.size()));
    }
  }

 private:
  std::int32_t mean(std::int64_t x, std::int64_t y) const {
    return done_.means[static_cast<std::size_t>(std::clamp<std::int64_t>(y, 0, high_ - 1) * wide_ + std::clamp<std::int64_t>(x, 0, wide_ - 1))];
  }

  void code_mean(std::int32_t value, std::int64_t x, std::int64_t y) {
    const std::int32_t left = x > 0 ? mean(x - 1, y) : y > 0 ? mean(x, y - 1) : 0;
    const std::int32_t up = y > 0 ? mean(x, y - 1) : left;
    const std::int32_t up_left = x > 0 && y > 0 ? mean(x - 1, y - 1) : y > 0 ? up : left;
    const std::int32_t up_right = y > 0 ? mean(x + 1, y - 1) : left;
    // Means of overlapping discs are moving averages along both axes: the plane through the neighbours, and what is known of the innovations.
    const std::int64_t innovation = 176 * (residual(x - 1, y) + residual(x, y - 1)) + 121 * residual(x - 1, y - 1);
    const auto predicted = static_cast<std::int32_t>(std::clamp<std::int64_t>(
        std::int64_t{left} + up - up_left + ((innovation + 128) >> 8), -patch_value_limit, patch_value_limit));
    const std::int64_t slope = std::abs(left - up_left) + std::abs(up - up_left) + std::abs(up - up_right);
    const std::int64_t error = std::abs(residual(x - 1, y)) + std::abs(residual(x, y - 1)) + std::abs(residual(x - 1, y - 1)) +
                               std::abs(residual(x + 1, y - 1));
    const std::array<int, 2> contexts{size_bin(static_cast<std::uint64_t>(slope)), size_bin(static_cast<std::uint64_t>(error))};
    const std::int32_t difference = unfold_sign(models_.mean.code(bits_, contexts, fold_sign(value - predicted)));
    const auto i = static_cast<std::size_t>(y * wide_ + x);
    done_.means[i] = std::clamp(predicted + difference, -patch_value_limit, patch_value_limit);
    residuals_[i] = difference;
  }

  std::int64_t residual(std::int64_t x, std::int64_t y) const {
    return x < 0 || y < 0 || x >= wide_ ? 0 : residuals_[static_cast<std::size_t>(y * wide_ + x)];
  }

  // --- the terms of a disc

  void expect_atoms(std::int64_t x, std::int64_t y) {
    const std::int64_t here = mean(x, y);
    const std::int64_t gx = std::int64_t{mean(x + 1, y)} - mean(x - 1, y), gy = std::int64_t{mean(x, y + 1)} - mean(x, y - 1);
    const std::int64_t xx = std::int64_t{mean(x + 1, y)} + mean(x - 1, y) - 2 * here, yy = std::int64_t{mean(x, y + 1)} + mean(x, y - 1) - 2 * here;
    const std::int64_t xy = std::int64_t{mean(x + 1, y + 1)} + mean(x - 1, y - 1) - mean(x + 1, y - 1) - mean(x - 1, y + 1);
    for (std::int64_t j = 0; j < atoms_; ++j) {
      const std::array<std::int32_t, 5>& m = moments_.of[static_cast<std::size_t>(j)];
      const std::int64_t sum = gx * m[0] + gy * m[1] + xx * m[2] + yy * m[3] + xy * m[4];
      signed_[static_cast<std::size_t>(j)] = sum < 0;
      expected_[static_cast<std::size_t>(j)].key =
          (static_cast<std::uint64_t>(std::abs(sum)) << Expectation::index_bits) | (0xffffU - static_cast<std::uint64_t>(j));
    }
    std::sort(expected_.begin(), expected_.end(), [](const Expectation& a, const Expectation& b) { return a.key > b.key; });
  }

  // Marks the atoms of the discs coded already around one.
  void look_around(std::int64_t x, std::int64_t y) {
    for (const std::int32_t j : touched_) users_[static_cast<std::size_t>(j)] = 0, leaning_[static_cast<std::size_t>(j)] = 0;
    touched_.clear();
    neighbours_ = 0;
    std::uint64_t sum = 0;
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}) {
      if (x + dx < 0 || x + dx >= wide_ || y + dy < 0) continue;
      ++neighbours_;
      for (const DiscTerm& term : done_.terms_of((y + dy) * wide_ + x + dx)) {
        const auto j = static_cast<std::size_t>(term.atom);
        if (users_[j] == 0) touched_.push_back(term.atom);
        ++users_[j];
        leaning_[j] = static_cast<std::int8_t>(leaning_[j] + (term.coefficient < 0 ? -1 : 1));
        sum += static_cast<std::uint64_t>(std::abs(term.coefficient));
        ++uses_;
      }
    }
    typical_ = size_bin(uses_ > 0 ? sum / uses_ : 0);
  }

  int code_count(int count) {
    const auto around = neighbours_ > 0 ? static_cast<int>(8 * uses_ / (static_cast<std::uint64_t>(sparsity_) * static_cast<std::uint64_t>(neighbours_))) : 8;
    int c = static_cast<int>(std::min<std::int64_t>(sparsity_, atoms_));
    while (c > 0 && code_modelled(bits_, models_.fewer[std::min(sparsity_ - c, 7)][std::min(around, 8)], count < c)) --c;
    return c;
  }

  void code_terms(const std::vector<DiscTerm>& wanted, std::int64_t x, std::int64_t y) {
    uses_ = 0;
    look_around(x, y);
    int left = code_count(static_cast<int>(wanted.size()));
    if (left == 0) return;
    expect_atoms(x, y);
    const auto begin = static_cast<std::ptrdiff_t>(done_.terms.size());
    for (std::int64_t rank = 0; left > 0; ++rank) {
      const Expectation& expected = expected_[static_cast<std::size_t>(rank)];
      const std::int32_t atom = expected.atom();
      const auto found = std::find_if(wanted.begin(), wanted.end(), [&](const DiscTerm& t) { return t.atom == atom; });
      if (left < atoms_ - rank && !code_choice(expected, rank, left, found != wanted.end())) continue;
      done_.terms.push_back({atom, code_coefficient(expected, found != wanted.end() ? found->coefficient : 1)});
      --left;
    }
    std::sort(done_.terms.begin() + begin, done_.terms.end(), [](const DiscTerm& a, const DiscTerm& b) { return a.atom < b.atom; });
  }

  int ratio_of(const Expectation& expected) const {
    const std::uint64_t most = expected_[0].magnitude();
    return most == 0 ? 0 : static_cast<int>(std::min<std::uint64_t>(ratio_bins - 1, ratio_bins * expected.magnitude() / most));
  }

  int code_choice(const Expectation& expected, std::int64_t rank, int left, int bit) {
    const auto j = static_cast<std::size_t>(expected.atom());
    const int ratio = ratio_of(expected), l = std::min(left, counts) - 1;
    const std::array<BitModel*, 4> models{&models_.rank[rank_bin(rank)][l], &models_.ratio[ratio][l], &models_.near[users_[j]][ratio / 2],
                                          &models_.atom[j][static_cast<std::size_t>(std::min(l, 3))]};
    std::array<int, 5> logits;
    for (std::size_t i = 0; i < 4; ++i) logits[i] = stretch(models[i]->p());
    const auto even = static_cast<Probability>(65536 * std::int64_t{left} / (atoms_ - rank));
    logits[4] = stretch(std::clamp<Probability>(even, 16, 65520));
    BitMixer<5>& mixer = models_.chosen[l];
    const Probability p = mixer.mix(logits);
    bit = bits_(bit, p);
    mixer.update(logits, p, bit, model_mixing_rate);
    for (BitModel* model : models) model->update(bit, model_limit);
    return bit;
  }

  std::int32_t code_coefficient(const Expectation& expected, std::int32_t value) {
    const auto j = static_cast<std::size_t>(expected.atom());
    const int lean = leaning_[j];
    const bool down = signed_[j] != 0;
    const std::array<BitModel*, 2> models{&models_.sign_ratio[ratio_of(expected)], &models_.sign_near[(lean > 0) - (lean < 0) + 1][down]};
    const bool negative = (code_mixed<2>(bits_, models, models_.sign, (value < 0) != down) != 0) != down;
    const std::uint32_t number = models_.magnitude.code(bits_, {size_bin(expected.magnitude() >> 6), typical_, static_cast<int>(j)},
                                                        static_cast<std::uint32_t>(std::abs(value)) - 1);
    const auto magnitude = static_cast<std::int32_t>(std::min<std::uint32_t>(number, patch_value_limit - 1) + 1);
    return negative ? -magnitude : magnitude;
  }

  Bits bits_;
  const AtomMoments& moments_;
  int sparsity_;
  std::int64_t atoms_;
  DiscBlock& done_;
  DiscModels models_;
  std::vector<Expectation> expected_;
  std::vector<std::uint8_t> signed_, users_;
  std::vector<std::int8_t> leaning_;
  std::vector<std::int32_t> residuals_;
  std::vector<std::int32_t> touched_;
  std::int64_t wide_ = 0, high_ = 0;
  int neighbours_ = 0, typical_ = 0;
  std::uint64_t uses_ = 0;
};

}  // namespace

PatchRange discs_of_node(std::int64_t node, std::int64_t cells, int side, int radius) {
  const std::int64_t nodes = (cells + side - 1) / side;
  // Disc k has its centre on the corner before cell k R.
  const auto first = [&](std::int64_t cell) { return (cell + radius - 1) / radius; };
  return {first(node * side), node + 1 < nodes ? first((node + 1) * side) : patches_along(PatchGrid{2 * radius, radius, {}}, cells)};
}

std::int64_t node_of_disc(std::int64_t disc, std::int64_t cells, int side, int radius) { return std::min(disc * radius, cells - 1) / side; }

Size disc_blocks(const NodeGrid& grid) { return grid.levels() == 0 ? Size{1, 1} : grid.nodes(1); }

DiscBlock blank_discs(const PatchParameters& parameters, std::int64_t node_x, std::int64_t node_y) {
  const NodeGrid& grid = parameters.grid;
  DiscBlock block;
  block.columns = discs_of_node(node_x, grid.size().width, grid.side(), parameters.radius);
  block.rows = discs_of_node(node_y, grid.size().height, grid.side(), parameters.radius);
  block.means.resize(static_cast<std::size_t>(block.count()));
  block.first.resize(static_cast<std::size_t>(block.count()) + 1);
  return block;
}

AtomMoments find_moments(const PatchAtoms& atoms) {
  const std::vector<std::int32_t> weights = integer_disc_weights(atoms.side);
  std::vector<std::array<std::int64_t, 5>> sums(static_cast<std::size_t>(atoms.count));
  std::uint64_t most = 0;
  for (std::int64_t j = 0; j < atoms.count; ++j) {
    std::array<std::int64_t, 5>& sum = sums[static_cast<std::size_t>(j)];
    for (int i = 0; i < atoms.side * atoms.side; ++i) {
      const std::int64_t dx = 2 * (i % atoms.side) + 1 - atoms.side, dy = 2 * (i / atoms.side) + 1 - atoms.side;
      const std::int64_t a = std::int64_t{atoms.atom(j)[i]} * weights[static_cast<std::size_t>(i)], m = atoms.side;
      sum[0] += 6 * m * a * dx;
      sum[1] += 6 * m * a * dy;
      sum[2] += 2 * a * (3 * dx * dx - m * m + 1);
      sum[3] += 2 * a * (3 * dy * dy - m * m + 1);
      sum[4] += 3 * a * dx * dy;
    }
    for (const std::int64_t s : sum) most = std::max(most, static_cast<std::uint64_t>(std::abs(s)));
  }
  const int shift = std::max(0, static_cast<int>(std::bit_width(most)) - moment_bits);
  AtomMoments moments;
  for (const auto& sum : sums) {
    std::array<std::int32_t, 5>& m = moments.of.emplace_back();
    for (std::size_t b = 0; b < 5; ++b) m[b] = static_cast<std::int32_t>(sum[b] / (std::int64_t{1} << shift));
  }
  return moments;
}

std::vector<std::byte> encode_discs(const PatchParameters& parameters, const AtomMoments& moments, const DiscBlock& block) {
  const auto zero = [](std::int32_t mean) { return mean == 0; };
  if (block.terms.empty() && std::all_of(block.means.begin(), block.means.end(), zero)) return {};
  DiscBlock done = block;
  done.first.assign(1, 0);
  done.terms.clear();
  RangeEncoder encoder;
  BlockCoder<EncodingBits>(EncodingBits{encoder}, parameters, moments, done).code(block);
  std::vector<std::byte> bytes = encoder.finish();
  if (bytes.empty()) bytes.push_back(std::byte{0});  // no bytes would mean no relief
  return bytes;
}

void decode_discs(const PatchParameters& parameters, const AtomMoments& moments, std::span<const std::byte> bytes, DiscBlock& block) {
  if (bytes.empty()) return;
  block.first.assign(1, 0);
  RangeDecoder decoder(bytes);
  const DiscBlock nothing{block.columns, block.rows, block.means, {}, {}};
  BlockCoder<DecodingBits>(DecodingBits{decoder}, parameters, moments, block).code(nothing);
}

}  // namespace arete
