#include "core/amplify/paper_stage.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "core/amplify/amplified_terrain.h"
#include "core/support/error.h"
#include "tests/core/amplify/sample_terrain.h"

namespace arete {
namespace {

Raster<float> amplify_by_paper(const Raster<float>& coarse, Dictionary dictionary, const PaperOptions& options) {
  const auto stage = make_paper_stage(std::move(dictionary), options);
  const ViewSource source(coarse.view());
  return read_all(AmplifiedTerrain(source, *stage, options.threads));
}

// The published algorithm once more, from the formulas alone: plain loops, double precision, nothing of the library.
class PlainPaper {
 public:
  PlainPaper(const Raster<float>& coarse, const Dictionary& dictionary, int sparsity, int pitch)
      : coarse_(coarse), low_(dictionary.low.cast<double>()), high_(dictionary.high.cast<double>()), m_(dictionary.patch_cells), f_(dictionary.factor),
        s_(sparsity), p_(pitch) {}

  std::vector<double> amplify() {
    const auto w = static_cast<int>(coarse_.width()) * f_, h = static_cast<int>(coarse_.height()) * f_;
    std::vector<double> sum(static_cast<std::size_t>(w * h), 0), weights(sum.size(), 0);
    for (int oy = -(m_ - p_); oy < coarse_.height(); oy += p_)
      for (int ox = -(m_ - p_); ox < coarse_.width(); ox += p_) {
        const std::vector<double> patch = rebuild(ox, oy);
        const int side = m_ * f_;
        for (int j = 0; j < side; ++j)
          for (int i = 0; i < side; ++i) {
            const int x = ox * f_ + i, y = oy * f_ + j;
            if (x < 0 || y < 0 || x >= w || y >= h) continue;
            const double alpha = disc(i, j, side);
            sum[static_cast<std::size_t>(y * w + x)] += alpha * patch[static_cast<std::size_t>(j * side + i)];
            weights[static_cast<std::size_t>(y * w + x)] += alpha;
          }
      }
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] /= weights[i];
    return sum;
  }

 private:
  static double disc(int i, int j, int side) {
    const double dx = i + 0.5 - side / 2.0, dy = j + 0.5 - side / 2.0, r2 = (dx * dx + dy * dy) / (side * side / 4.0);
    return r2 < 1 ? (1 - r2) * (1 - r2) * (1 - r2) : 0;
  }

  /// Mean plus the sparse sum of high-resolution atoms.
  std::vector<double> rebuild(int ox, int oy) const {
    Eigen::VectorXd patch(m_ * m_);
    double mean = 0;
    for (int j = 0; j < m_; ++j)
      for (int i = 0; i < m_; ++i) {
        const auto x = std::clamp<std::int64_t>(ox + i, 0, coarse_.width() - 1), y = std::clamp<std::int64_t>(oy + j, 0, coarse_.height() - 1);
        patch[j * m_ + i] = static_cast<double>(coarse_(x, y));
        mean += patch[j * m_ + i] / (m_ * m_);
      }
    for (int j = 0; j < m_; ++j)
      for (int i = 0; i < m_; ++i) patch[j * m_ + i] = (patch[j * m_ + i] - mean) * disc(i, j, m_);
    Eigen::VectorXd fine = Eigen::VectorXd::Constant(high_.rows(), mean), residual = patch;
    Eigen::MatrixXd chosen(low_.rows(), 0);
    std::vector<Eigen::Index> atoms;
    Eigen::VectorXd coefficients;
    for (int t = 0; t < s_; ++t) {
      Eigen::Index best = 0;
      for (Eigen::Index k = 1; k < low_.cols(); ++k)
        if (std::abs(low_.col(k).dot(residual)) > std::abs(low_.col(best).dot(residual))) best = k;
      atoms.push_back(best);
      chosen.conservativeResize(Eigen::NoChange, t + 1);
      chosen.col(t) = low_.col(best);
      coefficients = chosen.colPivHouseholderQr().solve(patch);
      residual = patch - chosen * coefficients;
    }
    for (std::size_t t = 0; t < atoms.size(); ++t) fine += coefficients[static_cast<Eigen::Index>(t)] * high_.col(atoms[t]);
    return {fine.begin(), fine.end()};
  }

