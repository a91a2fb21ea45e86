#include "shaders/gl_context.h"

#include <cstdlib>
#include <cstring>
#include <vector>

#include <dlfcn.h>

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include "core/support/error.h"

namespace arete {
namespace {

[[noreturn]] void fail(const std::string& found) {
  throw Error(ErrorKind::input, "cannot draw with OpenGL: " + found + "; install an EGL driver (Debian: libegl1 libopengl0 libgl1-mesa-dri)");
}

/// epoxy ends the process where a library is missing, so look first.
void require_library(const char* name) {
  void* handle = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
  if (handle == nullptr) fail(std::string("there is no ") + name);
  dlclose(handle);
}

/// Displays to try: every GPU that EGL knows, then no device at all, which Mesa draws in software.
std::vector<EGLDisplay> find_displays() {
  std::vector<EGLDisplay> displays;
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const std::string client = extensions == nullptr ? "" : extensions;
  const auto has = [](const std::string& list, const char* name) { return (" " + list + " ").find(std::string(" ") + name + " ") != std::string::npos; };
  const bool software = std::getenv("LIBGL_ALWAYS_SOFTWARE") != nullptr;
  if (!software && has(client, "EGL_EXT_platform_device") && (has(client, "EGL_EXT_device_enumeration") || has(client, "EGL_EXT_device_base"))) {
    EGLDeviceEXT devices[16];
    EGLint count = 0;
    if (eglQueryDevicesEXT(16, devices, &count))
      for (EGLint i = 0; i < count; ++i) {
        const char* device = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
        if (device == nullptr || has(device, "EGL_MESA_device_software")) continue;
        displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
      }
  }
  if (has(client, "EGL_MESA_platform_surfaceless"))
    displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, reinterpret_cast<void*>(EGL_DEFAULT_DISPLAY), nullptr));
  return displays;
}

EGLContext make_context(EGLDisplay display) {
  if (!eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
  const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display, wanted, &config, 1, &count) || count == 0) return EGL_NO_CONTEXT;
  const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
                            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  return eglCreateContext(display, config, EGL_NO_CONTEXT, version);
}

}  // namespace

struct GlContext::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
};

GlContext::GlContext() : impl_(std::make_unique<Impl>()) {
  require_library("libEGL.so.1");
  require_library("libOpenGL.so.0");
  for (const EGLDisplay display : find_displays()) {
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) continue;
    const EGLContext context = make_context(display);
    if (context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
      impl_->display = display;
      impl_->context = context;
      return;
    }
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
  }
  fail("EGL has no driver with OpenGL 4.5");
}

GlContext::~GlContext() {
  if (impl_->context == EGL_NO_CONTEXT) return;
  // The display stays: other contexts of the process share it.
  eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(impl_->display, impl_->context);
}

void GlContext::make_current() const {
  if (!eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, impl_->context)) fail("the context was lost");
}

std::string GlContext::description() const {
  make_current();
  return std::string(reinterpret_cast<const char*>(glGetString(GL_RENDERER))) + ", " + reinterpret_cast<const char*>(glGetString(GL_VERSION));
}

bool have_gl(std::string* reason) {
  try {
    const GlContext context;
    return true;
  } catch (const Error& error) {
    if (reason != nullptr) *reason = error.what();
    return false;
  }
}

}  // namespace arete
