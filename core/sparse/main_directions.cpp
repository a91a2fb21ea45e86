#include "core/sparse/main_directions.h"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

namespace arete {

Eigen::MatrixXd main_directions(const Eigen::Ref<const Eigen::MatrixXf>& F, Eigen::Index count) {
  constexpr Eigen::Index most = 4096;
  constexpr int rounds = 12;
  const Eigen::Index columns = std::min(F.cols(), most), wanted = std::min(count, F.rows());
  Eigen::MatrixXd sample(F.rows(), columns);
  for (Eigen::Index i = 0; i < columns; ++i) sample.col(i) = F.col(i * F.cols() / columns).cast<double>();
  Eigen::MatrixXd directions(F.rows(), wanted);
  for (Eigen::Index c = 0; c < wanted; ++c)
    for (Eigen::Index k = 0; k < F.rows(); ++k) directions(k, c) = std::cos(static_cast<double>((k + 1) * (c + 1)));
  for (int round = 0; round < rounds; ++round) {
    const Eigen::MatrixXd turned = sample * (sample.transpose() * directions);
    directions = Eigen::HouseholderQR<Eigen::MatrixXd>(turned).householderQ() * Eigen::MatrixXd::Identity(F.rows(), wanted);
  }
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(count, F.rows());
  basis.topRows(wanted) = directions.transpose();
  return basis;
}

}  // namespace arete
