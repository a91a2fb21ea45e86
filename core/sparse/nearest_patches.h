#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

namespace arete {

/// Finds the patches nearest to a direction, quickly and roughly: an exact k-d tree (FLANN's single tree, which makes no random
/// choice) over the leading coordinates of unit patches. Neglecting the other coordinates is the approximation; rank the
/// answers by what you really want.
class NearestPatches {
 public:
  static constexpr int coordinates = 8;

  /// Indexes the unit columns of `patches` (K x n), n >= 1. Keeps only their leading coordinates.
  explicit NearestPatches(const Eigen::MatrixXf& patches);
  ~NearestPatches();
  NearestPatches(NearestPatches&&) noexcept;
  NearestPatches& operator=(NearestPatches&&) noexcept;

  /// The `count` (or all) columns nearest to `direction`, nearest first.
  std::vector<std::int64_t> find(const Eigen::Ref<const Eigen::VectorXf>& direction, std::int64_t count) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace arete
