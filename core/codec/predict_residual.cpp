#include "core/codec/predict_residual.h"

namespace arete {

const ResidualModels& initial_residual_models() {
  static const ResidualModels models;
  return models;
}

}  // namespace arete
