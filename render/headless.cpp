#include "render/headless.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <rubble/error.h>

#include "render/gl.h"

namespace rubble::render {
namespace {

bool clientHas(const char* extension) { return epoxy_has_egl_extension(EGL_NO_DISPLAY, extension); }

bool deviceHas(EGLDeviceEXT device, const char* extension) {
  const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
  return extensions && std::strstr(extensions, extension);
}

/// Which CUDA device this is; a large number for those that are none.
EGLAttrib cudaIndex(EGLDeviceEXT device) {
  EGLAttrib index = 0;
  if (deviceHas(device, "EGL_NV_device_cuda") && eglQueryDeviceAttribEXT(device, EGL_CUDA_DEVICE_NV, &index))
    return index;
  return std::numeric_limits<EGLAttrib>::max();
}

/// Counts the contexts of each display. All contexts of a device have one display: its end would end them.
class DisplayUses {
 public:
  bool begin(EGLDisplay display) {
    const std::scoped_lock lock(mutex_);
    if (!eglInitialize(display, nullptr, nullptr)) return false;
    ++uses_[display];
    return true;
  }
  void end(EGLDisplay display) {
    const std::scoped_lock lock(mutex_);
    if (--uses_[display] == 0) eglTerminate(display);
  }

 private:
  std::mutex mutex_;
  std::map<EGLDisplay, int> uses_;
};

DisplayUses& displayUses() {
  static DisplayUses uses;
  return uses;
}

}  // namespace

struct KeptContext::Impl {
  EGLContext context = eglGetCurrentContext();
  EGLDisplay display = eglGetCurrentDisplay();
  EGLSurface draw = eglGetCurrentSurface(EGL_DRAW), read = eglGetCurrentSurface(EGL_READ);
};

KeptContext::KeptContext() {
  eglBindAPI(EGL_OPENGL_API);
  impl_ = std::make_unique<Impl>();
}

KeptContext::~KeptContext() {
  if (eglGetCurrentContext() == impl_->context) return;
  if (impl_->context == EGL_NO_CONTEXT)
    eglMakeCurrent(eglGetCurrentDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  else
    eglMakeCurrent(impl_->display, impl_->draw, impl_->read, impl_->context);
}

struct HeadlessContext::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  std::string renderer;
  bool software = false;

  /// Tries to make a context of this display current; leaves everything as it was if that fails.
  bool start(EGLDisplay candidate) {
    if (candidate == EGL_NO_DISPLAY || !displayUses().begin(candidate)) return false;
    if (makeCurrent(candidate)) return true;
    displayUses().end(candidate);
    return false;
  }

  bool makeCurrent(EGLDisplay candidate) {
    if (!eglBindAPI(EGL_OPENGL_API)) return false;
    const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(candidate, wanted, &config, 1, &count) || count == 0) return false;
    EGLContext made = EGL_NO_CONTEXT;
    // Some drivers create exactly the requested version.
    for (const EGLint minor : {gl::kComputeVersion % 10, 1}) {
      const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                                4,
                                EGL_CONTEXT_MINOR_VERSION,
                                minor,
                                EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                EGL_NONE};
      if (made == EGL_NO_CONTEXT) made = eglCreateContext(candidate, config, EGL_NO_CONTEXT, version);
    }
    if (made == EGL_NO_CONTEXT) return false;
    if (!eglMakeCurrent(candidate, EGL_NO_SURFACE, EGL_NO_SURFACE, made)) {
      eglDestroyContext(candidate, made);
      return false;
    }
    display = candidate;
    context = made;
    renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    software = gl::drawsInSoftware();
    return true;
  }

  bool startOnDevices(bool wantsSoftware) {
    if (!clientHas("EGL_EXT_platform_device") || !clientHas("EGL_EXT_device_enumeration")) return false;
    std::array<EGLDeviceEXT, 32> devices{};
    EGLint count = 0;
    if (!eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count)) return false;
    // The first CUDA device first: that is where worlds are stepped, and poses need not leave it.
    const auto last = devices.begin() + count;
    std::stable_sort(devices.begin(), last,
                     [](EGLDeviceEXT a, EGLDeviceEXT b) { return cudaIndex(a) < cudaIndex(b); });
    for (auto device = devices.begin(); device != last; ++device) {
      if (deviceHas(*device, "EGL_MESA_device_software") != wantsSoftware) continue;
      if (start(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, *device, nullptr))) return true;
    }
    return false;
  }

  bool startSurfaceless() {
    return clientHas("EGL_MESA_platform_surfaceless") &&
           start(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  }
};

HeadlessContext::HeadlessContext() : impl_(std::make_unique<Impl>()) {
  const char* choice = std::getenv("RUBBLE_GL");
  if (impl_->startOnDevices(choice && std::string(choice) == "software")) return;
  if (!impl_->startSurfaceless())
    throw Error("EGL",
                "an OpenGL 4.1 context without a display (Debian: apt-get install libegl1 libgl1-mesa-dri)",
                "none");
}

HeadlessContext::~HeadlessContext() {
  if (eglGetCurrentContext() == impl_->context)
    eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(impl_->display, impl_->context);
  displayUses().end(impl_->display);
}

void HeadlessContext::makeCurrent() const {
  eglBindAPI(EGL_OPENGL_API);
  if (eglGetCurrentContext() == impl_->context) return;
  if (!eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, impl_->context))
    throw Error("OpenGL", "a context that no other thread draws with", "one that is current elsewhere");
}

const std::string& HeadlessContext::renderer() const { return impl_->renderer; }
bool HeadlessContext::isSoftware() const { return impl_->software; }

}  // namespace rubble::render
