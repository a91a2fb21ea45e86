#include "core/amplify/consistent_stage.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/amplify/activity.h"
#include "core/amplify/blend.h"
#include "core/amplify/coded_patches.h"
#include "core/amplify/shore.h"
#include "core/amplify/source_map.h"
#include "core/amplify/void_mask.h"
#include "core/support/error.h"
#include "core/support/parallel.h"
#include "core/terrain/extend.h"
#include "core/terrain/flat_water.h"

namespace arete {
namespace {

Window grow(const Window& w, std::int64_t by) { return {w.x - by, w.y - by, w.width + 2 * by, w.height + 2 * by}; }

/// The detail of a window, and its area average.
struct Detail {
  Raster<float> fine, mean;
};

class ConsistentStage final : public Stage {
 public:
  ConsistentStage(Dictionary dictionary, const ConsistentOptions& options)
      : dictionary_(std::move(dictionary)),
        grid_(make_patch_grid(dictionary_.patch_cells, options.pitch)),
        options_(options),
        meter_(dictionary_.patch_cells),
        weights_(blending_weights(grid_, dictionary_.factor, Blending::variance)),
        squared_weights_(static_cast<Eigen::Index>(weights_.size()), 1) {
    for (std::size_t i = 0; i < weights_.size(); ++i) squared_weights_(static_cast<Eigen::Index>(i), 0) = weights_[i] * weights_[i];
    dictionary_.high.resize(0, 0);
    if (dictionary_.detail.cols() == 0) return;
    coding_ = prepare_coding(dictionary_.low, options.sparsity, options.threads);
    weigh_atoms(dictionary_.detail, weights_, options.threads);
  }

  int factor() const override { return dictionary_.factor; }
  int margin() const override { return upsampler().reach + patch_reach() + continued() + extend_support; }
  bool repeats_edge() const override { return false; }

  void evaluate(const Window& window, RasterView<const float> coarse, const AmplifiedBands& out, int threads) const override {
    Raster<float> extended(coarse.width, coarse.height);
    extend_into_voids(coarse, continued(), extended.view());
    const Raster<std::uint8_t> water = find_flat_water(coarse);
    const Window inner{margin(), margin(), window.width, window.height};
    CodedPatches coded;
    Eigen::MatrixXf amplitudes;
    const bool codes_wanted = options_.detail > 0 || out.uncertainty.data || out.exemplar.data || out.atom.data;
    if (codes_wanted && dictionary_.detail.cols() > 0) {
      coded = code_patches(std::as_const(extended).view(), window.x - margin(), window.y - margin(), grow(window, upsampler().reach), grid_,
                           coding_, options_.sparsity, &meter_, threads);
      amplitudes = scale_codes(coded);
      map_sources(coded, grid_, dictionary_.sources, factor(), window, coarse.sub(inner), out);
      if (out.uncertainty.data) estimate_error(coded, window, coarse.sub(inner), std::as_const(water).view().sub(inner), out.uncertainty, threads);
    }
    // Tiles that fit a core's cache, each from detail to finished cells.
    const std::int64_t across = (window.width + tile_side - 1) / tile_side, down = (window.height + tile_side - 1) / tile_side;
    parallel_for(across * down, threads, [&](std::int64_t t) {
      const std::int64_t x = t % across * tile_side, y = t / across * tile_side;
      const Window tile{x, y, std::min(tile_side, window.width - x), std::min(tile_side, window.height - y)};
      finish_tile(window, tile, coarse, std::as_const(extended).view(), std::as_const(water).view(), coded, amplitudes,
                  out.elevation.sub({x * factor(), y * factor(), tile.width * factor(), tile.height * factor()}));
    });
  }

 private:
  const Upsampler& upsampler() const { return *dictionary_.upsampler; }
  int patch_reach() const { return dictionary_.patch_cells - 1; }
  int continued() const { return std::max(upsampler().reach, patch_reach()); }

  static constexpr std::int64_t tile_side = 64;  // coarse cells

  /// Every patch's code scaled to the variance that its activity foretells.
  Eigen::MatrixXf scale_codes(const CodedPatches& coded) const {
    const double amplitude = options_.detail * std::sqrt(dictionary_.detail_power);
    Eigen::MatrixXf scaled = coded.codes.coefficients;
    for (Eigen::Index i = 0; i < scaled.cols(); ++i) {
      const float norm = scaled.col(i).norm();
      scaled.col(i) *= norm > 0 ? static_cast<float>(amplitude * static_cast<double>(coded.activity[static_cast<std::size_t>(i)] / norm)) : 0.0f;
    }
    return scaled;
  }

