#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/sparse/correlate.h"

namespace arete {

/// An exact search for the strongest atom in a large dictionary: the same answers, bit for bit, as strongest_atoms over all atoms.
///
/// Terrain keeps nearly all its energy in a few directions (slopes and curvatures). In an orthonormal basis of the seven main
/// directions of the atoms, x = (x1, x2) and d = (d1, d2), Cauchy-Schwarz gives <x, d> <= <x1, d1> + |x2| |d2|: an inner product of
/// unit vectors with eight coordinates, 1 - half their squared distance. A 16-way tree of boxes over those eight coordinates finds
/// every atom whose bound reaches the best one found; those are measured in full. Bounds are widened by the rounding of
/// float sums; the last few are measured again with the kernel of correlate(). Answers do not depend on how the basis came out.
///
/// Cost: building N K 7 + N log N; a search some tens of boxes and atoms on terrain, up to K N where signals are noise.
class AtomSearch {
 public:
  /// Indexes the unit columns of D (K x N), of which it keeps a copy.
  explicit AtomSearch(const Eigen::Ref<const Eigen::MatrixXf>& D);

  std::int64_t samples() const { return samples_; }
  std::int64_t atoms() const { return static_cast<std::int64_t>(index_.size()); }

  /// As strongest_atoms. Safe to call from several threads.
  void strongest(const float* signals, std::int64_t count, std::int64_t stride, Match* best) const;

  static constexpr std::int64_t head = 8;    ///< coordinates of a bound: seven directions and the norm of the rest
  static constexpr std::int64_t branch = 16; ///< children of a box; atoms of a leaf

  /// What the search kernel sees. Boxes of level 0 hold `branch` atoms; a box of level l + 1 holds `branch` boxes of level l.
  /// Arrays go by groups of `branch`: coordinate c of member i of group g is at (g head + c) branch + i.
  struct Level {
    std::int64_t groups = 0;
    std::vector<float> low;
    std::vector<float> high;
  };
  struct View {
    std::int64_t samples;
    const float* heads;          ///< of the atoms, in groups
    const float* rows;           ///< the atoms, one after another
    const std::int32_t* index;   ///< the column of D of each
    std::int64_t atoms;
    const Level* levels;
    int level_count;
    float slack;                 ///< what rounding may hide
  };

 private:
  void lay_out(const Eigen::Ref<const Eigen::MatrixXf>& D, const Eigen::MatrixXf& heads);
  void build_levels();

  std::int64_t samples_ = 0;
  Eigen::MatrixXd basis_;            // 7 x K, orthonormal rows
  std::vector<std::int32_t> index_;  // tree order -> column of D
  std::vector<float> rows_;
  std::vector<float> heads_;
  std::vector<Level> levels_;
};

}  // namespace arete
