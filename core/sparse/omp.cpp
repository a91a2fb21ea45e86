// R. Rubinstein, M. Zibulevsky, M. Elad, "Efficient implementation of the K-SVD algorithm using Batch Orthogonal Matching
// Pursuit", Technion CS-2008-08, 2008, algorithm 2 (sparsity-limited).
#include "core/sparse/omp.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "core/support/parallel.h"

namespace arete {

namespace {

constexpr double least_pivot = 1e-6;        // squared distance of a unit atom to the span of the chosen ones
constexpr float least_correlation = 2e-6f;  // of the first choice: rounding of float sums
constexpr std::int64_t batch_signals = 480;  // a task; a multiple of the rounds of the kernels

// L L^T = G_I of the chosen atoms, row by row, and y = L^-1 of their initial correlations.
class Cholesky {
 public:
  explicit Cholesky(std::int64_t capacity)
      : capacity_(capacity),
        rows_(static_cast<std::size_t>(capacity * capacity)),
        y_(static_cast<std::size_t>(capacity)),
        solution_(static_cast<std::size_t>(capacity)) {}

  void clear() { size_ = 0; }

  // Appends an atom by its inner products with those before it; false, and nothing appended, where it depends on them.
  template <typename Product>
  bool append(const Product& product_with, double squared_norm, double correlation) {
    double* row = &rows_[static_cast<std::size_t>(size_ * capacity_)];
    double pivot = squared_norm;
    double y = correlation;
    for (std::int64_t i = 0; i < size_; ++i) {
      const double* other = &rows_[static_cast<std::size_t>(i * capacity_)];
      double value = product_with(i);
      for (std::int64_t k = 0; k < i; ++k) value -= other[k] * row[k];
      row[i] = value / other[i];
      pivot -= row[i] * row[i];
      y -= row[i] * y_[static_cast<std::size_t>(i)];
    }
    if (pivot < least_pivot) return false;
    row[size_] = std::sqrt(pivot);
    y_[static_cast<std::size_t>(size_)] = y / row[size_];
    ++size_;
    return true;
  }

  // The least-squares coefficients of the atoms appended so far.
  const double* solve() {
    for (std::int64_t i = size_ - 1; i >= 0; --i) {
      double value = y_[static_cast<std::size_t>(i)];
      for (std::int64_t k = i + 1; k < size_; ++k)
        value -= rows_[static_cast<std::size_t>(k * capacity_ + i)] * solution_[static_cast<std::size_t>(k)];
      solution_[static_cast<std::size_t>(i)] = value / rows_[static_cast<std::size_t>(i * capacity_ + i)];
    }
    return solution_.data();
  }

  std::int64_t size() const { return size_; }

 private:
  std::int64_t capacity_;
  std::int64_t size_ = 0;
  std::vector<double> rows_;
  std::vector<double> y_;
  std::vector<double> solution_;
};

SparseCodes empty_codes(std::int64_t sparsity, std::int64_t count) {
  SparseCodes codes;
  codes.atoms.setConstant(sparsity, count, -1);
  codes.coefficients.setZero(sparsity, count);
  return codes;
}

template <typename Batch>
void for_each_batch(std::int64_t count, int threads, const Batch& batch) {
  parallel_for((count + batch_signals - 1) / batch_signals, threads, [&](std::int64_t b) {
    batch(b * batch_signals, std::min(count, (b + 1) * batch_signals));
  });
}

// The strongest atom of each column.
std::vector<Match> strongest_of_all(const CodingDictionary& dictionary, const Eigen::Ref<const Eigen::MatrixXf>& F, int threads) {
  std::vector<Match> best(static_cast<std::size_t>(F.cols()));
  for_each_batch(F.cols(), threads, [&](std::int64_t begin, std::int64_t end) {
    Match* out = &best[static_cast<std::size_t>(begin)];
    if (dictionary.search)
      dictionary.search->strongest(F.col(begin).data(), end - begin, F.outerStride(), out);
    else
      strongest_atoms(dictionary.atoms, F.col(begin).data(), end - begin, F.outerStride(), out);
  });
  return best;
}

SparseCodes one_atom_codes(const CodingDictionary& dictionary, const Eigen::Ref<const Eigen::MatrixXf>& F, int threads) {
  SparseCodes codes = empty_codes(1, F.cols());
  const std::vector<Match> best = strongest_of_all(dictionary, F, threads);
  for (std::int64_t i = 0; i < F.cols(); ++i) {
    const Match match = best[static_cast<std::size_t>(i)];
    if (match.correlation == 0) continue;
    codes.atoms(0, i) = match.atom;
    codes.coefficients(0, i) = match.correlation;
  }
  return codes;
}

// The working space of one thread for signals coded through the Gram matrix.
class BatchOmp {
 public:
  BatchOmp(const CodingDictionary& dictionary, std::int64_t sparsity)
      : gram_(dictionary.gram),
        cholesky_(sparsity),
        columns_(static_cast<std::size_t>(sparsity)),
        factors_(static_cast<std::size_t>(sparsity)) {}