  /// A tile of the window; `coarse`, `extended` and `water` are the window with its margin.
  void finish_tile(const Window& window, const Window& tile, RasterView<const float> coarse, RasterView<const float> extended,
                   RasterView<const std::uint8_t> water, const CodedPatches& coded, const Eigen::MatrixXf& amplitudes,
                   RasterView<float> out) const {
    const int reach = upsampler().reach;
    const Window inner{margin() + tile.x, margin() + tile.y, tile.width, tile.height}, around = grow(inner, reach);
    Detail detail;
    RasterView<const float> detail_mean;
    if (options_.detail > 0 && amplitudes.cols() > 0) {
      const Window of_grid{window.x + tile.x - reach, window.y + tile.y - reach, around.width, around.height};
      detail = make_detail(coded, amplitudes, of_grid, coarse.sub(around), water.sub(around));
      detail_mean = std::as_const(detail.mean).view();
      for (std::int64_t y = 0; y < out.height; ++y)
        std::copy_n(detail.fine.view().row(y + reach * factor()) + reach * factor(), out.width, out.row(y));
    }
    upsample(upsampler(), extended.sub(around), detail_mean, out);
    settle_shores(coarse.sub(grow(inner, 1)), water.sub(grow(inner, 1)), factor(), out);
    restore_voids(coarse.sub(inner), factor(), out);
  }

  /// The blended detail of a window of the grid; cells of voids and water lend none.
  Detail make_detail(const CodedPatches& coded, const Eigen::MatrixXf& amplitudes, const Window& window, RasterView<const float> coarse,
                     RasterView<const std::uint8_t> water) const {
    const int f = factor();
    Detail detail{Raster<float>(window.width * f, window.height * f), Raster<float>(window.width, window.height)};
    blend_patches(
        grid_, f, window, weights_, dictionary_.detail,
        [&](std::int64_t column, std::int64_t row) {
          const std::int64_t i = coded.index(column, row);
          return PatchTerms{0, coded.known[static_cast<std::size_t>(i)] != 0, coded.codes.sparsity(), coded.codes.atoms.col(i).data(),
                            amplitudes.col(i).data()};
        },
        detail.fine.view(), 1);
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x)
        detail.mean(x, y) = average_block(detail.fine.view().sub({x * f, y * f, f, f}), is_void(coarse(x, y)) || water(x, y));
    return detail;
  }

  static float average_block(RasterView<float> block, bool silent) {
    double sum = 0;
    for (std::int64_t j = 0; j < block.height; ++j)
      for (std::int64_t i = 0; i < block.width; ++i) {
        if (silent) block(i, j) = 0;
        sum += static_cast<double>(block(i, j));
      }
    return static_cast<float>(sum / static_cast<double>(block.width * block.height));
  }

  /// The linear answer misses the detail's variance; detail that is added is as far from the truth again.
  void estimate_error(const CodedPatches& coded, const Window& window, RasterView<const float> coarse, RasterView<const std::uint8_t> water,
                      RasterView<float> out, int threads) const {
    const double power = dictionary_.detail_power * (1 + options_.detail * options_.detail);
    std::vector<float> variance(coded.activity.size());
    for (std::size_t i = 0; i < variance.size(); ++i) {
      const auto a = static_cast<double>(coded.activity[i]);
      variance[i] = static_cast<float>(power * a * a);
    }
    static constexpr std::int32_t only = 0;
    blend_patches(
        grid_, factor(), window, weights_, squared_weights_,
        [&](std::int64_t column, std::int64_t row) {
          const auto i = static_cast<std::size_t>(coded.index(column, row));
          return PatchTerms{0, coded.known[i] != 0, 1, &only, &variance[i]};
        },
        out, threads);
    for (std::int64_t y = 0; y < out.height; ++y)
      for (std::int64_t x = 0; x < out.width; ++x)
        out(x, y) = water(x / factor(), y / factor()) ? 0.0f : std::sqrt(out(x, y));
    restore_voids(coarse, factor(), out);
  }

  Dictionary dictionary_;  // its detail weighted for blending, its high half dropped
  PatchGrid grid_;
  ConsistentOptions options_;
  ActivityMeter meter_;
  CodingDictionary coding_;
  std::vector<float> weights_;
  Eigen::MatrixXf squared_weights_;
};

}  // namespace

std::unique_ptr<Stage> make_consistent_stage(Dictionary dictionary, const ConsistentOptions& options) {
  if (!dictionary.upsampler) throw Error(ErrorKind::input, "amplify: the dictionary has no linear upsampler; learn it with --factor");
  if (options.detail > 0 && dictionary.detail.cols() != dictionary.low.cols())
    throw Error(ErrorKind::input, "amplify: the dictionary has no detail atoms; learn it with --factor, or give --detail 0");
  return std::make_unique<ConsistentStage>(std::move(dictionary), options);
}

}  // namespace arete
