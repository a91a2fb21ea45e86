#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/codec/node_grid.h"
#include "core/sparse/patch_grid.h"

namespace arete {

// What a decoder of the paper's profile knows beside the streams of discs. Bytes: core/codec/patch-format.md.

/// Atoms as integers. A sample is worth 2^-15 of its value; an atom is weighted by the disc and has a norm of about 1.
struct PatchAtoms {
  int side = 0;                      ///< m, twice the radius
  std::int64_t count = 0;            ///< N
  std::vector<std::int16_t> samples;  ///< [atom][row][column]; 0 outside the disc
  const std::int16_t* atom(std::int64_t j) const { return samples.data() + j * side * side; }
};

struct PatchParameters {
  NodeGrid grid;
  int radius = 7;     ///< R in cells, which is the pitch too
  int sparsity = 1;   ///< s, the most coefficients of a disc
  float base = 0;     ///< metres; means are relative to it
  float mean_quantum = 1;         ///< metres
  float coefficient_quantum = 1;  ///< metres of an atom of norm 1
  PatchAtoms atoms;
  std::string dictionary;  ///< digest of the dictionary file that holds the atoms (dictionary_digest); empty: they are embedded

  PatchGrid patch_grid() const { return make_patch_grid(2 * radius, radius); }
};

inline constexpr int least_patch_radius = 2;
inline constexpr int greatest_patch_radius = 32;  ///< so that a disc lies in no more than two nodes along each axis
inline constexpr int most_patch_sparsity = 64;
inline constexpr std::int64_t most_patch_atoms = 65535;
inline constexpr std::int32_t patch_value_limit = (1 << 25) - 1;  ///< of the magnitudes of means and coefficients, in quanta

/// The nearest integers to the samples of the columns of `low` (m^2 x N), those outside the disc 0. The same on every machine.
PatchAtoms round_atoms(const Eigen::MatrixXf& low);

/// Whether a sample of a patch lies inside the disc, and how many of the m x m do.
bool inside_disc(int side, int x, int y);
std::int64_t disc_samples(int side);

/// Gives the atoms (`Dictionary::low`) of a dictionary by its digest, or throws. May be empty: then named dictionaries are refused.
using DictionaryFinder = std::function<Eigen::MatrixXf(const std::string& digest)>;

/// The digest of the dictionary that parameters name, without looking for it; empty where they hold the atoms, or end early.
std::string named_dictionary(std::span<const std::byte> parameters);

std::vector<std::byte> serialise_patch_parameters(const PatchParameters& parameters);

/// The inverse. Safe for untrusted bytes: memory stays below 512 times their number, beside the dictionary that `find` gives.
/// `name` stands for the file in messages. Throws Error{damaged} where the bytes break a rule, Error{input} where the dictionary found
/// is not the one described, and what `find` throws.
PatchParameters parse_patch_parameters(std::span<const std::byte> bytes, const std::string& name, const NodeGrid& grid, const DictionaryFinder& find);

/// The paper's measure of compactness: values stored per cell.
struct ValueRatio {
  double printed = 0;   ///< t(s, N) = K N + n (2 s + 2) + 1, the formula as printed
  double tabulated = 0;  ///< K N + 2 s n, the count that the paper's table follows
};
ValueRatio value_ratio(std::int64_t atoms, std::int64_t atom_samples, std::int64_t discs, int sparsity, std::int64_t cells);

}  // namespace arete