  const Raster<float>& coarse_;
  Eigen::MatrixXd low_, high_;
  int m_, f_, s_, p_;
};

TEST(PaperStage, AgreesWithAPlainImplementation) {
  struct Setting {
    int patch, pitch, factor, sparsity;
  };
  for (const Setting& s : {Setting{8, 4, 4, 1}, Setting{8, 4, 4, 3}, Setting{6, 3, 2, 3}, Setting{6, 2, 3, 1}}) {
    const Raster<float> exemplar = fractal_terrain(60 * s.factor, 50 * s.factor, 1, 2, 100, 300);
    const Dictionary dictionary = pair_dictionary(exemplar.view(), s.factor, make_patch_grid(s.patch, s.pitch), PatchEdges::inside, 2);
    const Raster<float> coarse = fractal_terrain(37, 29, 2, 2, 100, 300);
    const std::vector<double> expected = PlainPaper(coarse, dictionary, s.sparsity, s.pitch).amplify();
    const Raster<float> fine = amplify_by_paper(coarse, pair_dictionary(exemplar.view(), s.factor, make_patch_grid(s.patch, s.pitch), PatchEdges::inside, 2),
                                                {s.sparsity, s.pitch, 2});
    double worst = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) worst = std::max(worst, std::abs(static_cast<double>(fine.data()[i]) - expected[i]));
    EXPECT_LT(worst, 1e-4) << "patch " << s.patch << " factor " << s.factor << " sparsity " << s.sparsity;
  }
}

// Every patch finds itself; on the aligned grid the down-sampled exemplar gives the exemplar back.
TEST(PaperStage, ACompleteDictionaryGivesTheExemplarBack) {
  for (const int factor : {2, 3, 4})
    for (const float lowest : {20.0f, 2000.0f}) {
      const PatchGrid grid = make_patch_grid(8, 4);
      const Raster<float> exemplar = fractal_terrain(40 * factor, 33 * factor, 3, 2, lowest, 40);
      const Raster<float> fine = amplify_by_paper(area_average(exemplar.view(), factor),
                                                  pair_dictionary(exemplar.view(), factor, grid, PatchEdges::replicate), {1, 4, 2});
      const double spacing = lowest < 64 ? 0x1p-18 : 0x1p-13;  // of floats below 64 m and below 2048 m
      EXPECT_LE(largest_difference(fine.view(), exemplar.view()), std::max(1e-5, spacing)) << "factor " << factor << " at " << lowest;
    }
}

TEST(PaperStage, AConstantStaysToTheLastBit) {
  const Raster<float> exemplar = fractal_terrain(160, 160, 4);
  const Raster<float> fine =
      amplify_by_paper(Raster<float>(20, 16, 777.7f), pair_dictionary(exemplar.view(), 4, make_patch_grid(8), PatchEdges::inside), {});
  for (std::int64_t i = 0; i < fine.size().cells(); ++i) ASSERT_EQ(fine.data()[i], 777.7f);
}

TEST(PaperStage, VoidsStayVoidAndContaminateNothing) {
  const Raster<float> exemplar = fractal_terrain(160, 160, 5);
  Raster<float> coarse = fractal_terrain(40, 36, 6);
  make_void(coarse, {12, 9, 14, 12});
  make_void(coarse, {0, 30, 3, 6});
  const Raster<float> fine = amplify_by_paper(coarse, pair_dictionary(exemplar.view(), 4, make_patch_grid(8), PatchEdges::inside), {2, 0, 2});
  for (std::int64_t y = 0; y < fine.height(); ++y)
    for (std::int64_t x = 0; x < fine.width(); ++x) {
      ASSERT_EQ(is_void(fine(x, y)), is_void(coarse(x / 4, y / 4))) << x << ", " << y;
      if (!is_void(fine(x, y))) {
        ASSERT_GT(fine(x, y), 2000);
        ASSERT_LT(fine(x, y), 4600);
      }
    }
}

TEST(PaperStage, NeedsTheHighResolutionHalf) {
  Dictionary low_only;
  low_only.factor = 4;
  low_only.low = Eigen::MatrixXf::Identity(64, 8);
  try {
    make_paper_stage(std::move(low_only), {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    EXPECT_NE(std::string(e.what()).find("--factor"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace arete
