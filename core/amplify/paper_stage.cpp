#include "core/amplify/paper_stage.h"

#include "core/amplify/blend.h"
#include "core/amplify/coded_patches.h"
#include "core/amplify/source_map.h"
#include "core/amplify/void_mask.h"
#include "core/support/error.h"
#include "core/terrain/extend.h"

namespace arete {
namespace {

class PaperStage final : public Stage {
 public:
  PaperStage(Dictionary dictionary, const PaperOptions& options)
      : dictionary_(std::move(dictionary)),
        grid_(make_patch_grid(dictionary_.patch_cells, options.pitch)),
        sparsity_(options.sparsity),
        coding_(prepare_coding(dictionary_.low, options.sparsity, options.threads)),
        weights_(blending_weights(grid_, dictionary_.factor, Blending::mean)) {
    weigh_atoms(dictionary_.high, weights_, options.threads);
  }

  int factor() const override { return dictionary_.factor; }
  int margin() const override { return 2 * (grid_.patch_cells - 1) + extend_support; }  // a patch, and what it is continued from
  bool repeats_edge() const override { return true; }

  void evaluate(const Window& window, RasterView<const float> coarse, const AmplifiedBands& out, int threads) const override {
    Raster<float> extended(coarse.width, coarse.height);
    extend_into_voids(coarse, grid_.patch_cells - 1, extended.view());
    const CodedPatches coded = code_patches(extended.view(), window.x - margin(), window.y - margin(), window, grid_, coding_, sparsity_,
                                            nullptr, threads);
    blend_patches(
        grid_, factor(), window, weights_, dictionary_.high,
        [&](std::int64_t column, std::int64_t row) {
          const std::int64_t i = coded.index(column, row);
          return PatchTerms{coded.means[static_cast<std::size_t>(i)], coded.known[static_cast<std::size_t>(i)] != 0, coded.codes.sparsity(),
                            coded.codes.atoms.col(i).data(), coded.codes.coefficients.col(i).data()};
        },
        out.elevation, threads);
    const RasterView<const float> inner = coarse.sub({margin(), margin(), window.width, window.height});
    restore_voids(inner, factor(), out.elevation);
    map_sources(coded, grid_, dictionary_.sources, factor(), window, inner, out);
  }

 private:
  Dictionary dictionary_;  // its high half weighted for blending
  PatchGrid grid_;
  int sparsity_;
  CodingDictionary coding_;
  std::vector<float> weights_;
};

}  // namespace

std::unique_ptr<Stage> make_paper_stage(Dictionary dictionary, const PaperOptions& options) {
  if (dictionary.factor < 2 || dictionary.high.cols() != dictionary.low.cols())
    throw Error(ErrorKind::input, "amplify: the dictionary has no high-resolution half; learn it with --factor");
  return std::make_unique<PaperStage>(std::move(dictionary), options);
}

}  // namespace arete
