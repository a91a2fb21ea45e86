// M. Muja, D. G. Lowe, "Scalable nearest neighbor algorithms for high dimensional data", IEEE TPAMI 2014: the library FLANN.
#include "core/sparse/nearest_patches.h"

#include <algorithm>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <flann/flann.hpp>
#pragma GCC diagnostic pop

#include "core/sparse/main_directions.h"

namespace arete {

struct NearestPatches::Index {
  Eigen::MatrixXf basis;   // coordinates x K
  Eigen::MatrixXf points;  // coordinates x n: rows of FLANN's matrix are our columns
  std::unique_ptr<flann::KDTreeSingleIndex<flann::L2_Simple<float>>> tree;
};

NearestPatches::NearestPatches(const Eigen::MatrixXf& patches) : index_(std::make_unique<Index>()) {
  index_->basis = main_directions(patches, coordinates).cast<float>();
  index_->points.resize(coordinates, patches.cols());
  for (Eigen::Index i = 0; i < patches.cols(); ++i) index_->points.col(i) = index_->basis * patches.col(i);
  const flann::Matrix<float> points(index_->points.data(), static_cast<std::size_t>(patches.cols()), coordinates);
  index_->tree = std::make_unique<flann::KDTreeSingleIndex<flann::L2_Simple<float>>>(points, flann::KDTreeSingleIndexParams(10));
  index_->tree->buildIndex();
}

NearestPatches::~NearestPatches() = default;
NearestPatches::NearestPatches(NearestPatches&&) noexcept = default;
NearestPatches& NearestPatches::operator=(NearestPatches&&) noexcept = default;

std::vector<std::int64_t> NearestPatches::find(const Eigen::Ref<const Eigen::VectorXf>& direction, std::int64_t count) const {
  Eigen::VectorXf query = index_->basis * direction;
  std::vector<std::vector<int>> found;
  std::vector<std::vector<float>> distances;
  const auto wanted = static_cast<std::size_t>(std::min<std::int64_t>(count, index_->points.cols()));
  flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED);
  parameters.cores = 1;
  index_->tree->knnSearch(flann::Matrix<float>(query.data(), 1, coordinates), found, distances, wanted, parameters);
  return {found.front().begin(), found.front().end()};
}

}  // namespace arete
