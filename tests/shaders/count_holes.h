#pragma once

#include <cstdint>
#include <vector>

#include "shaders/frame.h"

namespace arete {

/// Background pixels from which no way over background leads out of the picture.
inline std::int64_t count_holes(const Frame& frame) {
  const std::int64_t w = frame.size.width, h = frame.size.height;
  std::vector<char> seen(static_cast<std::size_t>(w * h));
  std::vector<std::int64_t> waiting;
  const auto visit = [&](std::int64_t x, std::int64_t y) {
    if (x < 0 || y < 0 || x >= w || y >= h) return;
    const auto i = static_cast<std::size_t>(y * w + x);
    if (seen[i] || frame.rgba[4 * i] != 0) return;
    seen[i] = 1;
    waiting.push_back(y * w + x);
  };
  for (std::int64_t x = 0; x < w; ++x) visit(x, 0);
  // Sky reaches the sides above the terrain only; what lies below is the foot of the walls.
  for (std::int64_t y = 0; y < h; ++y) visit(0, y), visit(w - 1, y);
  for (std::int64_t x = 0; x < w; ++x) visit(x, h - 1);
  while (!waiting.empty()) {
    const std::int64_t x = waiting.back() % w, y = waiting.back() / w;
    waiting.pop_back();
    visit(x - 1, y), visit(x + 1, y), visit(x, y - 1), visit(x, y + 1);
  }
  std::int64_t holes = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) holes += !seen[i] && frame.rgba[4 * i] == 0;
  return holes;
}

}  // namespace arete
