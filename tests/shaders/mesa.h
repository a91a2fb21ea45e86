#pragma once

#include <cstdlib>

namespace arete {

/// Mesa's rasteriser is held to vectors that it draws reliably with (512 bits crash Mesa 22.3), and writes no cache to the home folder.
inline void hold_mesa_still() {
  setenv("LP_NATIVE_VECTOR_WIDTH", "256", 1);
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
}

}  // namespace arete
