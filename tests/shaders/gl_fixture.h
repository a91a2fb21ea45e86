#pragma once

#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/support/progress.h"
#include "core/synthesis/mountains.h"
#include "shaders/gl_context.h"
#include "shaders/terrain_renderer.h"
#include "tests/shaders/mesa.h"

namespace arete {

/// Skips where OpenGL is missing.
class GlFixture : public testing::Test {
 protected:
  static void SetUpTestSuite() { hold_mesa_still(); }
  void SetUp() override {
    std::string reason;
    if (!have_gl(&reason)) GTEST_SKIP() << reason;
  }

  static std::unique_ptr<TerrainRenderer> render(const RasterSource& source, const SceneOptions& options, CellSize cell = {30, 30}) {
    NoProgress progress;
    return std::make_unique<TerrainRenderer>(source, cell, options, progress);
  }
  /// Round the terrain, from close above the ground to far away and high.
  static Camera camera(const SceneRenderer& renderer, int i) {
    const Box box = renderer.box();
    const double span = std::hypot(box.high[0] - box.low[0], box.high[1] - box.low[1]);
    const Point3 target = {box.low[0] + (0.2 + 0.15 * (i % 5)) * (box.high[0] - box.low[0]),
                           box.low[1] + (0.2 + 0.15 * (i / 5 % 5)) * (box.high[1] - box.low[1]), box.high[2]};
    return orbit_camera(target, 47.0 * i, 12 + (i * 17) % 70, span * (0.15 + 0.11 * (i % 9)), 35);
  }
};

}  // namespace arete
