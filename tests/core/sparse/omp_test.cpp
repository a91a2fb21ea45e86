#include "core/sparse/omp.h"

#include <cmath>
#include <set>
#include <vector>

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/core/sparse/random_matrix.h"

namespace arete {
namespace {

// Orthogonal matching pursuit as the textbook has it, in double, with a QR solution after each choice.
struct TextbookCode {
  std::vector<int> atoms;
  Eigen::VectorXd coefficients;
};
TextbookCode textbook_omp(const Eigen::MatrixXd& D, const Eigen::VectorXd& f, int sparsity) {
  TextbookCode code;
  Eigen::VectorXd residual = f;
  for (int t = 0; t < sparsity; ++t) {
    Eigen::Index best;
    (D.transpose() * residual).cwiseAbs().maxCoeff(&best);
    code.atoms.push_back(static_cast<int>(best));
    Eigen::MatrixXd chosen(D.rows(), t + 1);
    for (int i = 0; i <= t; ++i) chosen.col(i) = D.col(code.atoms[i]);
    code.coefficients = chosen.colPivHouseholderQr().solve(f);
    residual = f - chosen * code.coefficients;
  }
  return code;
}

void expect_textbook(const Eigen::MatrixXf& D, const Eigen::MatrixXf& F, int sparsity) {
  const SparseCodes codes = omp(prepare_coding(D, sparsity), F, sparsity);
  for (std::int64_t i = 0; i < F.cols(); ++i) {
    const TextbookCode expected = textbook_omp(D.cast<double>(), F.col(i).cast<double>(), sparsity);
    for (int t = 0; t < sparsity; ++t) {
      ASSERT_EQ(codes.atoms(t, i), expected.atoms[t]) << "signal " << i << " choice " << t;
      EXPECT_NEAR(codes.coefficients(t, i), expected.coefficients[t], 2e-4) << "signal " << i << " choice " << t;
    }
  }
}

TEST(Omp, AgreesWithTheTextbookInDouble) {
  const Eigen::MatrixXf D = random_dictionary(64, 128, 5), F = random_matrix(64, 200, 6);
  for (const int sparsity : {1, 2, 3, 8}) expect_textbook(D, F, sparsity);
}

TEST(Omp, AgreesWithTheTextbookWithoutAGramMatrix) {
  const Eigen::MatrixXf D = random_dictionary(30, most_gram_atoms + 5, 7), F = random_matrix(30, 20, 8);
  expect_textbook(D, F, 4);
}

TEST(Omp, ResidualIsOrthogonalToTheChosenAtoms) {
  // Random walks: neighbouring samples agree, as in terrain, so atoms are far from orthogonal.
  Eigen::MatrixXf D = random_matrix(64, 128, 9), F = random_matrix(64, 300, 10);
  for (std::int64_t k = 1; k < 64; ++k) {
    D.row(k) += D.row(k - 1);
    F.row(k) += F.row(k - 1);
  }
  D = D.colwise().normalized().eval();
  for (const int sparsity : {1, 2, 8}) {
    const SparseCodes codes = omp(prepare_coding(D, sparsity), F, sparsity);
    const Eigen::MatrixXf residual = F - decode(D, codes);
    for (std::int64_t i = 0; i < F.cols(); ++i)
      for (int t = 0; t < sparsity && codes.atoms(t, i) >= 0; ++t)
        EXPECT_LT(std::abs(residual.col(i).dot(D.col(codes.atoms(t, i)))), 1e-5 * F.col(i).norm()) << i << ' ' << t;
  }
}

TEST(Omp, ResidualNeverGrowsWithSparsity) {
  const Eigen::MatrixXf D = random_dictionary(40, 90, 11), F = random_matrix(40, 100, 12);
  Eigen::VectorXd before = F.cast<double>().colwise().squaredNorm();
  for (int sparsity = 1; sparsity <= 40; ++sparsity) {
    const SparseCodes codes = omp(prepare_coding(D, sparsity), F, sparsity);
    const Eigen::VectorXd now = squared_residuals(F, D, codes);
    for (std::int64_t i = 0; i < F.cols(); ++i) EXPECT_LE(now[i], before[i] * (1 + 1e-6) + 1e-9) << sparsity << ' ' << i;
    before = now;
  }
}

TEST(Omp, NeverChoosesAnAtomTwice) {
  const Eigen::MatrixXf D = random_dictionary(16, 40, 13), F = random_matrix(16, 100, 14);
  const SparseCodes codes = omp(prepare_coding(D, 30), F, 30);  // more atoms than dimensions: must stop by itself
  for (std::int64_t i = 0; i < F.cols(); ++i) {
    std::set<int> chosen;
    bool ended = false;
    for (int t = 0; t < 30; ++t) {
      const int atom = codes.atoms(t, i);
      if (atom < 0) ended = true;
      if (ended) {
        EXPECT_EQ(atom, -1);
      } else {
        EXPECT_TRUE(chosen.insert(atom).second);
      }
    }
    EXPECT_TRUE(ended);
  }
}

TEST(Omp, RecoversSparseSignalsOfAnOrthonormalDictionary) {
  const Eigen::MatrixXd square = random_matrix(64, 64, 15).cast<double>();
  const Eigen::MatrixXd basis = Eigen::HouseholderQR<Eigen::MatrixXd>(square).householderQ();
  const Eigen::MatrixXf D = basis.cast<float>();
  for (int i = 0; i < 50; ++i) {
    Eigen::VectorXf truth = Eigen::VectorXf::Zero(64);
    for (int t = 0; t < 5; ++t)
      truth[static_cast<Eigen::Index>(uniform_at(16, i, t) * 64)] = static_cast<float>(1 + uniform_at(17, i, t)) * (t % 2 ? 1.f : -1.f);
    const SparseCodes codes = omp(prepare_coding(D, 5), D * truth, 5);
    Eigen::VectorXf found = Eigen::VectorXf::Zero(64);
    for (int t = 0; t < 5; ++t)
      if (codes.atoms(t, 0) >= 0) found[codes.atoms(t, 0)] = codes.coefficients(t, 0);
    EXPECT_LT((found - truth).cwiseAbs().maxCoeff(), 1e-5);
  }
}

TEST(Omp, CodeDoesNotDependOnPositionOrThreads) {
  const Eigen::MatrixXf F = random_matrix(64, 1003, 18);
  for (const int atoms : {128, static_cast<int>(most_gram_atoms) + 3})
    for (const int sparsity : {1, 4}) {
      const CodingDictionary dictionary = prepare_coding(random_dictionary(64, atoms, 19), sparsity);
      const SparseCodes all = omp(dictionary, F, sparsity, 1);
      const SparseCodes threaded = omp(dictionary, F, sparsity, 2);
      EXPECT_EQ(all.atoms, threaded.atoms);
      EXPECT_EQ(all.coefficients, threaded.coefficients);
      for (const std::int64_t i : {0, 1, 5, 95, 96, 500, 1002}) {
        const SparseCodes alone = omp(dictionary, F.col(i), sparsity);
        EXPECT_EQ(alone.atoms.col(0), all.atoms.col(i));
        EXPECT_EQ(alone.coefficients.col(0), all.coefficients.col(i));
      }
    }
}

TEST(Omp, CompleteDictionaryFindsEachSignalItself) {
  const Eigen::MatrixXf F = random_matrix(16, 200, 20);
  const Eigen::MatrixXf D = F.colwise().normalized();
  const SparseCodes codes = omp(prepare_coding(D, 1), F, 1);
  for (std::int64_t i = 0; i < 200; ++i) EXPECT_EQ(codes.atoms(0, i), i);
  EXPECT_LT((decode(D, codes) - F).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(Omp, NothingInNothingOut) {
  const Eigen::MatrixXf D = random_dictionary(16, 20, 21);
  const Eigen::MatrixXf zero = Eigen::MatrixXf::Zero(16, 3);
  for (const int sparsity : {1, 3}) {
    const SparseCodes codes = omp(prepare_coding(D, sparsity), zero, sparsity);
    EXPECT_EQ(codes.atoms.maxCoeff(), -1);
    EXPECT_EQ(omp(prepare_coding(D, sparsity), Eigen::MatrixXf(16, 0), sparsity).count(), 0);
  }
}

}  // namespace
}  // namespace arete
