#pragma once

#include <cstdint>
#include <memory>

#include <Eigen/Core>

namespace arete {

/// Atoms laid out for the correlation kernel: panels of 16 atoms, sample by sample (panel p holds sample k of atoms 16 p ... 16 p + 15
/// together), the last panel filled up with zeros; 64-byte aligned.
class PackedAtoms {
 public:
  static constexpr std::int64_t panel_atoms = 16;

  PackedAtoms() = default;
  /// Packs the columns of D (K x N).
  explicit PackedAtoms(const Eigen::Ref<const Eigen::MatrixXf>& D);

  std::int64_t samples() const { return samples_; }                                ///< K
  std::int64_t atoms() const { return atoms_; }                                    ///< N
  std::int64_t panels() const { return (atoms_ + panel_atoms - 1) / panel_atoms; }
  std::int64_t padded_atoms() const { return panels() * panel_atoms; }             ///< N, up to a multiple of 16
  const float* panel(std::int64_t p) const { return values_.get() + p * samples_ * panel_atoms; }

 private:
  struct Free {
    void operator()(float* values) const;
  };
  std::unique_ptr<float[], Free> values_;
  std::int64_t samples_ = 0;
  std::int64_t atoms_ = 0;
};

// All sums run over the samples in order, k = 0, 1, ..., one accumulator per (atom, signal), with fused multiply-add where the machine
// has it. The correlation of a signal with an atom is therefore the same bits wherever the signal stands in a batch,
// whatever function computes it, and for any number of threads. (A machine without FMA may differ in the last bits.)

/// out[i * padded_atoms + j] = <signal i, atom j>, for `count` signals `stride` floats apart. 2 K N count flops.
void correlate(const PackedAtoms& atoms, const float* signals, std::int64_t count, std::int64_t stride, float* out);

/// The correlation of one signal with one atom, both `samples` floats in a row.
float correlation(const float* atom, const float* signal, std::int64_t samples);

/// An atom and its correlation with a signal.
struct Match {
  std::int32_t atom = 0;
  float correlation = 0;
};

/// best[i] = the atom of the largest |<signal i, atom>|; of equals the lowest index. The correlations are not stored.
/// A signal that is orthogonal to every atom gets {0, 0}.
void strongest_atoms(const PackedAtoms& atoms, const float* signals, std::int64_t count, std::int64_t stride, Match* best);

/// The largest |correlations[j]| of `count` (a multiple of 16); of equals the lowest index.
Match strongest(const float* correlations, std::int64_t count);

/// The strongest, as above, of initial - sum over i < terms of factors[i] columns[i], all of `count` values (a multiple of 16):
/// the step of Batch-OMP. The differences are not stored.
Match subtract_and_find_strongest(const float* initial, const float* const* columns, const float* factors, std::int64_t terms,
                                  std::int64_t count);

}  // namespace arete
