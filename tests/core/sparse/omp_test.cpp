#include "core/sparse/omp.h"

#include <cmath>
#include <set>
#include <vector>

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

double gaussian(std::uint64_t seed, std::uint64_t i, std::uint64_t j) {
  const double u = 1 - uniform_at(seed, i, j, 0), v = uniform_at(seed, i, j, 1);
  return std::sqrt(-2 * std::log(u)) * std::cos(6.283185307179586 * v);
}

Eigen::MatrixXf random_matrix(std::int64_t rows, std::int64_t columns, std::uint64_t seed) {
  Eigen::MatrixXf values(rows, columns);
  for (std::int64_t j = 0; j < columns; ++j)
    for (std::int64_t i = 0; i < rows; ++i) values(i, j) = static_cast<float>(gaussian(seed, i, j));
  return values;
}

Eigen::MatrixXf random_dictionary(std::int64_t samples, std::int64_t atoms, std::uint64_t seed) {
  return random_matrix(samples, atoms, seed).colwise().normalized();
}

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

TEST(Correlate, IsTheProductOfAtomsAndSignals) {
  const Eigen::MatrixXf D = random_dictionary(37, 45, 1), F = random_matrix(37, 19, 2);
  const PackedAtoms atoms(D);
  EXPECT_EQ(atoms.padded_atoms(), 48);
  Eigen::MatrixXf products(48, 19);
  correlate(atoms, F.data(), 19, 37, products.data());
  EXPECT_LT((products.topRows(45) - D.transpose() * F).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_EQ(products.bottomRows(3).cwiseAbs().maxCoeff(), 0);
}

TEST(StrongestAtoms, AreTheFirstOfTheLargestCorrelations) {
  Eigen::MatrixXf D = random_dictionary(24, 100, 3);
  D.col(71) = D.col(5);
  D.col(40) = -D.col(6);
  Eigen::MatrixXf F = random_matrix(24, 50, 4);
  F.col(10) = 3 * D.col(71);
  F.col(11) = -2 * D.col(40);
  F.col(12).setZero();
  const PackedAtoms atoms(D);
  std::vector<Match> best(50);
  strongest_atoms(atoms, F.data(), 50, 24, best.data());
  Eigen::MatrixXf products(atoms.padded_atoms(), 50);
  correlate(atoms, F.data(), 50, 24, products.data());
  for (int i = 0; i < 50; ++i) {
    Eigen::Index expected;
    products.col(i).cwiseAbs().maxCoeff(&expected);
    EXPECT_EQ(best[i].atom, expected);
    EXPECT_EQ(best[i].correlation, products(expected, i));  // the same bits
  }
  EXPECT_EQ(best[10].atom, 5);
  EXPECT_EQ(best[11].atom, 6);
  EXPECT_EQ(best[12].correlation, 0);
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
