#pragma once

#include <memory>
#include <string>

namespace arete {

/// An OpenGL 4.5 core context without a window: on a GPU where EGL offers one, else on Mesa's software rasteriser (llvmpipe).
/// LIBGL_ALWAYS_SOFTWARE=true forces the latter. It belongs to the thread that last called make_current().
class GlContext {
 public:
  /// Current when it returns. Throws Error{input} where no EGL library, driver or OpenGL 4.5 is found, and says what to install.
  GlContext();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  void make_current() const;
  /// GL_RENDERER and GL_VERSION: "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6".
  std::string description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether a GlContext can be made; `reason` says why not.
bool have_gl(std::string* reason = nullptr);

}  // namespace arete
