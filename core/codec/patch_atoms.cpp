#include "core/codec/patch_atoms.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "core/codec/bit_coding.h"

namespace arete {
namespace {

constexpr int most_shift = 15;
constexpr int bins = 34;  // half octaves of sums of up to three differences

int shift_of(const std::int16_t* atom, std::int64_t samples) {
  unsigned all = 1U << most_shift;
  for (std::int64_t i = 0; i < samples; ++i) all |= static_cast<std::uint16_t>(atom[i]);
  return std::countr_zero(all);
}

// The samples of an atom divided by 2^shift, with a border of zeros: above, and one on either side.
class Grid {
 public:
  explicit Grid(int side) : stride_(side + 2), cells_(static_cast<std::size_t>(stride_ * (side + 1))) {}
  std::int32_t* at(int x, int y) { return &cells_[static_cast<std::size_t>((y + 1) * stride_ + x + 1)]; }
  int stride() const { return stride_; }
  void clear() { std::fill(cells_.begin(), cells_.end(), 0); }

 private:
  int stride_;
  std::vector<std::int32_t> cells_;
};

template <class Bits>
class AtomCoder {
 public:
  AtomCoder(Bits bits, int side) : bits_(bits), side_(side), grid_(side), models_({bins, bins * 4}) {}

  void code(std::int16_t* atom) {
    int shift = shift_of(atom, std::int64_t{side_} * side_), coded = 0;
    for (int b = 3; b >= 0; --b) coded = 2 * coded + bits_((shift >> b) & 1, 1U << 15);
    grid_.clear();
    const std::int32_t most = (1 << (15 - coded)) - 1;
    for (int y = 0; y < side_; ++y)
      for (int x = 0; x < side_; ++x) {
        if (!inside_disc(side_, x, y)) continue;
        std::int16_t& sample = atom[y * side_ + x];
        std::int32_t* cell = grid_.at(x, y);
        *cell = std::clamp(code_sample(sample >> shift, cell), -most, most);
        sample = static_cast<std::int16_t>(*cell * (1 << coded));
      }
  }

 private:
  std::int32_t code_sample(std::int32_t value, const std::int32_t* at) {
    const std::int32_t left = at[-1], up = at[-grid_.stride()], up_left = at[-grid_.stride() - 1], up_right = at[-grid_.stride() + 1];
    const std::int32_t predicted = (3 * (left + up) - 2 * up_left + 2) >> 2;
    const int slope = half_octave(static_cast<std::uint64_t>(std::abs(left - up_left) + std::abs(up - up_left) + std::abs(up - up_right)));
    const int size = half_octave(static_cast<std::uint64_t>(std::abs(left) + std::abs(up)));
    const std::uint32_t number =
        models_.code(bits_, {std::min(slope, bins - 1), 4 * std::min(size, bins - 1) + std::min(slope / 4, 3)}, fold_sign(value - predicted));
    return predicted + unfold_sign(number);
  }

  Bits bits_;
  int side_;
  Grid grid_;
  NumberModels<2> models_;
};

template <class Bits>
void code_atoms(Bits bits, PatchAtoms& atoms) {
  AtomCoder<Bits> coder(bits, atoms.side);
  for (std::int64_t j = 0; j < atoms.count; ++j) coder.code(atoms.samples.data() + j * atoms.side * atoms.side);
}

}  // namespace

std::int64_t least_atom_bytes(int side, std::int64_t count) { return count * (std::int64_t{side} * side / 256 + 1); }

std::vector<std::byte> encode_atoms(const PatchAtoms& atoms) {
  PatchAtoms same = atoms;
  RangeEncoder encoder;
  code_atoms(EncodingBits{encoder}, same);
  std::vector<std::byte> bytes = encoder.finish();
  bytes.resize(std::max(bytes.size(), static_cast<std::size_t>(least_atom_bytes(atoms.side, atoms.count))));
  return bytes;
}

PatchAtoms decode_atoms(std::span<const std::byte> bytes, int side, std::int64_t count) {
  PatchAtoms atoms{side, count, std::vector<std::int16_t>(static_cast<std::size_t>(count * side * side))};
  RangeDecoder decoder(bytes);
  code_atoms(DecodingBits{decoder}, atoms);
  return atoms;
}

}  // namespace arete