  // Codes one signal from its correlations with all (padded) atoms.
  void code(const float* correlations, std::int64_t sparsity, std::int32_t* atoms, float* coefficients) {
    cholesky_.clear();
    Match next = strongest(correlations, gram_.rows());
    const float floor = std::abs(next.correlation) * least_correlation;
    while (std::abs(next.correlation) > floor && append(next.atom, correlations[next.atom], atoms)) {
      const std::int64_t chosen = cholesky_.size();
      const double* solution = cholesky_.solve();
      for (std::int64_t i = 0; i < chosen; ++i) factors_[static_cast<std::size_t>(i)] = static_cast<float>(solution[i]);
      if (chosen == sparsity) break;
      next = subtract_and_find_strongest(correlations, columns_.data(), factors_.data(), chosen, gram_.rows());
    }
    std::copy_n(factors_.data(), cholesky_.size(), coefficients);
  }

 private:
  bool append(std::int32_t atom, float correlation, std::int32_t* atoms) {
    const std::int64_t chosen = cholesky_.size();
    const float* column = gram_.data() + atom * gram_.rows();
    if (!cholesky_.append([&](std::int64_t i) { return column[atoms[i]]; }, column[atom], correlation)) return false;
    atoms[chosen] = atom;
    columns_[static_cast<std::size_t>(chosen)] = column;
    return true;
  }

  const Eigen::MatrixXf& gram_;
  Cholesky cholesky_;
  std::vector<const float*> columns_;
  std::vector<float> factors_;
};

SparseCodes batch_omp(const CodingDictionary& dictionary, const Eigen::Ref<const Eigen::MatrixXf>& F, int sparsity, int threads) {
  constexpr std::int64_t group = 24;  // signals whose correlations stay in cache: 12 KiB at N = 128
  SparseCodes codes = empty_codes(sparsity, F.cols());
  const std::int64_t padded = dictionary.atoms.padded_atoms();
  for_each_batch(F.cols(), threads, [&](std::int64_t begin, std::int64_t end) {
    BatchOmp solver(dictionary, sparsity);
    std::vector<float> correlations(static_cast<std::size_t>(group * padded));
    for (std::int64_t first = begin; first < end; first += group) {
      const std::int64_t count = std::min(group, end - first);
      correlate(dictionary.atoms, F.col(first).data(), count, F.outerStride(), correlations.data());
      for (std::int64_t i = 0; i < count; ++i)
        solver.code(correlations.data() + i * padded, sparsity, codes.atoms.col(first + i).data(),
                    codes.coefficients.col(first + i).data());
    }
  });
  return codes;
}

double inner_product(const float* a, const float* b, std::int64_t count) {
  double sum = 0;
  for (std::int64_t k = 0; k < count; ++k) sum += static_cast<double>(a[k]) * b[k];
  return sum;
}

// Atom j as a column, from its panel.
Eigen::VectorXf unpack(const PackedAtoms& atoms, std::int64_t j) {
  Eigen::VectorXf atom(atoms.samples());
  const float* from = atoms.panel(j / PackedAtoms::panel_atoms) + j % PackedAtoms::panel_atoms;
  for (std::int64_t k = 0; k < atoms.samples(); ++k) atom[k] = from[k * PackedAtoms::panel_atoms];
  return atom;
}

// Refits signal `f` to its atoms and the new one; false where the new one adds nothing. Writes the new residual.
bool refit(const PackedAtoms& dictionary, const Eigen::Ref<const Eigen::VectorXf>& f, std::int64_t chosen, std::int32_t* atoms,
           float* coefficients, Eigen::Ref<Eigen::VectorXf> residual) {
  const std::int64_t samples = dictionary.samples();
  Eigen::MatrixXf columns(samples, chosen + 1);
  for (std::int64_t t = 0; t <= chosen; ++t) columns.col(t) = unpack(dictionary, atoms[t]);
  Cholesky cholesky(chosen + 1);
  for (std::int64_t t = 0; t <= chosen; ++t) {
    const float* column = columns.col(t).data();
    const auto product_with = [&](std::int64_t i) { return inner_product(columns.col(i).data(), column, samples); };
    if (!cholesky.append(product_with, product_with(t), inner_product(f.data(), column, samples))) return false;
  }
  const double* solution = cholesky.solve();
  Eigen::VectorXd left = f.cast<double>();
  for (std::int64_t t = 0; t <= chosen; ++t) {
    coefficients[t] = static_cast<float>(solution[t]);
    left -= solution[t] * columns.col(t).cast<double>();
  }
  residual = left.cast<float>();
  return true;
}

// Without a Gram matrix: one search over the residuals of all signals per atom.
SparseCodes residual_omp(const CodingDictionary& dictionary, const Eigen::Ref<const Eigen::MatrixXf>& F, int sparsity, int threads) {
  SparseCodes codes = empty_codes(sparsity, F.cols());
  Eigen::MatrixXf residuals = F;
  std::vector<float> floors(static_cast<std::size_t>(F.cols()), 0.0f);
  for (std::int64_t t = 0; t < sparsity; ++t) {
    const std::vector<Match> best = strongest_of_all(dictionary, residuals, threads);
    for_each_batch(F.cols(), threads, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        const Match match = best[static_cast<std::size_t>(i)];
        float& floor = floors[static_cast<std::size_t>(i)];
        if (t == 0) floor = std::abs(match.correlation) * least_correlation;
        if (std::abs(match.correlation) <= floor || (t > 0 && codes.atoms(t - 1, i) < 0)) continue;
        codes.atoms(t, i) = match.atom;
        if (!refit(dictionary.atoms, F.col(i), t, codes.atoms.col(i).data(), codes.coefficients.col(i).data(), residuals.col(i)))
          codes.atoms(t, i) = -1;
      }
    });
  }
  return codes;
}

}  // namespace

CodingDictionary prepare_coding(const Eigen::Ref<const Eigen::MatrixXf>& D, int sparsity, int threads) {
  CodingDictionary dictionary;
  const bool with_gram = sparsity > 1 && D.cols() <= most_gram_atoms;
  if (!with_gram && D.cols() >= least_search_atoms) dictionary.search.emplace(D);
  if (!dictionary.search || sparsity > 1) dictionary.atoms = PackedAtoms(D);
  if (!with_gram) return dictionary;

  dictionary.gram.setZero(dictionary.atoms.padded_atoms(), dictionary.atoms.padded_atoms());
  for_each_batch(D.cols(), threads, [&](std::int64_t begin, std::int64_t end) {
    correlate(dictionary.atoms, D.col(begin).data(), end - begin, D.outerStride(), dictionary.gram.col(begin).data());
  });
  return dictionary;
}

SparseCodes omp(const CodingDictionary& dictionary, const Eigen::Ref<const Eigen::MatrixXf>& F, int sparsity, int threads) {
  assert(sparsity >= 1);
  const std::int64_t atoms = dictionary.search ? dictionary.search->atoms() : dictionary.atoms.atoms();
  if (F.cols() == 0 || atoms == 0) return empty_codes(sparsity, F.cols());
  if (sparsity == 1) return one_atom_codes(dictionary, F, threads);
  if (dictionary.gram.size() == 0) return residual_omp(dictionary, F, sparsity, threads);
  return batch_omp(dictionary, F, sparsity, threads);
}

Eigen::MatrixXf decode(const Eigen::Ref<const Eigen::MatrixXf>& D, const SparseCodes& X) {
  Eigen::MatrixXf signals = Eigen::MatrixXf::Zero(D.rows(), X.count());
  for (std::int64_t i = 0; i < X.count(); ++i)
    for (std::int64_t t = 0; t < X.sparsity() && X.atoms(t, i) >= 0; ++t)
      signals.col(i) += X.coefficients(t, i) * D.col(X.atoms(t, i));
  return signals;
}

Eigen::VectorXd squared_residuals(const Eigen::Ref<const Eigen::MatrixXf>& F, const Eigen::Ref<const Eigen::MatrixXf>& D,
                                  const SparseCodes& X, int threads) {
  Eigen::VectorXd squares(F.cols());
  for_each_batch(F.cols(), threads, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      Eigen::VectorXd left = F.col(i).cast<double>();
      for (std::int64_t t = 0; t < X.sparsity() && X.atoms(t, i) >= 0; ++t)
        left -= static_cast<double>(X.coefficients(t, i)) * D.col(X.atoms(t, i)).cast<double>();
      squares[i] = left.squaredNorm();
    }
  });
  return squares;
}

}  // namespace arete
